"""Contact of a sinusoidal surface: partial without tension, full with any.

Partial contact: Westergaard (1939); Johnson (1985), section 13.2.  The rigid surface has the height
Δ cos(2πx/λ): Δ is the amplitude, half of the height from valley to crest, and every
crest x = nλ carries a strip of contact |x − nλ| < a.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array

from .arguments import not_negative, positive, single


@dataclass(frozen=True)
class WavyContact:
    """Contact of a wavy surface in plane strain."""

    wavelength: float
    """λ [m]."""
    half_width: float
    """a [m], half the width of a strip; λ/2 in full contact."""
    mean_pressure: float
    """Mean over the whole surface [Pa]."""
    full_pressure: float
    """p* = π E* Δ / λ [Pa], the mean pressure at which contact becomes full."""

    def pressure(self, x: ArrayLike) -> Array:
        """Return the pressure [Pa] at x [m], of any shape.

        2 p̄ cos ψ sqrt(sin² ψ_a − sin² ψ) / sin² ψ_a with ψ = πx/λ, and p̄ + p* cos 2ψ
        once contact is full.
        """
        psi = np.pi * np.asarray(x, dtype=float) / self.wavelength
        if self.mean_pressure >= self.full_pressure:
            return np.asarray(self.mean_pressure + self.full_pressure * np.cos(2 * psi))
        share = self.mean_pressure / self.full_pressure
        root = np.sqrt(np.maximum(0.0, share - np.sin(psi) ** 2))
        return np.asarray(2 * self.full_pressure * np.abs(np.cos(psi)) * root)


def wavy(
    amplitude: float,
    wavelength: float,
    reduced_modulus: float,
    *,
    mean_pressure: float | None = None,
    half_width: float | None = None,
) -> WavyContact:
    """Return the contact of a wavy surface, p̄ = p* sin²(πa/λ), for p̄ [Pa] or a ≤ λ/2 [m].

    Δ is the amplitude, λ the wavelength [m], and E* = E / (1 − ν²) [Pa].
    """
    positive(amplitude=amplitude, wavelength=wavelength, reduced_modulus=reduced_modulus)
    quantity, value = single(mean_pressure=mean_pressure, half_width=half_width)
    full = pressure_amplitude(amplitude, wavelength, reduced_modulus)
    if quantity == "half_width":
        not_negative(gap_width=wavelength / 2 - value)
        value = full * float(np.sin(np.pi * value / wavelength)) ** 2
    share = min(1.0, value / full)
    return WavyContact(
        wavelength=wavelength,
        half_width=wavelength / np.pi * float(np.arcsin(np.sqrt(share))),
        mean_pressure=value,
        full_pressure=full,
    )


def pressure_amplitude(
    amplitude: float, wavelength: float, reduced_modulus: float, tension: float = 0.0
) -> float:
    """Return the amplitude [Pa] of the pressure that keeps a sine in full contact.

    A displacement Δ cos(q x) needs the pressure (E*/2)(q + s q²) Δ cos(q x) about its
    mean, q = 2π/λ and s = 2τ₀/E*: the stiffness symbol of the tensed half-space.
    Contact is full once the mean pressure reaches this amplitude.  Δ [m] is half of the height from
    valley to crest, λ [m] the wavelength, E* = E / (1 − ν²) [Pa] and τ₀ [N/m] the tension.
    """
    not_negative(amplitude=amplitude, tension=tension)
    positive(wavelength=wavelength, reduced_modulus=reduced_modulus)
    q = 2 * np.pi / wavelength
    return (reduced_modulus * q / 2 + tension * q**2) * amplitude
