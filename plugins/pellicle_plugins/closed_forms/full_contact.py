"""Full contact of a sinusoidal surface with a half-space under surface tension."""

from __future__ import annotations

import numpy as np

from .arguments import not_negative, positive


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
