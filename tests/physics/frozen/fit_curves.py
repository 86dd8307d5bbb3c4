"""Measured curves of known solids, for the freeze of fits: closed forms, nothing of the program.

The random numbers are the bits of a generator whose stream is fixed, so that every version of numpy
makes the same curves.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import beta, betainc, ndtri

from pellicle.arrays import Array

RADIUS, MODULUS, TOUCH = 5e-6, 2e3, 1e-6
"""R [m], E* [Pa], and the position of first touch [m]."""
BEFORE = 0.3
"""Range before contact, over that in it."""
_STRETCH = np.geomspace(0.01, 30, 15)
_TENSED = CubicSpline(
    np.log(_STRETCH),
    np.log(
        np.fromstring(
            "0.009511 0.016801 0.029618 0.052038 0.090961 0.157798 0.270915 0.459114 0.766815 "
            "1.262552 2.053671 3.311574 5.314074 8.515676 13.664419",
            sep=" ",
        )
    ),
)
"""Logarithm of F/F of Hertz − 1 of a paraboloid under tension, over that of s/√(Rδ)."""
_BONDED = 1, 1.133, 1.283, 0.769, 0.0975
"""F/F of Hertz on a bonded layer by powers of √(Rδ)/h (Dimitriadis et al. 2002, ν = ½)."""


class Measurement(NamedTuple):
    """One curve, as an instrument writes it."""

    position: Array
    """[m], of shape (n,), growing into the solid; of the tip, with the noise of its deflection."""
    force: Array
    """[N], of shape (n,)."""
    time: Array
    """[s], of shape (n,)."""


class Case(NamedTuple):
    """Curves of one solid, what was done to it, and how they are fitted."""

    curves: tuple[Measurement, ...]
    """Several are pooled."""
    effects: frozenset[str]
    """What the solid does beside being elastic."""
    values: Mapping[str, float]
    """The true parameters in SI."""
    noise: float
    """Standard deviation of the force [N]."""
    options: Mapping[str, Any]
    """Of the fit, beside a paraboloid of the radius."""
    full: bool
    """Whether the fit compares all explanations."""


class Path(NamedTuple):
    """Depth [m], time since first touch [s] and sense of motion of the rows."""

    depth: Array
    time: Array
    sense: Array


def normal(seed: int, size: int) -> Array:
    """Return independent normal numbers."""
    bits = np.random.PCG64(seed).random_raw(size) >> np.uint64(11)
    return np.asarray(ndtri((bits + 0.5) / 2**53))


def pink(seed: int, size: int) -> Array:
    """Return normal numbers of deviation 1 whose power falls as 1/f."""
    frequencies = np.fft.rfftfreq(4 * size)
    frequencies[0] = np.inf
    real, imaginary = normal(seed, 2 * frequencies.size).reshape(2, -1)
    values = np.fft.irfft((real + 1j * imaginary) / np.sqrt(frequencies))[:size]
    return np.asarray((values - values.mean()) / values.std())


def path(segment: str, points: int, deepest: float, rate: float = 1.0) -> Path:
    """Return the rows of a path that goes in within 1 s over ``rate``."""
    down = np.linspace(-BEFORE, 1.0, points)
    halves = np.linspace(-BEFORE, 1.0, points // 2)
    rest = np.linspace(0.0, 1.0, points // 2)
    depth, time, sense = {
        "approach": (down, down, np.ones(points)),
        "retract": (down[::-1], 2 - down[::-1], -np.ones(points)),
        "both": (
            np.append(halves, halves[::-1]),
            np.append(halves, 2 - halves[::-1]),
            np.repeat([1.0, -1.0], points // 2),
        ),
        "dwell": (
            np.append(halves, np.ones(rest.size)),
            np.append(halves, 1 + rest),
            np.repeat([1.0, 0.0], points // 2),
        ),
    }[segment]
    return Path(deepest * depth, time / rate, sense)


def hertz(depth: Array | float) -> Array:
    """Return the force of Hertz [N]."""
    return np.asarray(4 / 3 * MODULUS * np.sqrt(RADIUS) * np.maximum(depth, 0.0) ** 1.5)


def _tensed(rows: Path, values: Mapping[str, float]) -> Array:
    """Return the force that a tension adds to that of Hertz."""
    length = 2 * values["tension"] / MODULUS
    stretch = length / np.sqrt(RADIUS * np.maximum(rows.depth, 1e-30))
    stretch = np.clip(stretch, _STRETCH[0], 1e3)
    return np.asarray(hertz(rows.depth) * np.exp(_TENSED(np.log(stretch))))


def _relaxed(
    rows: Path, response: Callable[[Array, Array], Array], primitive: Callable[[Array], Array]
) -> Array:
    """Return the force of a solid that relaxes, by Lee & Radok and Ting.

    ``response(t, t1)`` is ∫ E(t − t′) d(t′^1.5) up to t1, in units of the time of loading.
    """
    top = rows.time[np.argmax(rows.depth)]
    time = np.maximum(rows.time / top, 0.0)
    last = np.minimum(time, 1.0)
    out = rows.sense < 0
    low, high = np.full(out.sum(), -1e-9), np.ones(out.sum())
    for _ in range(60):
        middle = (low + high) / 2
        # ∫ E(t − t′) dδ over the growth from t1 on and over the retraction.
        growth = primitive(time[out] - middle) - 2 * primitive(time[out] - 1)
        low, high = np.where(growth > 0, middle, low), np.where(growth > 0, high, middle)
    last[out] = np.maximum(low, 0.0)
    return np.asarray(np.where(time > 0, hertz(rows.depth.max()) * response(time, last), 0.0))


def _power_law(rows: Path, values: Mapping[str, float]) -> Array:
    """Return the force of E* (t / 1 s)^−α."""
    alpha, top = values["relaxation_exponent"], rows.time[np.argmax(rows.depth)]
    whole = 1.5 * beta(1.5, 1 - alpha) * top**-alpha

    def response(t: Array, t1: Array) -> Array:
        share = np.divide(t1, t, out=np.zeros_like(t), where=t > 0)
        return np.asarray(t ** (1.5 - alpha) * whole * betainc(1.5, 1 - alpha, share))

    return _relaxed(rows, response, lambda t: t ** (1 - alpha))


def _standard_linear(rows: Path, values: Mapping[str, float]) -> Array:
    share, constant = values["relaxed_share"], values["relaxation_time"]
    constant /= rows.time[np.argmax(rows.depth)]
    nodes, weights = np.polynomial.legendre.leggauss(80)
    u, weights = (nodes[:, None] + 1) / 2, weights / 2

    def response(t: Array, t1: Array) -> Array:
        kept = 1 - share + share * np.exp(-(t - t1 * u**2) / constant)
        return np.asarray(t1**1.5 * (weights @ (3 * u**2 * kept)))

    def primitive(t: Array) -> Array:
        return np.asarray((1 - share) * t - share * constant * np.expm1(-t / constant))

    return _relaxed(rows, response, primitive)


def _adhesion(rows: Path, values: Mapping[str, float]) -> Array:
    """Return the force of Johnson, Kendall & Roberts down to the end of its branch."""
    work = values["work_of_adhesion"]
    radius = np.geomspace(1e-3 * RADIUS, RADIUS, 4000)
    depth = radius**2 / RADIUS - np.sqrt(2 * np.pi * work * radius / MODULUS)
    force = 4 / 3 * MODULUS * radius**3 / RADIUS - np.sqrt(8 * np.pi * MODULUS * work * radius**3)
    stable = slice(int(np.argmin(depth)), None)
    touches = np.where(rows.sense < 0, rows.depth > depth.min(), rows.depth > 0)
    return np.where(touches, np.interp(rows.depth, depth[stable], force[stable]), 0.0)


def _layer(rows: Path, values: Mapping[str, float]) -> Array:
    share = np.sqrt(RADIUS * np.maximum(rows.depth, 0.0)) / values["thickness"]
    return np.asarray(hertz(rows.depth) * np.polynomial.Polynomial(_BONDED)(share))


def _ball(rows: Path, values: Mapping[str, float]) -> Array:
    """Return the force of a whole sphere (Sneddon 1965)."""
    radius = RADIUS * np.linspace(1e-4, 0.95, 20_000)
    logarithm = np.log((RADIUS + radius) / (RADIUS - radius))
    force = MODULUS / 2 * ((radius**2 + RADIUS**2) * logarithm - 2 * radius * RADIUS)
    depth = np.append(0.0, radius * logarithm / 2)
    return np.asarray(np.interp(np.maximum(rows.depth, 0.0), depth, np.append(0.0, force)))


_INSTEAD = {
    "power_law": _power_law,
    "standard_linear": _standard_linear,
    "adhesion": _adhesion,
    "layer": _layer,
    "sphere": _ball,
}
"""Forces of effects in place of that of Hertz; no curve has two of them."""


def force(rows: Path, effects: frozenset[str], values: Mapping[str, float]) -> Array:
    """Return the force [N] of a solid.

    Where a tension acts beside another effect their forces are added, which no theory does: fits
    get a curve with something of both.
    """
    other = [_INSTEAD[name](rows, values) for name in sorted(effects & _INSTEAD.keys())]
    total = other[0] if other else hertz(rows.depth)
    if values.get("tension"):
        total = total + _tensed(rows, values)
    if "drag" in effects:
        rate = np.ptp(rows.depth[rows.sense > 0]) / np.ptp(rows.time[rows.sense > 0])
        radius = np.sqrt(RADIUS * np.maximum(rows.depth, 0.0))
        total = total + values["drag"] * radius * rate * rows.sense
    if "slope" in effects:
        total = total + values["slope"] * (rows.depth - rows.depth[0])
    if "drift" in effects:
        total = total + values["drift"] * (rows.time - rows.time.min())
    return total


def measured(
    rows: Path,
    effects: frozenset[str],
    values: Mapping[str, float],
    noise: Array,
    spring: float | None = None,
    step: float = 0.0,
) -> Measurement:
    """Return what an instrument makes of a path: with noise [N], in steps [N] of its detector."""
    exact = force(rows, effects, values)
    seen = exact + noise
    if step:
        seen = step * np.round(seen / step)
    # A cantilever's base goes where it is sent; the deflection is subtracted with its noise.
    position = rows.depth + TOUCH - ((seen - exact) / spring if spring else 0.0)
    return Measurement(position, seen, rows.time + 1.0)


def case(
    *effects: str,
    segment: str = "approach",
    share: float = 0.005,
    seed: int = 0,
    points: int = 260,
    depth: float = 0.08,
    coloured: bool = False,
    spring: float | None = None,
    step: float = 0.0,
    offset: float = 0.0,
    rates: tuple[float, ...] = (1.0,),
    options: Mapping[str, Any] | None = None,
    full: bool = False,
    **values: float,
) -> Case:
    """Return curves of a solid with some effects.

    ``share`` is the noise over the largest force, ``depth`` the deepest over R; ``step`` and
    ``offset`` are over the largest force too, ``rates`` the speed of each curve over the first.
    """
    known = frozenset(effects)
    true = {"contact_point": TOUCH, "reduced_modulus": MODULUS} | values
    curves = []
    for number, rate in enumerate(rates):
        rows = path(segment, points, depth * RADIUS, rate)
        top = float(np.max(np.abs(force(rows, known, true))))
        draw = (pink if coloured else normal)(100 * seed + number, rows.depth.size)
        noise = share * top * draw + offset * top
        curves.append(measured(rows, known, true, noise, spring, step * top))
    fitted: dict[str, Any] = {} if segment in ("approach", "dwell") else {"segment": segment}
    if spring:
        fitted |= {"spring_constant": spring}
    return Case(tuple(curves), known, true, share * top, fitted | dict(options or {}), full)


TENSION = MODULUS * RADIUS / 2
"""Tension [N/m] of s = R."""
HERTZ = 4 / 3 * MODULUS * RADIUS**2 * 0.08**1.5
"""Force of Hertz [N] at the deepest row of most curves."""
WORK = HERTZ / (1.5 * np.pi * RADIUS)
"""Work of adhesion [J/m²] that pulls off at that force."""
DRAG = HERTZ / (np.sqrt(0.08) * RADIUS * 0.08 * RADIUS)
"""Drag [Pa s] of about that force."""
CASES: dict[str, Case] = {
    "elastic": case(),
    "elastic, much noise": case(share=0.01, seed=1),
    "power law": case("power_law", seed=2, relaxation_exponent=0.1),
    "standard linear": case("standard_linear", seed=4, relaxed_share=0.5, relaxation_time=0.3),
    "drag": case("drag", seed=6, drag=0.05 * DRAG),
    "drag, strong": case("drag", seed=7, drag=0.12 * DRAG),
    "adhesion": case("adhesion", seed=8, work_of_adhesion=0.03 * WORK, full=True),
    "adhesion, strong": case("adhesion", seed=9, work_of_adhesion=0.1 * WORK),
    "slope": case("slope", seed=10, slope=0.05 * HERTZ / 1e-6),
    "slope, baseline fitted": case(
        "slope", seed=11, slope=-0.05 * HERTZ / 1e-6, options={"baseline": "slope"}
    ),
    "layer": case("layer", seed=12, thickness=5e-6, full=True),
    "layer, thick": case("layer", seed=13, thickness=12e-6),
    "ball": case("sphere", seed=14, depth=0.5),
    "ball as a sphere": case("sphere", seed=15, depth=0.5, options={"indenter": "sphere"}),
    "1/f noise": case(seed=16, coloured=True),
    "1/f noise, power law": case("power_law", seed=17, coloured=True, relaxation_exponent=0.2),
    "tension, weak": case("tension", seed=18, tension=0.05 * TENSION),
    "tension": case("tension", seed=19, tension=0.3 * TENSION),
    "tension, almost a tie": case("tension", seed=108, tension=0.3 * TENSION),
    "tension, little noise": case("tension", seed=21, share=0.001, tension=0.1 * TENSION),
    "tension and adhesion": case(
        "tension", "adhesion", seed=22, tension=0.2 * TENSION, work_of_adhesion=0.05 * WORK
    ),
    "tension and slope": case(
        "tension", "slope", seed=23, tension=0.5 * TENSION, slope=0.05 * HERTZ / 1e-6
    ),
    "retraction": case("tension", segment="retract", seed=24, tension=0.3 * TENSION),
    "retraction, adhesion in the noise": case(
        "adhesion", segment="retract", seed=25, work_of_adhesion=0.005 * WORK
    ),
    "retraction, adhesion": case(
        "adhesion", segment="retract", seed=26, work_of_adhesion=0.1 * WORK
    ),
    "both passes": case("tension", segment="both", seed=27, tension=0.3 * TENSION),
    "both passes, power law": case("power_law", segment="both", seed=28, relaxation_exponent=0.15),
    "both passes, drift": case("drift", segment="both", seed=41, drift=0.01 * HERTZ),
    "both passes, adhesion": case(
        "adhesion", segment="both", seed=29, work_of_adhesion=0.08 * WORK
    ),
    "dwell": case(
        "standard_linear", segment="dwell", seed=30, relaxed_share=0.4, relaxation_time=0.4
    ),
    "layer given": case(
        "layer", seed=31, thickness=5e-6, options={"thickness": 5e-6, "poissons_ratio": 0.5}
    ),
    "layer free": case(
        "layer", seed=32, thickness=5e-6, options={"thickness": "free", "poissons_ratio": 0.5}
    ),
    "cantilever and offset": case(
        "tension",
        seed=33,
        tension=0.3 * TENSION,
        spring=0.05,
        offset=0.02,
        options={"baseline": "offset"},
    ),
    "steps of the detector": case(seed=35, share=0.002, step=0.02),
    "depth known": case(
        "tension", seed=36, tension=0.3 * TENSION, options={"fix": {"contact_point": TOUCH}}
    ),
    "tension known": case(
        "tension", seed=37, tension=0.3 * TENSION, options={"fix": {"tension": 0.3 * TENSION}}
    ),
    "many rows": case("tension", seed=38, points=3400, share=0.02, tension=0.3 * TENSION),
    "two speeds": case(
        "power_law", seed=39, rates=(1.0, 0.1), points=200, relaxation_exponent=0.15
    ),
}
