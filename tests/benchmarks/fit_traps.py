"""Curves that have misled fits of a tension: what the verdicts on them are.

Tensions that are there, on an approach alone; both passes on tensed solids that relax, by runs of
the solver; tips worn to a flat; a cone under tension that is fitted as a sphere.  None but the
first may be called needed.  Run it:
``python tests/benchmarks/fit_traps.py [curves of each kind [seed [names of kinds]]]``.
"""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from tables import curves_of_kinds

import pellicle as pl

Array = NDArray[np.float64]
RADIUS, MODULUS = 5e-6, 2e3
DEEPEST = 0.1
"""Depth over R."""
ROWS, BEFORE = 1000, 0.3
"""Rows of a pass, and range before contact over that in it."""
BEAD: Any = pl.indenter("paraboloid", radius=RADIUS)


class Curve(NamedTuple):
    """Positions [m], forces [N] and times [s] of a measurement, and what it is fitted as."""

    position: Array
    force: Array
    time: Array
    segment: str = "approach"
    indenter: str = "paraboloid"


def approach(force: Callable[[Array], Array], noise: float, random: np.random.Generator) -> Curve:
    """Return an approach with a force at depths [m], of noise over the largest force."""
    share = np.linspace(-BEFORE, 1.0, ROWS)
    forces = force(share * DEEPEST * RADIUS)
    forces = forces + noise * forces.max() * random.standard_normal(ROWS)
    return Curve(share * DEEPEST * RADIUS + 3e-6, forces, share + BEFORE)


def tensed(random: np.random.Generator) -> Curve:
    """Return a paraboloid on a solid under tension, s/R 0.3 to 1."""
    length = RADIUS * float(np.exp(random.uniform(np.log(0.3), 0.0)))
    return approach(lambda depth: MODULUS * BEAD.force_curve(depth, length).force, 0.005, random)


def worn_tip(random: np.random.Generator) -> Curve:
    """Return a paraboloid worn to a flat of 0.08 to 0.19 R, without tension.

    δ = (a/R) √(a² − b²), F = (2 E*/3R) (2a² + b²) √(a² − b²) (Popov, Heß & Willert 2019).
    """
    flat = RADIUS * random.uniform(0.08, 0.19)

    def force(depth: Array) -> Array:
        deep = np.maximum(depth, 0.0)
        squared = (flat**2 + np.sqrt(flat**4 + 4 * (RADIUS * deep) ** 2)) / 2
        rise = np.sqrt(np.maximum(squared - flat**2, 0.0))
        return np.asarray(2 * MODULUS / (3 * RADIUS) * (2 * squared + flat**2) * rise)

    return approach(force, random.uniform(0.003, 0.01), random)


def cone_as_a_sphere(random: np.random.Generator) -> Curve:
    """Return a cone of 60 to 75° on a solid under tension, fitted as a sphere."""
    cone: Any = pl.indenter("cone", half_angle=np.radians(random.uniform(60, 75)))
    length = RADIUS * random.uniform(0.1, 0.3)
    curve = approach(lambda depth: MODULUS * cone.force_curve(depth, length).force, 0.005, random)
    return curve._replace(indenter="sphere")


def relaxing(random: np.random.Generator) -> Curve:
    """Return both passes on a tensed solid that relaxes, s/R 0.2 to 1, by a run of the solver."""
    tension = MODULUS * RADIUS / 2 * float(np.exp(random.uniform(np.log(0.2), 0.0)))
    path = np.linspace(0.0, 1.0, 25)[1:] ** 2
    depth = DEEPEST * RADIUS * np.concatenate([path, path[::-1][1:]])
    time = np.concatenate([path, 2 - path[::-1][1:]])
    solved = relaxing_run(random, tension, depth, time)
    share = np.linspace(-BEFORE, 1.0, ROWS)
    times = np.concatenate([share, 2 - share[::-1]])
    force = np.interp(times, np.concatenate([[0.0], time]), np.concatenate([[0.0], solved]))
    force += 0.005 * force.max() * random.standard_normal(force.size)
    position = DEEPEST * RADIUS * np.concatenate([share, share[::-1]]) + 3e-6
    return Curve(position, force, times + BEFORE, "both")


def relaxing_run(
    random: np.random.Generator, tension: float, depth: Array, time: Array, points: int = 96
) -> Array:
    """Return forces [N] on a tensed solid that relaxes at depths [m] and times [s]."""
    law: dict[str, Any] = {"power_law": {"exponent": random.uniform(0.1, 0.3), "time": 1.0}}
    if random.uniform() < 0.4:
        share, constant = random.uniform(0.3, 0.8), random.uniform(0.1, 0.5)
        law = {"relaxation": [{"fraction": share, "time": constant}]}
    solid = {"type": "half_space", "reduced_modulus": MODULUS}
    substrate = {"type": "viscoelastic", "solid": solid, **law}
    run = {
        "grid": {"points": points, "size": 11 * float(np.sqrt(RADIUS * depth.max()))},
        "kernel": {"type": "coated", "tension": tension, "substrate": substrate},
        "indenter": {"type": "paraboloid", "radius": RADIUS},
        "loading": {"depth": depth.tolist(), "time": time.tolist()},
    }
    with warnings.catch_warnings():
        # Steps that just touch are coarse; their forces are below the noise.
        warnings.simplefilter("ignore", pl.ConvergenceWarning)
        return np.asarray(pl.run(run, progress=False).dataset["force"].values)


KINDS: dict[str, Callable[[np.random.Generator], Curve]] = {
    "tension": tensed,
    "tensed and relaxing": relaxing,
    "worn tip": worn_tip,
    "cone as a sphere": cone_as_a_sphere,
}


def curve_of(kind: str, seed: int, index: int) -> Curve:
    """Return a curve of a kind."""
    return KINDS[kind](np.random.default_rng([seed, list(KINDS).index(kind), index]))


def fitted(curve: Curve, **options: Any) -> pl.Fit:
    """Return the fit of a curve."""
    return pl.fit(
        curve.position,
        curve.force,
        time=curve.time,
        indenter=curve.indenter,
        radius=RADIUS,
        segment=curve.segment,
        **options,
    )


def main() -> None:
    """Print the verdicts on the curves of each kind."""
    count, seed, kinds = curves_of_kinds(__doc__, list(KINDS), 12, 1)
    for name in kinds:
        verdicts: Counter[str] = Counter()
        for index in range(count):
            fit = fitted(curve_of(name, seed, index))
            verdicts[fit.verdict.value] += 1
            ends = [(e.value, e.low, e.high) for e in (fit.reduced_modulus, fit.tension)]
            print(f"  {name} {index}: {ends} {fit.comparison}", flush=True)
        print(f"{name}: {', '.join(f'{n} {word}' for word, n in verdicts.items())}", flush=True)


if __name__ == "__main__":
    main()
