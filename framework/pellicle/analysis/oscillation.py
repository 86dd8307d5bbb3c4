"""An oscillating contact: its complex stiffness and the energy that it dissipates."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array

# Rounding of the number of cycles, which counts steps.
_ROUNDING: Final = 1e-6


@dataclass(frozen=True)
class Oscillation:
    """The response over the last whole cycle of an oscillation; NaN where it is not known."""

    oscillation_frequency: float = nan
    """Frequency f [Hz]."""
    oscillation_amplitude: float = nan
    """Amplitude of the depth at that frequency [m]."""
    storage_stiffness: float = nan
    """K′ [N/m]: the force in phase with the depth over the amplitude."""
    loss_stiffness: float = nan
    """K″ [N/m]: the force a quarter of a cycle ahead of the depth over the amplitude."""
    phase: float = nan
    """Angle by which the force is ahead of the depth [rad]."""
    cycle_dissipation: float = nan
    """∮F dδ [J], the energy dissipated in the cycle."""
    cycle_drift: float = nan
    """Change of depth or force over the cycle, over the amplitude; the larger of the two."""


def oscillations(
    time: ArrayLike,
    cycle: ArrayLike,
    depth: ArrayLike,
    force: ArrayLike,
    converged: ArrayLike | None = None,
) -> list[Oscillation]:
    """Return the response of each oscillation on a path of load steps.

    Depth δ and force F of the last whole cycle are evenly sampled, n times. What each gains over
    the cycle is subtracted as a drift that is linear in time; what it gains over a first cycle,
    which begins at rest, is not known. Then K′ + iK″ = F̂/δ̂ with the Fourier
    coefficients at the frequency, and ∮F dδ is that of the trigonometric interpolants of both. It
    is πK″δ̂² where depth or force is a pure sine. The polygon through the samples encloses less, by
    the share (2π/n)²/6: 0.6 % for n = 32.

    The steps in order have t [s], cycles since the oscillation began, NaN where there is none, δ
    [m] and F [N], each of shape (n,), and whether they ``converged``: the response over a cycle
    with others is NaN.
    """
    t, cycles, delta, load = (np.asarray(v, dtype=float) for v in (time, cycle, depth, force))
    good = np.ones(t.shape, bool) if converged is None else np.asarray(converged, bool)
    # A leg begins where the count of cycles does, or begins anew.
    begins = np.isfinite(cycles) & ~(np.diff(cycles, prepend=nan) > 0)
    ends = np.flatnonzero(np.diff(np.isfinite(cycles).astype(int), append=0) < 0) + 1
    responses = []
    for first in np.flatnonzero(begins):
        after = [*np.flatnonzero(begins[first + 1 :]) + first + 1, *ends[ends > first]]
        leg = slice(int(first), int(min(after)))
        responses.append(_response(leg, t, cycles, delta, load, good))
    return responses


def _response(
    leg: slice, time: Array, cycles: Array, depth: Array, force: Array, good: Array
) -> Oscillation:
    """Return the response over the last whole cycle of the steps of a leg."""
    count = cycles[leg]
    whole = np.floor(count[-1] + _ROUNDING)
    # Steps of the cycle, and the one at which it begins.
    inside = (count > whole - 1 + _ROUNDING) & (count < whole + _ROUNDING)
    steps = leg.start + np.flatnonzero(inside)
    start = steps[0] - 1 if steps.size else -1
    if whole < 1 or start < 0 or not good[start : steps[-1] + 1].all():
        return Oscillation()
    frequency = 1 / (time[steps[-1]] - time[start])
    share = cycles[steps] - (whole - 1)
    gains = [float(v[steps[-1]] - v[start]) if whole > 1 else 0.0 for v in (depth, force)]
    delta, load = (v[steps] - gain * share for v, gain in zip((depth, force), gains, strict=True))
    harmonics = np.arange(steps.size // 2 + 1)
    # The samples begin one step after the start of the cycle.
    turn = np.exp(-2j * np.pi * share[0] * harmonics) / steps.size
    d, f = np.fft.rfft(delta) * turn, np.fft.rfft(load) * turn
    area = 4 * np.pi * float(np.sum((harmonics * (np.conj(d) * f).imag)[: (steps.size + 1) // 2]))
    amplitudes = 2 * abs(d[1]), 2 * abs(f[1])
    if not min(amplitudes) > 0:
        return Oscillation(float(frequency), float(amplitudes[0]))
    stiffness = complex(f[1] / d[1])
    drift = max(abs(gain) / size for gain, size in zip(gains, amplitudes, strict=True))
    return Oscillation(
        float(frequency),
        float(amplitudes[0]),
        stiffness.real,
        stiffness.imag,
        float(np.angle(stiffness)),
        area,
        float(drift) if whole > 1 else nan,
    )
