"""How often a fit claims a tension that is not there, on curves of other solids than its own.

A claim is *silent* if no check of the curve fails.  Run it:
``python tests/benchmarks/fit_checks.py [curves of each kind [seed]]``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from fit_rivals import BEFORE, DEPTH, NOISE, POINTS, RADIUS, Array, pink_noise, shape
from fit_rivals import MODULUS_ as MODULUS
from tables import curves_of_kinds, print_head, print_row

import pellicle as pl

_DEEP = 0.3
"""Largest depth over R of curves too deep for a paraboloid."""
_SHARE, _DIP = 0.15, 0.01
"""By how much a solid softens or relaxes; adhesion, over the largest force."""


@dataclass(frozen=True)
class Kind:
    """Curves of one kind."""

    force: Callable[[Array, np.random.Generator], Array]
    """Force without noise over Hertz at the largest depth, of depths over the largest."""
    leaves_mark: bool = True
    """Whether the curve itself shows that the model is wrong."""
    depth: float = DEPTH
    """Largest depth over R."""
    baseline: str = "none"
    colour: Callable[[np.random.Generator], Array] | None = None
    """Noise of variance 1 that is not white."""


def _hertz(depth: Array) -> Array:
    return np.maximum(depth, 0.0) ** 1.5


def _softening(depth: Array, _: np.random.Generator) -> Array:
    return _hertz(depth) * (1 - _SHARE * np.maximum(depth, 0.0))


def _relaxing(depth: Array, _: np.random.Generator) -> Array:
    """Return the force of a standard linear solid pressed at constant speed (Lee & Radok 1960)."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    share = (nodes[:, None] + 1) / 2
    time = np.maximum(depth, 0.0)
    kept = 1 - _SHARE + _SHARE * np.exp(-time * (1 - share**2) / 0.3)
    # ∫ E(t − t′) d(t′^1.5) with t′ = t u².
    force: Array = time**1.5 * np.sum(weights[:, None] / 2 * 3 * share**2 * kept, axis=0)
    return force


def _power(depth: Array, _: np.random.Generator) -> Array:
    return np.maximum(depth, 0.0) ** 1.3


def _dip(depth: Array, random: np.random.Generator) -> Array:
    """Return Hertz less a constant attraction, which before contact decays within 2 to 10 %."""
    decay = random.uniform(0.02, 0.1)
    return _hertz(depth) - _DIP * np.exp(np.minimum(depth, 0.0) / decay)


def _adhesion(depth: Array, _: np.random.Generator) -> Array:
    """Return the force of Johnson, Kendall & Roberts (1971) from where it pushes back."""
    # Pull-off 3πwR/2, with w over the scale that makes Hertz at the largest depth 1.
    energy = _DIP / (1.5 * np.pi)
    radius = np.linspace(1e-3, 1.3, 20000)
    force = radius**3 - np.sqrt(6 * np.pi * energy * radius**3)
    pressed = radius**2 - np.sqrt(8 * np.pi * energy * radius / 3)
    pushes = np.argmax(force > 0)
    shifted = depth + pressed[pushes]
    return np.where(depth > 0, np.interp(shifted, pressed[pushes:], force[pushes:]), 0.0)


def _ball(depth: Array, _: np.random.Generator) -> Array:
    largest = shape("paraboloid").force_curve(np.array([_DEEP * RADIUS]), 0.0).force[0]
    return np.asarray(shape("sphere").force_curve(depth * _DEEP * RADIUS, 0.0).force / largest)


def _deflection(depth: Array, _: np.random.Generator) -> Array:
    """Return Hertz against the position of a base whose cantilever bends by a tenth of it."""
    tip = np.linspace(-BEFORE, 1.0, 20000)
    return np.interp(depth, tip + 0.1 * _hertz(tip), _hertz(tip))


def _drift(depth: Array, random: np.random.Generator) -> Array:
    across = random.choice([-1, 1]) * random.uniform(0.01, 0.05)
    return np.asarray(_hertz(depth) + across * (depth - depth[0]) / np.ptp(depth))


def _clean(depth: Array, _: np.random.Generator) -> Array:
    return _hertz(depth)


def _tensed(depth: Array, random: np.random.Generator) -> Array:
    length = np.exp(random.uniform(np.log(0.03), np.log(1.0))) * RADIUS
    curve = shape("paraboloid").force_curve(depth * DEPTH * RADIUS, length).force
    force: Array = curve / curve[-1]
    return force


RIVALS = {
    "softening by 15 %": Kind(_softening),
    "dip of 1 % before contact": Kind(_dip),
    "drift, baseline offset": Kind(_drift, baseline="offset"),
    "1/f noise": Kind(_clean, colour=lambda random: pink_noise(random, POINTS)),
    "sphere fitted as a paraboloid, to 0.3 R": Kind(_ball, depth=_DEEP),
    "F ~ δ^1.3": Kind(_power, leaves_mark=False),
    "relaxing by 15 %": Kind(_relaxing, leaves_mark=False),
    "adhesion of 1 % without a dip": Kind(_adhesion, leaves_mark=False),
    "deflection not subtracted": Kind(_deflection, leaves_mark=False),
}
"""Solids and instruments without tension."""
CONTROLS = {"no tension": Kind(_clean), "tension, s/R 0.03 to 1": Kind(_tensed)}
"""What the model describes."""


class Outcome(NamedTuple):
    """What a fit says of one curve."""

    claims: bool
    """Whether the interval of the tension leaves out 0."""
    failed: tuple[str, ...]
    """Codes of the checks that fail."""

    @property
    def is_silent(self) -> bool:
        """Whether a tension is claimed and nothing is said."""
        return self.claims and not self.failed


def curve(kind: Kind, random: np.random.Generator) -> tuple[Array, Array]:
    """Return position [m] and force [N] of one curve."""
    depth = np.linspace(-BEFORE, 1.0, POINTS)
    force = kind.force(depth, random)
    noise = random.standard_normal(POINTS) if kind.colour is None else kind.colour(random)
    force = force + random.uniform(*NOISE) * float(force.max()) * noise
    deepest = kind.depth * RADIUS
    return depth * deepest + 1e-6, 4 / 3 * MODULUS * np.sqrt(RADIUS * deepest**3) * force


def outcomes(kind: Kind, curves: int, seed: int) -> Iterator[Outcome]:
    """Yield what fits by a paraboloid say of random curves."""
    random = np.random.default_rng(seed)
    for _ in range(curves):
        position, force = curve(kind, random)
        fit = pl.fit(
            position,
            force,
            indenter="paraboloid",
            radius=RADIUS,
            baseline=kind.baseline,
        )
        codes = tuple(check.code for check in fit.failed_checks)
        yield Outcome(fit.tension.low is not None, codes)


def main() -> None:
    """Print a row of a table for each kind."""
    kinds = RIVALS | CONTROLS
    curves, seed, names = curves_of_kinds(__doc__, list(kinds), 50, 7)
    print_head(f"{curves} curves each", "claimed", "silent", "flagged", "checks that fail")
    for name in names:
        results = list(outcomes(kinds[name], curves, seed))
        shares = (
            100 * sum(values) / curves
            for values in (
                [outcome.claims for outcome in results],
                [outcome.is_silent for outcome in results],
                [bool(outcome.failed) for outcome in results],
            )
        )
        codes = sorted({code for outcome in results for code in outcome.failed})
        print_row(name, *(f"{share:.0f} %" for share in shares), ", ".join(codes))


if __name__ == "__main__":
    main()
