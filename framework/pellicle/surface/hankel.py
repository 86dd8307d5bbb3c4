"""From Fourier to real space: the closed form of a kernel, tabulated from its symbol G(q) alone.

    G(r) = (1/2π) ∫₀^∞ G(q) J₀(qr) q dq,    P(R) = ∫₀^R G r dr = (R/2π) ∫₀^∞ G(q) J₁(qR) dq

Both are fast Hankel transforms (Hamilton 2000, Mon. Not. R. Astron. Soc. 312, 257) of samples that
are uniform in log q:

- If G(q) falls hardly faster at large q than at small q (a half-space, a Winkler foundation), its
  asymptotic power law at large q is subtracted and transformed in closed form.
- Towards q = 0 the samples are continued by the power law at their lower end, the far field.
- At large q they are cut off smoothly, where no tabulated radius is affected.

A second transform, of every other sample and with fewer small wavenumbers, estimates the error.
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

_STEP = 1 / 256  # of log q and log r; at 1/128 splines miss a stiff film on a thin gel by 1e-8
_CUT_OFF = 4e3  # q · shortest; the cut-off e^(−(q/cut-off)⁴) changes G(r) by about its 4th power
_TOP = 2.5  # highest sample over the cut-off wavenumber, where the cut-off is below rounding
_DECADES = 10  # of samples below 1/longest, fewer if G q² vanishes before
_VANISHING = 1e-11
_NOISE = 1e-11  # relative, of G(q) and of its remainder without the power law
_SMALLEST_FALL = 0.5  # least difference of the powers of 1/q at large and small q
_SAME_POWER = 0.25
_HIGHEST_POWER = 1.9  # of a power law subtracted; the transform of q⁻² is not finite
_FALL_OF_WEIGHTED = 30.0  # natural logarithm
_MARGIN = 12  # nodes of the splines beyond each end of the tabulated radii
_STEEPEST = 1.5  # power of 1/q towards q = 0; from 2 on displacements are not finite


class KernelTable:
    """A kernel given by G(q) [m/Pa] alone, tabulated in real space between two radii [m].

    Refused are a G(q) that is not positive and finite, grows at large q or leaves no finite
    displacement on a free boundary, and one that cannot be transformed to `ACCURACY`.
    """

    def __init__(self, compliance: Symbol, shortest: float, longest: float) -> None:
        self.compliance = compliance
        self.shortest, self.longest = shortest, longest
        x, values = _samples(compliance, shortest, longest)
        self._power_law, rest = _without_power_law(x, values)
        reach = np.log([shortest, longest])
        self._rg, self._p_over_r = _transform(x, values, rest, reach)
        # Every other sample, including the last, without the first decade.
        later = round(np.log(10) / _STEP)
        coarser = slice(later + (x.size - 1 - later) % 2, None, 2)
        rg, p_over_r = _transform(x[coarser], values[coarser], rest[coarser], reach)
        # Their largest difference, also between nodes.
        log_r = np.linspace(reach[0], reach[1], math.ceil((reach[1] - reach[0]) / _STEP))
        r = np.exp(log_r)
        largest = np.maximum.accumulate(np.abs(self.radial_primitive(r)))
        apart = np.maximum(
            np.abs(rg(log_r) - self._rg(log_r)), np.abs(p_over_r(log_r) - self._p_over_r(log_r))
        )
        self.error = float((apart * r / largest).max())
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

    def greens_function(self, r: Array) -> Array:
        """Return G(r) [m/N]; a constant part of G(q) contributes only at r = 0."""
        return np.asarray(self._power_law.greens_function(r) + self._rg(np.log(r)) / r)

    def radial_primitive(self, r: Array) -> Array:
        """Return P(r) [m³/N]."""
        return np.asarray(self._power_law.radial_primitive(r) + self._p_over_r(np.log(r)) * r)


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
    """Return log q, ascending by `_STEP`, and G(q), from the lowest q that contributes."""

    def values(x: Array) -> Array:
        q = np.exp(x)
        # The values are checked below.
        with np.errstate(all="ignore"):
            sampled = np.broadcast_to(np.asarray(compliance(q), dtype=np.float64), q.shape)
        invalid = np.flatnonzero(~(np.isfinite(sampled) & (sampled > 0)))
        if invalid.size:
            nearest = invalid[np.argmin(np.abs(x[invalid] + np.log(shortest * longest) / 2))]
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
    """Return the power law to be subtracted, that of G(q) at large q, and the remainder."""
    unit_step = round(1 / _STEP)
    low, high = np.log(g[0] / g[unit_step]), np.log(g[-1 - unit_step] / g[-1])
    if high < -_SAME_POWER / 10:
        raise ConfigError(
            f"compliance(q) still grows at q = {np.exp(x[-1]):.3g} rad/m, as q^{-high:.3g}; at "
            "large q it has to fall or to tend to a constant; if it does so beyond, make the cells "
            "finer",
            "kernel",
        )
    if not low + _SMALLEST_FALL > high < _HIGHEST_POWER:
        return _PowerLaw(0.0, 0.0), g
    # Where both ends have the same power, subtracting exactly that leaves a clean far field.
    power = max(0.0, float(low if abs(high - low) < _SAME_POWER else high))
    law = _PowerLaw(float(g[-1] * np.exp(power * x[-1])), power)
    rest = g - law.factor * np.exp(-power * x)
    rest[np.abs(rest) < _NOISE * g] = 0
    return law, rest


def _transform(x: Array, g: Array, f: Array, reach: Array) -> tuple[CubicSpline, CubicSpline]:
    """Return splines in log r of r G(r) and P(r)/r, for the part f of the samples g."""
    # This import takes as long as all others of a worker, and most kernels have a closed form.
    from scipy.interpolate import CubicSpline

    step = (x[-1] - x[0]) / (x.size - 1)
    unit_step = round(1 / step)
    # The remainder without a power law may vanish, at small q or everywhere.
    first = min(int(np.argmax(f != 0)), x.size - 1 - unit_step)
    x, g, f = x[first:], g[first:], f[first:]
    power = float(np.log(np.abs(f[0] / f[unit_step]))) if f[0] and f[unit_step] else 0.0
    if power > _STEEPEST:
        raise ConfigError(
            f"'free' needs a compliance that grows no faster than q^-{_STEEPEST} towards q = 0, or "
            f"displacements are not finite; this one grows as q^-{power:.3g} at "
            f"q = {np.exp(x[0]):.3g} rad/m; use boundary = 'periodic'",
            "grid.boundary",
        )
    weight = _weight(x, g, f, power, reach)
    # The weighted samples and their transform have to vanish at both ends.
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
    # G r and P/r vary least: for a half-space both are constant.
    return (
        CubicSpline(log_r[near], rg[near] / (2 * np.pi), extrapolate=False),
        CubicSpline(log_r[near], (p / (2 * np.pi * r))[near], extrapolate=False),
    )


def _weight(x: Array, g: Array, f: Array, power: float, reach: Array) -> float:
    """Return the exponent b, between the power at small q and 2, with the least rounding error.

    The absolute error of the transform of q^b f is everywhere the rounding of its peak, while its
    value at r scales with the largest g at q > 1/r.
    """
    nonzero, inside = f != 0, (x > -reach[1]) & (x < -reach[0])
    log_g = np.log(np.maximum.accumulate(g[::-1])[::-1][inside])
    part = np.log(np.abs(f[nonzero]))

    def decades(b: float) -> float:
        return float((b * x[nonzero] + part).max(initial=-np.inf) - (b * x[inside] + log_g).min())

    return min((power + share * (2 - power) for share in (0.25, 0.5, 0.75)), key=decades)
