"""From Fourier to real space: the closed form of a kernel, tabulated from its symbol G(q) alone.

    G(r) = (1/2π) ∫₀^∞ G(q) J₀(qr) q dq,    P(R) = ∫₀^R G r dr = (R/2π) ∫₀^∞ G(q) J₁(qR) dq

Both are fast Hankel transforms (Hamilton 2000, Mon. Not. R. Astron. Soc. 312, 257) of samples that
are uniform in log q:

- If G(q) falls hardly faster at large q than at small q (a half-space, a Winkler foundation), the
  power law that it ends with at large q is taken out and transformed in closed form.
- Towards q = 0 the samples go on as the power law that they end with there: the far field.
- At large q they are cut off smoothly, where no radius asked for can tell.

A second transform, of every other sample and with an earlier start, gives the error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import scipy.fft
from scipy.special import gamma, rgamma

from pellicle.arrays import Array
from pellicle.errors import ConfigError

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

Symbol = Callable[[Array], Array]

ACCURACY = 1e-7
"""Bound on the errors of P(r) and r² G(r), relative to the largest |P| up to r."""

_STEP = 1 / 128  # of log q and log r; splines between cost about 1e-10
_CUT_OFF = 4e3  # q · shortest; the cut-off e^(−(q/cut-off)⁴) changes G(r) by about its 4th power
_TOP = 2.5  # of the samples over the cut-off, where that is below rounding
_DECADES = 10  # of samples below 1/longest, less if G q² vanishes before
_VANISHING = 1e-11
_NOISE = 1e-11  # of G(q), and of what is left of it without its power law
_SMALLEST_FALL = 0.5  # by which the powers of 1/q at large and small q have to differ
_SAME_POWER = 0.25
_HIGHEST_POWER = 1.9  # of a power law taken out; that of q⁻² is not finite
_FALL_OF_WEIGHTED = 30.0  # natural logarithm
_MARGIN = 12  # of nodes around the radii asked for, against the ends of the splines
_STEEPEST = 1.5  # power of 1/q towards q = 0; from 2 on no displacement is finite


class Tabulated:
    """A kernel known by G(q) [m/Pa] alone, with its closed form between two radii [m].

    Raises
    ------
    ConfigError
        G(q) is not positive and finite, grows at large q, leaves no finite displacement on a free
        boundary, or cannot be transformed to `ACCURACY`.
    """

    def __init__(self, compliance: Symbol, shortest: float, longest: float) -> None:
        self.compliance = compliance
        self.shortest, self.longest = shortest, longest
        x, values = _samples(compliance, shortest, longest)
        self._power_law, rest = _without_power_law(x, values)
        reach = np.log([shortest, longest])
        self._rg, self._p_over_r = _transform(x, values, rest, reach)
        coarser = _every_other(x.size)
        self.error = self._apart(
            reach, *_transform(x[coarser], values[coarser], rest[coarser], reach)
        )
        """Estimated error, relative as `ACCURACY` is."""
        if not self.error <= ACCURACY:
            raise ConfigError(
                f"its displacement around a point force cannot be computed from compliance(q): the "
                f"estimated error is {self.error:.0e}, {ACCURACY:.0e} is allowed; make "
                "compliance(q) smooth, and exact to rounding for "
                f"{_wavenumbers(shortest, longest)}, make the cells finer if they are much larger "
                "than the lengths of the kernel, or give greens_function(r) and "
                "radial_primitive(r)",
                "kernel",
            )

    def covers(self, shortest: float, longest: float) -> bool:
        """Tell whether all radii between these are tabulated."""
        return self.shortest <= shortest and longest <= self.longest

    def greens_function(self, r: Array) -> Array:
        """Return G(r) [m/N]; that of a constant part of G(q) is zero beside the point force."""
        return self._power_law.greens_function(r) + _real(self._rg(np.log(r))) / r

    def radial_primitive(self, r: Array) -> Array:
        """Return P(r) [m²/N]."""
        return self._power_law.radial_primitive(r) + _real(self._p_over_r(np.log(r))) * r

    def _apart(self, reach: Array, rg: CubicSpline, p_over_r: CubicSpline) -> float:
        """Return how far a coarser table is away, at nodes and between."""
        log_r = np.linspace(reach[0], reach[1], math.ceil((reach[1] - reach[0]) / _STEP))
        r = np.exp(log_r)
        largest = np.maximum.accumulate(np.abs(self.radial_primitive(r)))
        apart = np.maximum(
            np.abs(rg(log_r) - self._rg(log_r)), np.abs(p_over_r(log_r) - self._p_over_r(log_r))
        )
        return float((apart * r / largest).max())


class _PowerLaw(NamedTuple):
    """c q⁻ⁿ, 0 ≤ n < 2, in real space (Gradshteyn & Ryzhik 6.561.14)."""

    factor: float
    power: float

    def greens_function(self, r: Array) -> Array:
        n = self.power
        factor = self.factor * 2 ** (-n) * gamma(1 - n / 2) * rgamma(n / 2) / np.pi
        return np.asarray(factor * r ** (n - 2) if factor else np.zeros_like(r))

    def radial_primitive(self, r: Array) -> Array:
        n = self.power
        factor = self.factor * 2 ** (-n - 1) * gamma(1 - n / 2) * rgamma(1 + n / 2) / np.pi
        return np.asarray(factor * r**n if factor else np.zeros_like(r))


def _samples(compliance: Symbol, shortest: float, longest: float) -> tuple[Array, Array]:
    """Return log q, ascending by `_STEP`, and G(q), down to where it does not count."""

    def values(x: Array) -> Array:
        q = np.exp(x)
        # What comes of it is looked at, and said in words.
        with np.errstate(all="ignore"):
            sampled = np.broadcast_to(np.asarray(compliance(q), dtype=np.float64), q.shape)
        wrong = np.flatnonzero(~(np.isfinite(sampled) & (sampled > 0)))
        if wrong.size:
            nearest = wrong[np.argmin(np.abs(x[wrong] + np.log(shortest * longest) / 2))]
            raise ConfigError(
                f"compliance(q) is {sampled[nearest]:.3g} m/Pa at q = {q[nearest]:.3g} rad/m; it "
                f"has to be positive and finite for {_wavenumbers(shortest, longest)}; check the "
                "parameters, or the formula if the kernel is yours",
                "kernel",
            )
        return sampled

    top, longest_wave = np.log(_TOP * _CUT_OFF / shortest), -np.log(longest)
    x = [top - _STEP * np.arange(np.ceil((top - longest_wave) / _STEP) + 1)]
    g = [values(x[0])]
    below = _STEP * np.arange(1, round(1 / _STEP) + 1)
    least = _VANISHING * g[0][-1] * np.exp(2 * x[0][-1])
    while x[-1][-1] > longest_wave - _DECADES * np.log(10) and (
        g[-1][-1] * np.exp(2 * x[-1][-1]) > least
    ):
        x.append(x[-1][-1] - below)
        g.append(values(x[-1]))
    return np.concatenate(x)[::-1], np.concatenate(g)[::-1]


def _wavenumbers(shortest: float, longest: float) -> str:
    return f"q from about {10.0**-_DECADES / longest:.0e} to {_TOP * _CUT_OFF / shortest:.0e} rad/m"


def _without_power_law(x: Array, g: Array) -> tuple[_PowerLaw, Array]:
    """Return the power law that G(q) ends with at large q, if it has to go, and what is left."""
    one = round(1 / _STEP)
    low, high = np.log(g[0] / g[one]), np.log(g[-1 - one] / g[-1])
    if high < -_SAME_POWER / 10:
        raise ConfigError(
            f"compliance(q) still grows at q = {np.exp(x[-1]):.3g} rad/m, as q^{-high:.3g}; at "
            "large q it has to fall or to tend to a constant; if it does so beyond, make the cells "
            "finer",
            "kernel",
        )
    if not low + _SMALLEST_FALL > high < _HIGHEST_POWER:
        return _PowerLaw(0.0, 0.0), g
    # Where both ends have one power, taking it exactly leaves a clean far field.
    power = max(0.0, float(low if abs(high - low) < _SAME_POWER else high))
    law = _PowerLaw(float(g[-1] * np.exp(power * x[-1])), power)
    rest = g - law.factor * np.exp(-power * x)
    rest[np.abs(rest) < _NOISE * g] = 0
    return law, rest


def _transform(x: Array, g: Array, f: Array, reach: Array) -> tuple[CubicSpline, CubicSpline]:
    """Return r G(r) and P(r)/r of the part f of the samples g, as splines of log r."""
    # Its import takes as long as all the others of a worker, most kernels have a closed form.
    from scipy.interpolate import CubicSpline

    step = (x[-1] - x[0]) / (x.size - 1)
    one = round(1 / step)
    # What is left without a power law may be nothing, at small q or everywhere.
    first = min(int(np.argmax(f != 0)), x.size - 1 - one)
    x, g, f = x[first:], g[first:], f[first:]
    power = float(np.log(np.abs(f[0] / f[one]))) if f[0] and f[one] else 0.0
    if power > _STEEPEST:
        raise ConfigError(
            f"'free' needs a compliance that grows no faster than q^-{_STEEPEST} towards q = 0, or "
            f"displacements are not finite; this one grows as q^-{power:.3g} at "
            f"q = {np.exp(x[0]):.3g} rad/m; use boundary = 'periodic'",
            "grid.boundary",
        )
    weight = _weight(x, g, f, power, reach)
    # The samples weighted, and what they become, have to vanish at both ends.
    more = int(_FALL_OF_WEIGHTED / min(weight - power, 2 - weight) / step)
    size = 2 * scipy.fft.next_fast_len((x.size + more) // 2)
    log_q = x[-1] - step * np.arange(size)[::-1]
    full = np.concatenate((f[0] * np.exp(power * (x[0] - log_q[: size - x.size])), f))
    full *= np.exp(-((_TOP * np.exp(log_q - x[-1])) ** 4))
    log_r = -log_q[::-1]
    r = np.exp(log_r)
    rg = scipy.fft.fht(full * np.exp(log_q), step, 0, bias=1 - weight)
    p = scipy.fft.fht(full, step, 1, bias=-weight)
    first, last = np.searchsorted(log_r, reach)
    near = slice(first - _MARGIN, last + _MARGIN)
    # Of G r and P/r, which vary least: for a half-space both are constant.
    return (
        CubicSpline(log_r[near], rg[near] / (2 * np.pi), extrapolate=False),
        CubicSpline(log_r[near], (p / (2 * np.pi * r))[near], extrapolate=False),
    )


def _weight(x: Array, g: Array, f: Array, power: float, reach: Array) -> float:
    """Return the b, between the power at small q and 2, for which rounding matters least.

    The transform of q^b f is everywhere as accurate as rounding at its peak. What is wanted of it
    at r goes as the largest g at q > 1/r.
    """
    there, inside = f != 0, (x > -reach[1]) & (x < -reach[0])
    wanted = np.log(np.maximum.accumulate(g[::-1])[::-1][inside])
    part = np.log(np.abs(f[there]))

    def decades(b: float) -> float:
        return float((b * x[there] + part).max(initial=-np.inf) - (b * x[inside] + wanted).min())

    return min((power + share * (2 - power) for share in (0.25, 0.5, 0.75)), key=decades)


def _every_other(size: int) -> slice:
    """Return every other sample, the last one included, from a decade later on."""
    later = round(np.log(10) / _STEP)
    return slice(later + (size - 1 - later) % 2, None, 2)


def _real(values: object) -> Array:
    return np.asarray(values, dtype=np.float64)
