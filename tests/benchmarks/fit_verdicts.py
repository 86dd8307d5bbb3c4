"""What fits claim of curves of known solids: false tensions, missed ones, and what intervals hold.

    python tests/benchmarks/fit_verdicts.py outcomes.jsonl 20 [seed [names of kinds]]

Each curve that is not in the file yet is fitted and added to it, so that an interrupted run goes
on; then a table is printed.  Forces come from closed forms and from bracketing, not from effects.
"""

import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from tables import print_head, print_row

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.estimation.candidate import Candidate
from pellicle_fit.selection.recipe import Answer
from pellicle_fit.selection.verdict import Verdict
from tests.physics.frozen.fit_curves import MODULUS, RADIUS, hertz, path
from tests.physics.frozen.fit_curves import Path as Rows
from tests.physics.frozen.fit_curves import force as force_of

ROWS = 350
"""Rows of a pass."""
NOISE = 0.003, 0.01
"""Least and greatest noise, over the largest force."""
PROTOCOLS = ("approach", "both", "speeds")
"""An approach, an approach and its retraction, two approaches of which one is ten times slower."""
EXPECTED = 12.0
"""Expected Δχ² from which on a tension has to be found."""
MOST = 20
"""Steps that a search for an expected χ² takes."""


class Truth(NamedTuple):
    """A solid under an instrument."""

    force: Callable[[Rows], Array]
    """[N]."""
    kind: str
    right: frozenset[str] | None
    """Effects that describe it; None if no set of those that are shipped does."""
    tension: float = 0.0
    """τ₀ [N/m]."""
    coloured: bool = False
    spring: float | None = None
    """Spring constant of a cantilever [N/m], whose base is known exactly."""
    relaxed: Callable[[float], float] = lambda _: 1.0
    """Modulus after a time [s] over E*."""


def rows_of(protocol: str, deepest: float) -> list[Rows]:
    """Return the paths of a protocol."""
    if protocol == "both":
        # Of the two rows at the turn, where a velocity is that of neither pass, one.
        rows = path("both", 2 * ROWS, deepest)
        return [Rows(*(np.delete(column, ROWS) for column in rows))]
    rates = (1.0, 0.1) if protocol == "speeds" else (1.0,)
    return [path("approach", ROWS, deepest, rate) for rate in rates]


# --- Solids ----------------------------------------------------------------------------------


def in_series(
    force: Callable[[Array], Array], give: Callable[[Array], Array], base: Array
) -> Array:
    """Return the force at which a solid and a body in series fill the way of the base."""
    low, high = np.minimum(base, 0.0) - 0.5 * np.ptp(base), base + 0.5 * np.ptp(base)
    for _ in range(60):
        middle = (low + high) / 2
        over = middle + give(force(middle)) > base
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    return force((low + high) / 2)


def closed_form(effect: str, **values: float) -> Callable[[Rows], Array]:
    """Return forces of a solid with one effect, of which the freeze of fits has closed forms."""
    return lambda rows: force_of(rows, frozenset({effect}), values)


def worn(flat: float) -> Callable[[Rows], Array]:
    """Return forces of a paraboloid with a flat of radius b (Popov, Heß & Willert 2019)."""
    radius = np.append(flat, flat + np.geomspace(1e-5, 2, 4000) * RADIUS)
    root = np.sqrt(radius**2 - flat**2)
    depth, force = radius / RADIUS * root, (2 * radius**2 + flat**2) * root
    return lambda rows: np.interp(rows.depth, depth, 2 * MODULUS / (3 * RADIUS) * force, left=0.0)


def graded(gain: float, reach: float) -> Callable[[Rows], Array]:
    """Return forces of contacts of stiffness k = 2E*a (1 + g e^(−a/l))."""
    radius = np.append(0.0, np.geomspace(1e-4, 1.5, 4000) * RADIUS)
    depth = radius**2 / RADIUS
    stiffness = 2 * MODULUS * radius * (1 + gain * np.exp(-radius / reach))
    steps = (stiffness[1:] + stiffness[:-1]) / 2 * np.diff(depth)
    force = np.append(0.0, np.cumsum(steps))
    return lambda rows: np.interp(rows.depth, depth, force, left=0.0)


def tensed(tension: float) -> Callable[[Rows], Array]:
    """Return forces on a solid under tension, by the master curve."""
    bead: Any = pl.indenter("paraboloid", radius=RADIUS)
    return lambda rows: MODULUS * bead.force_curve(rows.depth, 2 * tension / MODULUS).force


def layered(thickness: float) -> Callable[[Rows], Array]:
    """Return forces on an incompressible bonded layer."""
    bead: Any = pl.indenter("paraboloid", radius=RADIUS)
    return lambda rows: MODULUS * bead.layer_force_curve(rows.depth, 0.0, thickness, 0.5).force


def series(give: Callable[[Array], Array]) -> Callable[[Rows], Array]:
    """Return forces of Hertz in series with what gives way."""
    return lambda rows: in_series(hertz, give, rows.depth)


DEPTH = 0.08
"""Largest depth over R."""
TOP = DEPTH * RADIUS
"""The same [m]."""


def truth_of(kind: str, random: np.random.Generator) -> Truth:
    """Return a solid of a kind, its size drawn."""
    uniform, sign = random.uniform, float(random.choice([-1.0, 1.0]))
    largest = float(hertz(TOP))

    def of(force: Callable[[Rows], Array], *right: str, **more: Any) -> Truth:
        return Truth(force, kind, frozenset(right), **more)

    if kind.startswith("tension"):
        tension = float(np.exp(uniform(np.log(0.1), 0.0))) * RADIUS * MODULUS / 2
        return of(tensed(tension), "tension", tension=tension)
    if kind.startswith("sensitivity"):
        error = sign * uniform(0.03, 0.10)
        # The lever bends as far as the solid gives way.
        spring = largest / TOP
        force = series(lambda f: f / spring)
        return of(lambda rows: (1 + error) * force(rows), "compliance", spring=spring)
    match kind:
        case "hertz" | "1/f noise":
            return of(lambda rows: hertz(rows.depth), coloured=kind != "hertz")
        case "power law":
            alpha = uniform(0.05, 0.3)
            force = closed_form("power_law", relaxation_exponent=alpha)
            return of(force, "power_law", relaxed=lambda time: time**-alpha)
        case "standard linear":
            sizes = {"relaxed_share": uniform(0.15, 0.6), "relaxation_time": 10 ** uniform(-1.3, 0)}
            share, constant = sizes.values()
            return of(
                closed_form("standard_linear", **sizes),
                "standard_linear",
                relaxed=lambda time: 1 + share * np.expm1(-time / constant),
            )
        case "adhesion":
            work = uniform(0.02, 0.1) * largest / (1.5 * np.pi * RADIUS)
            return of(closed_form("adhesion", work_of_adhesion=work), "adhesion")
        case "drag":
            # The approach takes 1 s from first touch on.
            drag = uniform(0.02, 0.15) * largest / (np.sqrt(RADIUS * TOP) * TOP)
            return of(closed_form("drag", drag=drag), "drag")
        case "slope":
            slope = sign * uniform(0.01, 0.05) * largest / TOP
            return of(lambda rows: hertz(rows.depth) + slope * rows.depth, "offset", "slope")
        case "drift":
            rate = sign * uniform(0.01, 0.05) * largest
            return of(lambda rows: hertz(rows.depth) + rate * rows.time, "offset", "drift")
        case "thin layer" | "thick layer":
            shares = (1.0, 3.0) if kind == "thin layer" else (3.0, 10.0)
            return of(layered(uniform(*shares) * np.sqrt(DEPTH) * RADIUS), "layer")
        case "worn tip":
            return of(worn(uniform(0.04, 0.18) * RADIUS), "worn_tip")
        case "brush":
            length, first = uniform(50e-9, 150e-9), 0.05 * largest
            return of(series(lambda f: length / 2 / np.pi * np.log1p(f / first)), "brush")
        case "rough toe":
            height, first = uniform(0.01, 0.05) * TOP, 0.01 * largest
            return of(series(lambda f: height * np.log1p(np.cbrt(f / first))), "rough_toe")
        case "stiff surface":
            return of(graded(uniform(0.15, 0.5), uniform(0.1, 0.4) * RADIUS), "stiff_surface")
        case "softening":
            share = uniform(0.1, 0.4)
            return Truth(
                lambda rows: hertz(rows.depth) * (1 - share * rows.depth / TOP), kind, None
            )
    raise ValueError(kind)


KINDS = (
    *("hertz", "1/f noise", "power law", "standard linear", "adhesion", "drag", "slope", "drift"),
    *("thin layer", "thick layer", "worn tip", "brush", "rough toe", "stiff surface"),
    *("softening", "sensitivity, exact", "sensitivity, weighed", "tension"),
)


# --- Curves and their fits -------------------------------------------------------------------


def pink(random: np.random.Generator, size: int) -> Array:
    """Return noise of deviation 1 whose power falls as 1/f."""
    frequencies = np.fft.rfftfreq(4 * size)
    frequencies[0] = np.inf
    real, imaginary = random.standard_normal((2, frequencies.size))
    values = np.fft.irfft((real + 1j * imaginary) / np.sqrt(frequencies))[:size]
    return np.asarray((values - values.mean()) / values.std())


def fitted(
    truth: Truth, protocol: str, share: float, random: np.random.Generator, **more: Any
) -> pl.Fit:
    """Return the fit of curves with noise of a share of the largest force, with more options."""
    curves: dict[str, tuple[Array, Array, Array]] = {}
    for number, rows in enumerate(rows_of(protocol, TOP)):
        force = truth.force(rows)
        draw = pink(random, force.size) if truth.coloured else random.standard_normal(force.size)
        measured = force + share * np.abs(force).max() * draw
        tip = rows.depth + 1e-6 - (measured / truth.spring if truth.spring else 0.0)
        curves[str(number)] = tip, measured, rows.time - rows.time[0]
    options: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS}
    options["segment"] = "both" if protocol == "both" else "approach"
    if truth.spring:
        options["spring_constant"] = truth.spring
    if "weighed" in truth.kind:
        options |= {"uncertainty": {"sensitivity": "6 %"}}
    options |= more
    if len(curves) > 1:
        return pl.fit_pooled(curves, **options)
    ((position, force, time),) = curves.values()
    return pl.fit(position, force, time=time, **options)


def expected(answer: Answer, truth: Truth, protocol: str) -> float:
    """Return χ² without noise of the best explanation that has no tension."""
    paths = rows_of(protocol, TOP)

    def least(fit: Candidate) -> float:
        exact = [
            replace(curve, force=truth.force(rows), counts=None)
            for curve, rows in zip(fit.all_rows, paths, strict=True)
        ]
        objective = replace(fit.objective, curves=tuple(exact), memory=())
        return objective.minimise(fit.minimum.at, steps=MOST).chi_squared

    return min(least(fit) for fit in answer.explanations if "tension" not in fit.types)


def outcome(kind: str, protocol: str, number: int, seed: int) -> dict[str, Any]:
    """Return what the fit of a curve says."""
    random = np.random.default_rng([seed, number, *f"{kind}, {protocol}".encode()])
    truth, share = truth_of(kind, random), random.uniform(*NOISE)
    began = process_time()
    fit = fitted(truth, protocol, share, random)
    seconds, answer = process_time() - began, fit.answer
    best = min(f.aic for f in answer.explanations)
    right = [f for f in answer.explanations if f.types == truth.right]
    times = [rows.time[np.argmax(rows.depth)] for rows in rows_of(protocol, TOP)]
    modulus = MODULUS * truth.relaxed(float(np.exp(np.mean(np.log(times)))))
    return {
        "kind": kind,
        "protocol": protocol,
        "number": number,
        "seed": seed,
        "verdict": answer.verdict.name,
        "chosen": sorted(answer.selected.types),
        "tied": [sorted(f.types) for f in answer.tied],
        "lead": answer.decision.delta_aic,
        "other": sorted(answer.decision.other),
        "behind": right[0].aic - best if right else None,
        "modulus": held(fit.reduced_modulus, modulus),
        "off": _off(fit.reduced_modulus, modulus),
        "tension": held(fit.tension, truth.tension),
        "expected": expected(answer, truth, protocol) if truth.tension else None,
        "seconds": round(seconds, 2),
    }


def held(estimate: pl.Estimate, truth: float) -> bool:
    """Return whether an interval holds a value."""
    low = -np.inf if estimate.low is None else estimate.low
    return bool(low <= truth <= (np.inf if estimate.high is None else estimate.high))


def _off(estimate: pl.Estimate, truth: float) -> float:
    """Return the distance of a value from the truth, over that of the end on its side."""
    if np.isnan(estimate.value):
        return 0.0 if held(estimate, truth) else np.inf
    end = estimate.low if truth < estimate.value else estimate.high
    return 0.0 if end is None else abs((truth - estimate.value) / (end - estimate.value))


# --- The table -------------------------------------------------------------------------------


def tasks(curves: int, seed: int, kinds: Sequence[str]) -> Iterator[tuple[str, str, int, int]]:
    """Yield the curves to fit; a drift on one pass is a slope."""
    for number in range(curves):
        for kind in kinds:
            for protocol in ("both",) if kind == "drift" else PROTOCOLS:
                yield kind, protocol, number, seed


def print_table(found: Sequence[Mapping[str, Any]]) -> None:
    """Print a row for each kind and protocol."""
    heads = ["verdicts", "needed", "needed of those that could", "E* held", "τ₀ held", "CPU s"]
    print_head("kind, protocol", *heads)
    groups = dict.fromkeys((o["kind"], o["protocol"]) for o in found)
    for kind, protocol in sorted(groups):
        mine = [o for o in found if (o["kind"], o["protocol"]) == (kind, protocol)]
        counts = Counter(o["verdict"] for o in mine)
        could = [o for o in mine if o["expected"] is not None and o["expected"] > EXPECTED]
        share = partial(_of, len(mine))
        print_row(
            f"{kind}, {protocol}",
            ", ".join(f"{n} {Verdict[name].value}" for name, n in counts.most_common()),
            share(counts["NEEDED"]),
            _of(len(could), sum(o["verdict"] == "NEEDED" for o in could)) if could else "",
            share(sum(o["modulus"] for o in mine)),
            share(sum(o["tension"] for o in mine)),
            f"{np.median([o['seconds'] for o in mine]):.1f}",
        )


def _of(total: int, count: int) -> str:
    return f"{count} of {total}"


def main() -> None:
    """Fit what is missing, and print the table."""
    path, curves = Path(sys.argv[1]), int(sys.argv[2])
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    kinds = sys.argv[4:] or KINDS
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    found = [json.loads(line) for line in lines]
    done = {(o["kind"], o["protocol"], o["number"], o["seed"]) for o in found}
    for task in tasks(curves, seed, kinds):
        if task not in done:
            found.append(outcome(*task))
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(found[-1]) + "\n")
    print_table([o for o in found if o["kind"] in kinds])


if __name__ == "__main__":
    main()
