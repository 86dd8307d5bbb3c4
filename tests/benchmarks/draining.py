"""Solids that drain in fits: where the effect's numbers come from, and how far off.

    python tests/benchmarks/draining.py means             coefficients of the effect
    python tests/benchmarks/draining.py forces            of the whole problem: draining_forces.csv

Abel's transform makes the contact of a body of revolution one equation on 0 < s < a(t),
∫ C(s − s′, t − t′) dg(s′, t′) = δ(t) − shape(s), with F ∝ ∫ g ds. C has a closed form in Fourier
space, under a tension, too: of a wave the tension only makes less of the stiffness drain. So a step
takes one small matrix.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.optimize import least_squares
from scipy.special import erf, erfcx, sici

import pellicle as pl
from pellicle_fit.effects.poroelastic import _MEANS, _WIDENS
from tests.draining_gels import (
    DEPTH,
    MODULUS,
    RADIUS,
    Array,
    Gel,
    path_of,
    predicted,
)

SURFACES = "open", "sealed"
RATIOS = 1e-9, 0.25, 0.5, 0.75, 0.97
"""ν / (1 − ν) at which coefficients are fitted."""
LENGTHS = 0.1, 0.2, 0.4, 0.8, 1.5, 3.0, 6.0, 12.0, 25.0
"""s/a at which they are."""

# --- The whole problem in Abel's variable ------------------------------------------------------
# Lengths are over √(R δ), times over R δ / D, and the force at once without tension is 2/3 δ^1.5.

CELLS, REACH, WAVES = 110, 1.1, 1 << 16
LAGS = np.linspace(np.log(1e-7), np.log(3e3), 110)
"""Logarithms of times after a step of pressure at which responses are tabulated."""


def compliance(theta: Array, ratio: Array, surface: str) -> Array:
    """Return that of waves over the one at once, a time θ/(Dq²) after a step of pressure."""
    root = np.sqrt(theta)

    def inverse(b: Array) -> Array:
        late = np.exp(-theta) * erfcx(np.abs(b) * root)
        # What a negative b leaves is erfc(b √θ) = 2 − erfc(−b √θ).
        late = np.where(b >= 0, late, 2 * np.exp((b * b - 1) * theta) - late)
        return erf(root) - b / (1 - b * b) * (1 - late - b * erf(root))

    share = 1 - ratio
    if surface == "open":
        return 1 + share * inverse(ratio)
    low = (np.sqrt(1 + 4 * share) - 1) / 2
    return 1 + share / (2 * low + 1) * (inverse(-low) - inverse(low + 1))


@cache
def matrices(ratio: float, surface: str, length: float) -> Callable[[float], Array]:
    """Return C of all cells as a function of the time since the pressure, of s/a drained."""
    h, drained = REACH / CELLS, 2 / (1 + ratio)
    at_once = length / drained
    q = 4 * np.pi / (WAVES * h) * np.arange(1, WAVES // 2 + 1)
    own = 1 - (1 - ratio) / (1 + at_once * q)
    ends = (np.arange(2 * CELLS + 2) + 0.5) * h

    def elastic(over: float) -> Array:
        """Return ∫ C of an elastic solid so many times as soft as that at once."""
        if not at_once:
            return np.full_like(ends, over / 2)
        z = ends / (over * at_once)
        si, ci = sici(z)
        return over * (0.5 - (ci * np.sin(z) + (np.pi / 2 - si) * np.cos(z)) / np.pi)

    def left(lag: float) -> Array:
        """Return ∫ C less that of the drained solid."""
        waves = compliance(np.exp(lag) * q * q, own, surface) / (1 + at_once * q)
        waves -= drained / (1 + drained * at_once * q)
        sums = -np.fft.fft(np.append(0.0, waves / q), WAVES).imag[1 : 2 * ends.size : 2]
        return (sums + ends * (1 - drained) / 2) * q[0] / np.pi

    later = CubicSpline(LAGS, [elastic(drained) + left(lag) for lag in LAGS])
    apart, across = np.indices((CELLS, CELLS))
    apart, across = np.abs(apart - across), apart + across + 1

    def matrix(passed: float) -> Array:
        sums = later(np.log(passed)) if passed else elastic(1.0)
        w = np.append(2 * sums[0], np.diff(sums))
        return w[apart] + w[across]

    return matrix


def forces(ratio: float, surface: str, length: float, time: Array, depth: Array) -> Array:
    """Return forces on a paraboloid. The first row is a step if its time is 0, others are ramps."""
    matrix, h = matrices(ratio, surface, length), REACH / CELLS
    s = (np.arange(CELLS) + 0.5) * h
    g, force = np.zeros(CELLS), []
    past: list[tuple[float, Array]] = []
    for row, (now, deep) in enumerate(zip(time, depth, strict=True)):
        middle = (now + time[row - 1]) / 2 if row else now / 2
        own = matrix(now - middle)
        left = deep - s**2 - sum((matrix(now - t) @ dg for t, dg in past), np.zeros(CELLS))
        left, new = left + own @ g, np.zeros(CELLS)
        inside = np.flatnonzero(s**2 < 1.3 * deep)
        while inside.size:
            new[:] = 0
            new[inside] = np.linalg.solve(own[np.ix_(inside, inside)], left[inside])
            if (new[inside] > 0).all():
                break
            inside = inside[new[inside] > 0]
        past.append((middle, new - g))
        g = new
        force.append(g.sum() * h)
    return np.array(force)


def area(length: float) -> float:
    """Return that of an elastic solid, over the one without tension, under s/a."""
    bead: Any = pl.indenter("paraboloid", radius=1.0)
    return float(0.75 * bead.force_curve(np.ones(1), length).force[0])


def mean_of(ratio: float, surface: str, length: float, time: Array) -> Array:
    """Return the mean of g, as moduli of a paraboloid that stays tell it, up to times after 0."""
    drained, x = 2 / (1 + ratio), np.sqrt(time)
    force = forces(ratio, surface, length, time, np.ones_like(time))
    moduli = np.geomspace(1 / drained, 1.0, 60)
    known = [m * area(length / drained / m) for m in moduli]
    effective = np.exp(CubicSpline(known, np.log(moduli))(force * known[-1] / force[0]))
    g = np.minimum((drained * effective - 1) / (drained - 1), 1.0)
    return PchipInterpolator(x, 2 * g * x).antiderivative()(x[1:]) / time[1:]


def least(off: Callable[[Array], Array], start: Array) -> Array:
    """Return where the greatest of some differences is about the least, and print that."""
    at = least_squares(lambda p: (300 * off(p)) ** 3, start, max_nfev=100).x
    print(np.round(at, 4).tolist(), *(f"error {np.abs(off(p)).max():.1e}" for p in (start, at)))
    return at


def print_means() -> None:
    """Print the coefficients of the mean of g over √τ, and what they grow by."""
    time = np.append(0, np.geomspace(1e-5, 300, 110))
    x, ratio, s = np.sqrt(time[1:]), np.array(RATIOS)[:, None], np.array(LENGTHS)
    # Under a tension the force grows by less than the modulus does, and few contacts have s > 4a.
    more = np.log([area(1.001 * length) / area(length) for length in LENGTHS])
    weight = (1 - more[:, None] / np.log(1.001)) / (1 + s[:, None] / 4)

    def rational(root: Array, coefficients: Array) -> Array:
        b1, b2, c1, c2, c3 = coefficients[..., None]
        return (1 + root * (b1 + root * b2)) / (1 + root * (c1 + root * (c2 + root * c3)))

    for surface in SURFACES:
        print(surface)
        still = [mean_of(r, surface, 0.0, time) for r in RATIOS]

        def still_off(p: Array, still: Any = still) -> Array:
            return (rational(x, p[:5, None] + p[5:, None] * ratio.T) - still).ravel()

        bare = np.ravel(_MEANS[surface][:2])
        least(still_off, bare)
        tensed = [[mean_of(r, surface, length, time) for length in LENGTHS] for r in RATIOS]

        def off(p: Array, bare: Array = bare, tensed: Any = tensed) -> Array:
            wider, half, own, both = p[0], p[1], p[2:7, None, None], p[7:, None, None]
            of = bare[:5, None, None] + bare[5:, None, None] * ratio
            of = of + (own + both * ratio) * s / (s + half)
            return (weight * (rational(x / (1 + wider * s[:, None]), of) - tensed)).ravel()

        least(off, np.append(_WIDENS[surface], _MEANS[surface][2:]))


def print_forces() -> None:
    """Print greatest differences of the effect from the whole problem, over the largest force."""
    print("surface,nu,s_over_a,drained,ramp,hold")
    time, depth = path_of()
    for surface, length in product(SURFACES, (0.0, 0.3, 1.0, 3.0, 10.0)):
        for ratio, drains in product((0.0, 0.2, 0.4), (0.03, 0.3, 3.0)):
            gel = Gel(ratio, drains, surface, length)
            of = ratio / (1 - ratio), surface, length, drains * time, depth / DEPTH
            force = forces(*of) * 4 * (1 - ratio) * MODULUS * RADIUS**0.5 * DEPTH**1.5
            off = np.abs(predicted(gel) - force) / force.max()
            print(f"{surface},{ratio},{length},{drains},{off[4:60].max():.4f},{off[60:].max():.4f}")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    match sys.argv[1:]:
        case ["means"]:
            print_means()
        case ["forces"]:
            print_forces()
        case _:
            print(__doc__)
