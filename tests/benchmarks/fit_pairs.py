"""How good fits of a tension beside another effect are: error over bound, and coverage.

Retractions that adhere come from the closed theory, at 60 to 2000 points, and are fitted by the
search of the comparison of rivals.  Power-law curves come from the model that is fitted, so that
they test search, verdict and intervals; those at two speeds are pooled.  Run it:
``python tests/benchmarks/fit_pairs.py [curves [seed [names of kinds]]]``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import fit_rivals
import numpy as np
from fit_rivals import DEPTH, MODULUS_, NOISE, RADIUS, Sample, Truth, path
from tables import curves_of_kinds, print_head, print_row

from pellicle_fit.models.adhesive import WORK_OF_ADHESION, AdhesiveModel, attachment
from pellicle_fit.models.force_model import ClosedFormModel
from pellicle_fit.models.relaxing import EXPONENT, PowerLawModel
from pellicle_fit.parameters import (
    CONTACT_POINT,
    MODULUS,
    OFFSET,
    SLOPE,
    TENSION,
    Coordinates,
    Parameter,
)
from pellicle_fit.statistics.checks import fit_single, judged
from pellicle_fit.statistics.chi_squared import ChiSquared, Minimum
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.pooled_likelihood import Pool
from pellicle_fit.statistics.profile import chi_squared_threshold
from pellicle_fit.statistics.rival import Rival
from pellicle_fit.statistics.rivals import rivals
from pellicle_plugins.axisymmetric.adhesive_contact import Adhesion
from pellicle_plugins.indenters.of_revolution import Paraboloid

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
    top = MODULUS_ * fit_rivals.hertz_scale(DEPTH)
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
) -> tuple[list[Likelihood], Coordinates]:
    """Return approaches of a tensed power-law solid, with their model, and the truth."""
    ratio = float(np.exp(random.uniform(np.log(0.03), np.log(1.0))))
    alpha = random.uniform(0.1, 0.3)
    truth = _at(ratio * RADIUS * MODULUS_ / 2, relaxation_exponent=alpha)
    share, curves = random.uniform(*NOISE), []
    for rate in speeds:
        rows = path(rate=rate)
        position = rows.depth * DEPTH * RADIUS + CONTACT
        still = Likelihood(position, np.zeros_like(position), ELASTIC, 1.0, FREE, time=rows.time)
        still = replace(still, force_model=PowerLawModel(ELASTIC, still.history))
        force = still.model(truth)
        noise = share * float(force.max())
        still = replace(still, force=force + noise * random.standard_normal(force.size))
        curves.append(replace(still, noise=noise, free=(*FREE, EXPONENT)))
    return curves, truth


def minimum_of(curve: Likelihood, code: str) -> tuple[Rival, ChiSquared, Minimum, float]:
    """Return a rival, χ² at the noise of its residuals, its minimum, and the threshold."""
    fit = fit_single(curve, {OFFSET: 0.0, SLOPE: 0.0})
    chi, start = fit.likelihood, fit.parameters
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
    judgement = judged(rival.of_curve(chi), best.parameters)[0]
    chi = replace(chi, noise=judgement.noise.deviation)
    best = rival.of(chi).minimise(best.parameters, rough=True)
    return rival, chi, best, chi_squared_threshold(judgement.noise.freedom)


def score_of(name: str, number: int, seed: int) -> dict[str, Any]:
    """Return errors over bounds and coverage of one curve or pool, or a verdict and its ranges."""
    random = np.random.default_rng([seed, number, *name.encode()])
    if name == "one speed":
        return one_speed(random)
    return adhesive(random) if name == "retraction" else two_speeds(random)


def adhesive(random: np.random.Generator) -> dict[str, Any]:
    """Return errors over bounds and coverage of a retraction that adheres."""
    measured, right, truth = retraction(random)
    rival, chi, best, threshold = minimum_of(measured, "tension+adhesion")
    bounds = right.bounds(truth, right.free)
    parameters = MODULUS, TENSION, WORK_OF_ADHESION
    best, ends = rival.intervals(chi, best, threshold, parameters)
    scores: dict[str, Any] = {"points": measured.force.size}
    for p in parameters:
        low, high = ends.get(p, (None, None))
        held = (low is None or low <= truth[p]) and (high is None or truth[p] <= high)
        scores[p.name] = (_error(p, best.parameters[p], truth[p]) / bounds[p], bool(held))
    return scores


def two_speeds(random: np.random.Generator) -> dict[str, Any]:
    """Return the verdict of a pooled fit of two approaches, with errors and coverage.

    Those are of tension and relaxation together, and only where these are chosen.
    """
    curves, truth = relaxing(random, (1.0, 0.1))
    right = Pool.of(curves)
    bounds = right.bounds(right.joined([truth] * len(curves)), right.free)
    fit = fit_rivals.pooled(_sample(random), [_rows_of(curve) for curve in curves])
    chosen = fit.rivals.chosen if fit.rivals is not None else None
    scores: dict[str, Any] = {"verdict": fit_rivals.verdict_of(fit)}
    if chosen is None or chosen.rival.code != "tension+power_law":
        return scores
    for p in (MODULUS, TENSION, EXPONENT):
        estimate, value = chosen.estimates[p.name], p.value(truth[p])
        low = -np.inf if estimate.low is None else estimate.low
        high = np.inf if estimate.high is None else estimate.high
        error = _error(p, p.coordinate(estimate.value), truth[p])
        scores[p.name] = (error / bounds[p], bool(low <= value <= high))
    return scores


def _error(parameter: Parameter, coordinate: float, truth: float) -> float:
    """Return the error of a value, relative if the bound is that of a logarithm.

    Where a curve does not show the adhesion, a logarithm would have an error without limit.
    """
    error = coordinate - truth
    return float(np.expm1(error)) if parameter.logarithmic else error


def one_speed(random: np.random.Generator) -> dict[str, Any]:
    """Return the verdict on an approach of a tensed power-law solid, and what its ranges hold.

    The tension counts where one is said to be needed.
    """
    (curve,), truth = relaxing(random, (1.0,))
    fit = fit_rivals.fitted(_sample(random), _rows_of(curve))
    tension = fit.rivals.tension if fit.rivals is not None else None
    estimate = tension or fit.tension
    low, high = estimate.low or 0.0, estimate.high or np.inf
    return {
        "verdict": fit_rivals.verdict_of(fit),
        "modulus": fit_rivals.holds(fit_rivals.modulus_of(fit)),
        "tension": bool(low <= truth[TENSION] <= high),
    }


def _sample(random: np.random.Generator) -> Sample:
    return Sample(Truth(lambda rows: rows.depth, ("tension+power_law",)), random)


def _rows_of(curve: Likelihood) -> fit_rivals.Curve:
    assert curve.time is not None
    return fit_rivals.Curve(curve.position, curve.force, curve.time)


def main() -> None:
    """Print a row of a table for each kind and parameter."""
    curves, seed, kinds = curves_of_kinds(__doc__, KINDS, 200, 7)
    print_head("kind", "parameter", "curves", "rms error over the bound", "interval holds")
    for name in kinds:
        values = [score_of(name, number, seed) for number in range(curves)]
        for verdict, count in Counter(v["verdict"] for v in values if "verdict" in v).items():
            print_row(name, verdict, len(values), "", count)
        if name == "one speed":
            claimed = [value["tension"] for value in values if value["verdict"] == "needed"]
            for parameter, flags in (
                ("modulus over tied models", [value["modulus"] for value in values]),
                ("tension over tied models", claimed),
            ):
                print_row(name, parameter, len(flags), "", f"{sum(flags)} held")
            continue
        for parameter in dict.fromkeys(
            key for value in values for key in value if key not in ("points", "verdict")
        ):
            errors, held = zip(*(v[parameter] for v in values if parameter in v), strict=True)
            rms = float(np.sqrt(np.mean(np.square(errors))))
            share = f"{100 * np.mean(held):.1f} %"
            print_row(name, parameter, len(errors), f"{rms:.3f}", share)


if __name__ == "__main__":
    main()
