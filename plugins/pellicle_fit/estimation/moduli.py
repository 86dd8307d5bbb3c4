"""Complex moduli that the sines of a curve tell, with intervals."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from pellicle.arrays import Array
from pellicle_fit.contact.curve import Curve
from pellicle_fit.dynamic import complex_moduli, misfits, recorded_stiffness
from pellicle_fit.effect import ComplexArray

from .candidate import Candidate
from .intervals import CONFIDENCE, Estimate
from .noise import CHANCE

_STEP = 1e-4
"""Step of derivatives by coordinates, in those of the order of 1."""
_WIDTH = float(ndtri((1 + CONFIDENCE) / 2))
"""Standard deviations of half an interval."""
SINE = {
    "frequency": "Hz",
    "storage_stiffness": "N/m",
    "loss_stiffness": "N/m",
    "storage_modulus": "Pa",
    "loss_modulus": "Pa",
    "phase": "rad",
}
"""What is known of a sine, and its unit."""


def of_sines(fit: Candidate, number: int) -> list[dict[str, Estimate]]:
    """Return what each sine of a curve tells under an explanation: see `SINE`.

    K′ and K″ are measured, and so is the phase.  E* is complex for the contact of the explanation,
    whose uncertainty widens its interval, and not that of its law of relaxation.
    """
    curve = fit.all_rows[number]
    if not curve.sines:
        return []
    stiffness = curve.sine_stiffness
    deviations = np.array([sine.deviation for sine in curve.sines])
    modulus, of_modulus = _moduli(fit, number, curve, deviations)
    found = []
    for k, sine in enumerate(curve.sines):
        values = (
            (sine.frequency, 0.0),
            (stiffness[k].real, deviations[k]),
            (stiffness[k].imag, deviations[k]),
            (modulus[k].real, of_modulus[0, k]),
            (modulus[k].imag, of_modulus[1, k]),
            (float(np.angle(stiffness[k])), deviations[k] / abs(stiffness[k])),
        )
        pairs = zip(SINE.items(), values, strict=True)
        found.append({name: _estimate(*value, unit) for (name, unit), value in pairs})
    return found


class Misfit(NamedTuple):
    """A sine that an explanation misses."""

    frequency: float
    """In Hz."""
    off: complex
    """Its stiffness over the explained one, less 1."""


def misfit(fit: Candidate, number: int) -> Misfit | None:
    """Return the sine of a curve that is furthest from an explanation.

    None if all are as near as noise and instrument let them be.
    """
    curve = fit.all_rows[number]
    if not curve.sines:
        return None
    known = fit.known[number]
    far = np.abs(misfits(known, curve))
    k = int(np.argmax(far))
    # χ² of two degrees of freedom, of the furthest of some.
    limit = np.sqrt(-2 * np.log(CHANCE / far.size))
    if far[k] < limit:
        return None
    explained = recorded_stiffness(known, curve)[k]
    return Misfit(curve.sines[k].frequency, complex(curve.sine_stiffness[k] / explained - 1))


def _moduli(
    fit: Candidate, number: int, curve: Curve, deviations: Array
) -> tuple[ComplexArray, Array]:
    """Return E*(ω) [Pa], and the deviations of its parts, of shape (2, sines)."""
    objective, at = fit.objective, fit.minimum.at
    here = complex_moduli(fit.known[number], curve)
    moved = replace(
        curve,
        sines=tuple(
            sine._replace(stiffness=sine.stiffness + d)
            for sine, d in zip(curve.sines, deviations, strict=True)
        ),
    )
    own = np.abs(complex_moduli(fit.known[number], moved) - here)
    free = objective.within(at)
    jacobian = objective.jacobian(at, free)
    covariance = np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-14, hermitian=True)
    rates = []
    for k in free:
        there = at.copy()
        there[k] += _STEP
        rates.append((complex_moduli(objective.known(there, number), curve) - here) / _STEP)
    slopes = np.array(rates).reshape(len(free), here.size)
    parts = np.array([slopes.real, slopes.imag])
    variances = np.einsum("pks,kl,pls->ps", parts, covariance, parts)
    return here, np.sqrt(np.maximum(variances, 0.0) + own**2)


def _estimate(value: float, deviation: float, unit: str) -> Estimate:
    half = _WIDTH * deviation
    return Estimate(float(value), float(value - half), float(value + half), unit)
