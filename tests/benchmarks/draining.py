"""Solids that drain in fits: where the effect's numbers come from, how far off, and what fits tell.

    python tests/benchmarks/draining.py means             coefficients of the effect
    python tests/benchmarks/draining.py forces            against the kernel: draining_forces.csv
    python tests/benchmarks/draining.py fits FILE 20      fits of curves from the kernel

Abel's transform makes the contact of a body of revolution one equation on 0 < s < a(t),
∫ C(s − s′, t − t′) dg(s′, t′) = δ(t) − shape(s), with F ∝ ∫ g ds. Without tension C has a closed
form in Fourier space, so a step takes one small matrix.
"""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Callable, Sequence
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.optimize import least_squares
from scipy.special import erf, erfc, erfcx

import pellicle as pl
from tests.draining_gels import MODULUS, RADIUS, Array, Gel, measured, predicted, solved

SURFACES = "open", "sealed"
RATIOS = 1e-9, 0.25, 0.5, 0.75, 0.97
"""ν / (1 − ν) at which coefficients are fitted."""

# --- The whole problem in Abel's variable ------------------------------------------------------


def compliance(theta: Array, ratio: float, surface: str) -> Array:
    """Return that of waves over the one at once, a time θ/(Dq²) after a step of pressure."""

    def inverse(b: float) -> Array:
        root = np.sqrt(theta)
        late = np.exp(-theta) * erfcx(b * root) if b >= 0 else np.exp((b * b - 1) * theta)
        late = late if b >= 0 else late * erfc(b * root)
        return erf(root) - b / (1 - b * b) * (1 - late - b * erf(root))

    share = 1 - ratio
    if surface == "open":
        return 1 + share * inverse(ratio)
    low = (np.sqrt(1 + 4 * share) - 1) / 2
    return 1 + share / (2 * low + 1) * (inverse(-low) - inverse(low + 1))


@cache
def primitive(ratio: float, surface: str) -> Callable[[Array], Array]:
    """Return ∫ of the response around a point from 0 to x √(D t)."""
    drained, reach = 2 / (1 + ratio), {"open": 12, "sealed": 60}[surface]
    k = np.linspace(0, reach, 2000 * reach + 1)[1:]
    rest, x = compliance(k * k, ratio, surface) - drained, np.linspace(0, 30, 1501)
    sums = np.array([(np.sin(at * k) / k * rest).sum() for at in x])
    values = (drained - 1) / 2 + k[0] * (sums + 0.5 * x * (1 - drained)) / np.pi
    spline = CubicSpline(x, values)

    def odd(at: Array) -> Array:
        far = np.abs(at)
        near = np.where(far < x[-1], spline(np.minimum(far, x[-1])), values[-1] * x[-1])
        return np.sign(at) * near / np.where(far < x[-1], 1.0, np.maximum(far, x[-1]))

    return odd


def forces(
    ratio: float, surface: str, time: Array, depth: Array, cells: int = 110, reach: float = 1.1
) -> Array:
    """Return forces on a paraboloid of radius 1 and D = 1, that of the contact at once 2/3 δ^1.5.

    The first row is a step, others are ramps.
    """
    h = reach / cells
    s, odd = (np.arange(cells) + 0.5) * h, primitive(ratio, surface)
    index, lags = np.arange(cells), np.arange(2 * cells + 1)

    def matrix(passed: float) -> Array:
        if not passed:
            return np.eye(cells)
        width = np.sqrt(passed) / h
        w = odd((lags + 0.5) / width) - odd((lags - 0.5) / width)
        apart, across = index[:, None] - index, index[:, None] + index + 1
        return np.eye(cells) + w[np.abs(apart)] + w[across]

    g, force = np.zeros(cells), []
    past: list[tuple[float, Array]] = []
    for row, (now, deep) in enumerate(zip(time, depth, strict=True)):
        middle = (now + time[row - 1]) / 2 if row else now
        own = matrix(now - middle)
        left = deep - s**2 - sum((matrix(now - t) @ dg for t, dg in past), np.zeros(cells))
        left, new = left + own @ g, np.zeros(cells)
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


def print_means() -> None:
    """Print the coefficients of the mean of g over √τ, and what they grow by with ν / (1 − ν)."""
    time = np.append(0, np.geomspace(1e-5, 300, 150))
    x = np.sqrt(time)[1:]
    for surface in SURFACES:
        means = []
        for ratio in RATIOS:
            force = forces(ratio, surface, time, np.ones_like(time))
            drained = force[0] * (1 + ratio) / 2
            g = PchipInterpolator(np.append(0, x), (force - drained) / (force[0] - drained))
            weighed = PchipInterpolator(np.append(0, x), g(np.append(0, x)) * 2 * np.append(0, x))
            means.append(weighed.antiderivative()(x) / time[1:])

        def off(p: Array, means: Sequence[Array] = means) -> Array:
            rows = []
            for ratio, mean in zip(RATIOS, means, strict=True):
                b1, b2, c1, c2, c3 = p[:5] + ratio * p[5:]
                over = 1 + c1 * x + c2 * x**2 + c3 * x**3
                rows.append((1 + b1 * x + b2 * x**2) / over - mean)
            return np.concatenate(rows)

        found = least_squares(off, np.ones(10))
        found = least_squares(lambda p, off=off: (1e3 * off(p)) ** 3, found.x)
        print(surface, np.round(found.x, 4).tolist(), f"error {np.abs(off(found.x)).max():.1e}")


# --- Against the kernel ------------------------------------------------------------------------


def print_forces() -> None:
    """Print the greatest difference of the effect from the kernel, over the largest force."""
    print("surface,nu,s_over_a,drained,ramp,hold")
    for surface, length in product(SURFACES, (0.0, 0.3, 1.0, 3.0, 10.0)):
        for ratio, drains in product((0.0, 0.2, 0.4), (0.03, 0.3, 3.0)):
            gel = Gel(ratio, drains, surface, length)
            force = solved(gel, points=96)[2]
            off = np.abs(predicted(gel) - force) / force.max()
            print(f"{surface},{ratio},{length},{drains},{off[4:60].max():.4f},{off[60:].max():.4f}")


# --- Fits --------------------------------------------------------------------------------------

PROTOCOLS = "approach", "hold", "speeds", "radii"


def outcome(gel: Gel, protocol: str, number: int) -> dict[str, Any]:
    """Return what the fit of a curve, or of two, says."""
    random = np.random.default_rng([number, *repr((gel, protocol)).encode()])
    noise = random.uniform(0.003, 0.01)
    paths = {"speeds": ((1.0, 1.0), (10.0, 1.0)), "radii": ((1.0, 1.0), (1.0, 0.25))}
    radii, curves = [], {}
    for i, (seconds, share) in enumerate(paths.get(protocol, ((1.0, 1.0),))):
        radii.append(share * RADIUS)
        path = solved(gel, seconds, share * RADIUS)
        curves[str(i)] = measured(path, random, noise, holds=protocol == "hold")
    options: dict[str, Any] = {
        "indenter": "paraboloid",
        "radius": radii if len(set(radii)) > 1 else RADIUS,
    }
    if len(curves) > 1:
        fit = pl.fit_pooled(curves, **options)
    else:
        position, force, time = curves["0"]
        segment = "both" if protocol == "hold" else "approach"
        fit = pl.fit(position, force, time=time, segment=segment, **options)
    answer = fit.answer
    known = answer.selected.estimates.get("diffusivity")
    return {
        **gel._asdict(),
        "protocol": protocol,
        "number": number,
        "verdict": answer.verdict.name,
        "chosen": sorted(answer.selected.types),
        "modulus": [fit.reduced_modulus.low, fit.reduced_modulus.high],
        "diffusivity": known and [known.low, known.high],
    }


def print_fits(path: Path, curves: int) -> None:
    """Fit what is missing, and print a row for each gel and protocol."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    found = [json.loads(line) for line in lines]
    gels = [
        Gel(ratio, drains, length=length)
        for ratio, drains, length in product((0.0, 0.2, 0.4), (0.3, 3.0), (0.0, 0.5))
    ]
    for number, gel, protocol in product(range(curves), gels, PROTOCOLS):
        if not any(
            (Gel(*(o[k] for k in Gel._fields)), o["protocol"], o["number"])
            == (gel, protocol, number)
            for o in found
        ):
            found.append(outcome(gel, protocol, number))
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(found[-1]) + "\n")
    print("nu,drained,s_over_a,protocol,curves,tension_needed,named,modulus_held,diffusivity_held")
    for gel, protocol in product(gels, PROTOCOLS):
        mine = [
            o
            for o in found
            if Gel(*(o[k] for k in Gel._fields)) == gel and o["protocol"] == protocol
        ]
        named = [o for o in mine if "poroelastic" in o["chosen"]]
        print(
            *(gel.ratio, gel.drains, gel.length, protocol, len(mine)),
            *(sum(o["verdict"] == "NEEDED" for o in mine), len(named)),
            sum(_holds(o["modulus"], MODULUS) for o in mine),
            sum(_holds(o["diffusivity"] or (0, 0), gel.diffusivity) for o in named),
            sep=",",
        )


def _holds(ends: Sequence[float | None], truth: float) -> bool:
    low, high = ends
    return (low is None or low <= truth) and (high is None or truth <= high)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    match sys.argv[1:]:
        case ["means"]:
            print_means()
        case ["forces"]:
            print_forces()
        case ["fits", file, count]:
            print_fits(Path(file), int(count))
        case _:
            print(__doc__)
