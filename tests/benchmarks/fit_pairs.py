"""How good fits of a tension beside another effect are: error over bound, and coverage.

Retractions that adhere come from the closed theory, at 60 to 2000 points.  Power-law curves at two
speeds come from the model that is fitted, so that they test the search and the intervals only.
Each is fitted by the search of the comparison of rivals.  Run it:
``python tests/benchmarks/fit_pairs.py [curves [seed [names of kinds]]]``; with ``--keep FILE``
each score is appended to a file, and those that it has are not repeated.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import fit_rivals
import numpy as np
from fit_rivals import DEPTH, MODULUS_, NOISE, RADIUS, Sample, Truth, path
from kept_outcomes import outcomes_of

from pellicle.fitting.models.adhesive import WORK_OF_ADHESION, AdhesiveModel, attachment
from pellicle.fitting.models.force_model import ClosedFormModel
from pellicle.fitting.models.relaxing import EXPONENT, PowerLawModel
from pellicle.fitting.parameters import (
    CONTACT_POINT,
    MODULUS,
    OFFSET,
    SLOPE,
    TENSION,
    Coordinates,
)
from pellicle.fitting.statistics.checks import fit_single, judged
from pellicle.fitting.statistics.chi_squared import ChiSquared, Minimum
from pellicle.fitting.statistics.likelihood import Likelihood
from pellicle.fitting.statistics.pooled_likelihood import Pool
from pellicle.fitting.statistics.profile import chi_squared_threshold
from pellicle.fitting.statistics.rival import Rival
from pellicle.fitting.statistics.rivals import rivals
from pellicle_plugins.analytic.adhesion import Adhesion
from pellicle_plugins.indenters.paraboloid import Paraboloid

BEAD = Paraboloid(radius=RADIUS)
ELASTIC = ClosedFormModel(BEAD)
FREE = CONTACT_POINT, MODULUS, TENSION
KINDS = "retraction", "two speeds", "one speed"
CONTACT = 1e-6
"""Contact point [m]."""

Score = dict[str, tuple[float, bool]]
"""By parameter, error over the Cramér–Rao bound, and whether the interval holds the truth."""


def _at(tension: float, **own: float) -> Coordinates:
    at = {CONTACT_POINT: CONTACT, MODULUS: float(np.log(MODULUS_)), TENSION: tension}
    known = {p.name: p for p in (WORK_OF_ADHESION, EXPONENT)}
    at |= {known[name]: known[name].coordinate(value) for name, value in own.items()}
    return at | {OFFSET: 0.0, SLOPE: 0.0}


def retraction(random: np.random.Generator) -> tuple[Likelihood, Likelihood, Coordinates]:
    """Return a measured retraction, the same with the right model, and the truth."""
    points = int(np.exp(random.uniform(np.log(60), np.log(2000))))
    ratio = float(np.exp(random.uniform(np.log(0.03), np.log(1.0))))
    tension = ratio * RADIUS * MODULUS_ / 2
    top = MODULUS_ * fit_rivals._scale(DEPTH)
    work = random.uniform(0.02, 0.1) * top / (1.5 * np.pi * RADIUS)
    theory = Adhesion(BEAD, MODULUS_, tension, work)
    end = theory.instability(np.inf)
    branch = theory.equilibrium(np.geomspace(float(end.contact_radius), RADIUS, 3000))
    depth = np.linspace(-fit_rivals.BEFORE, 1.0, points) * DEPTH * RADIUS
    touches = depth > branch.depth[0]
    force = np.where(touches, np.interp(depth, branch.depth, branch.force), 0.0)
    noise = random.uniform(*NOISE) * float(force.max())
    force = force + noise * random.standard_normal(points)
    curve = Likelihood(depth + CONTACT, force, ELASTIC, noise, FREE, segment="retract")
    states = attachment(curve.base, curve.force, curve.moves_out)
    model = AdhesiveModel(ELASTIC, curve.moves_out, states)
    right = replace(curve, force_model=model, free=(*FREE, WORK_OF_ADHESION))
    return curve, right, _at(tension, work_of_adhesion=work)


def relaxing(
    random: np.random.Generator, speeds: Iterable[float]
) -> tuple[ChiSquared, ChiSquared, Coordinates]:
    """Return measured approaches, the same with the right model, and the truth."""
    ratio = float(np.exp(random.uniform(np.log(0.03), np.log(1.0))))
    alpha = random.uniform(0.1, 0.3)
    truth = _at(ratio * RADIUS * MODULUS_ / 2, relaxation_exponent=alpha)
    share, curves, right = random.uniform(*NOISE), [], []
    for rate in speeds:
        rows = path(rate=rate)
        position = rows.depth * DEPTH * RADIUS + CONTACT
        still = Likelihood(position, np.zeros_like(position), ELASTIC, 1.0, FREE, time=rows.time)
        still = replace(still, force_model=PowerLawModel(ELASTIC, still.history))
        force = still.model(truth)
        noise = share * float(force.max())
        still = replace(still, force=force + noise * random.standard_normal(force.size))
        still = replace(still, noise=noise, free=(*FREE, EXPONENT))
        right.append(still)
        curves.append(replace(still, force_model=ELASTIC, free=FREE))
    if len(curves) == 1:
        return curves[0], right[0], truth
    return Pool.of(curves), Pool.of(right), _joined(Pool.of(right), truth)


def _joined(pool: Pool, part: Coordinates) -> Coordinates:
    return pool.joined([part] * len(pool.members))


def minimum_of(curve: ChiSquared, code: str) -> tuple[Rival, ChiSquared, Minimum, float]:
    """Return a rival, χ² at the noise of its residuals, its minimum, and the threshold."""
    singles = [fit_single(member, {OFFSET: 0.0, SLOPE: 0.0}) for member in curve.members]
    chi = curve.with_members([single.likelihood for single in singles])
    start = chi.joined([single.parameters for single in singles])
    by_code = {rival.code: rival for rival in rivals(chi, start)}
    rival, single = by_code[code], by_code[code.partition("+")[2]]
    without = single.minimum(chi, [start | {TENSION: 0.0}, start])
    starts = [start]
    if without is not None:
        scale = chi.ranges[TENSION].scale
        starts += [without[1].parameters | {TENSION: part * scale} for part in (0.03, 0.3)]
    pair = rival.minimum(chi, starts)
    assert pair is not None
    rival, best = pair
    mine = rival.of(chi)
    judgements = [judged(member, part)[0] for member, part in mine.curves(best.parameters)]
    quiet = [
        replace(member, noise=judgement.noise.deviation)
        for member, judgement in zip(chi.members, judgements, strict=True)
    ]
    chi = chi.with_members(quiet)
    freedom = sum(judgement.noise.freedom for judgement in judgements)
    best = rival.of(chi).minimise(best.parameters, rough=True)
    return rival, chi, best, chi_squared_threshold(freedom)


def score_of(name: str, number: int, seed: int) -> dict[str, Any]:
    """Return errors over bounds and coverage of one curve, or the verdict at one speed."""
    random = np.random.default_rng([seed, number, *name.encode()])
    if name == "one speed":
        return one_speed(random)
    measured: ChiSquared
    right: ChiSquared
    if name == "retraction":
        measured, right, truth = retraction(random)
        code, own = "tension+adhesion", WORK_OF_ADHESION
    else:
        measured, right, truth = relaxing(random, (1.0, 0.1))
        code, own = "tension+power_law", EXPONENT
    rival, chi, best, threshold = minimum_of(measured, code)
    bounds = right.bounds(truth, right.free)
    parameters = MODULUS, TENSION, own
    best, ends = rival.intervals(chi, best, threshold, parameters)
    points = chi.force.size if isinstance(chi, Likelihood) else 0
    scores: dict[str, Any] = {"points": points}
    for p in parameters:
        low, high = ends.get(p, (None, None))
        held = (low is None or low <= truth[p]) and (high is None or truth[p] <= high)
        scores[p.name] = ((best.parameters[p] - truth[p]) / bounds[p], bool(held))
    return scores


def one_speed(random: np.random.Generator) -> dict[str, Any]:
    """Return the verdict on an approach of a tensed power-law solid, and what its ranges hold.

    The tension counts where one is said to be needed.
    """
    curve, _, truth = relaxing(random, (1.0,))
    assert isinstance(curve, Likelihood)
    sample = Sample(Truth(lambda rows: rows.depth, ("tension+power_law",)), random)
    assert curve.time is not None
    fit = fit_rivals.fitted(
        sample, fit_rivals.Curve(curve.position, curve.force, curve.time), "approach"
    )
    tension = fit.rivals.tension if fit.rivals is not None else None
    estimate = tension or fit.tension
    low, high = estimate.low or 0.0, estimate.high or np.inf
    return {
        "verdict": fit_rivals.verdict_of(fit),
        "modulus": fit_rivals.holds(fit_rivals.modulus_of(fit)),
        "tension": bool(low <= truth[TENSION] <= high),
    }


def main() -> None:
    """Print a row of a table for each kind and parameter."""
    _, results = outcomes_of(__doc__, KINDS, 200, score_of)
    print("kind | parameter | curves | rms error over the bound | interval holds")
    print("--- | --- | --- | --- | ---")
    for name, values in results.items():
        if name == "one speed":
            for verdict in sorted({value["verdict"] for value in values}):
                count = sum(value["verdict"] == verdict for value in values)
                print(f"{name} | {verdict} | {len(values)} | | {count}")
            claimed = [value["tension"] for value in values if value["verdict"] == "needed"]
            for parameter, flags in (
                ("modulus over tied models", [value["modulus"] for value in values]),
                ("tension over tied models", claimed),
            ):
                print(f"{name} | {parameter} | {len(flags)} | | {sum(flags)} held")
            continue
        for parameter in [key for key in values[0] if key != "points"]:
            errors, held = zip(*(value[parameter] for value in values), strict=True)
            rms = float(np.sqrt(np.mean(np.square(errors))))
            print(f"{name} | {parameter} | {len(values)} | {rms:.3f} | {100 * np.mean(held):.1f} %")


if __name__ == "__main__":
    main()
