"""A curve on its own: the parameters that explain it best, and its noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import fdtrc

from pellicle.errors import ConfigError
from pellicle.operators import Array

from .likelihood import OFFSET, POINT, SLOPE, Likelihood, least
from .posed import Posed
from .start import starts

_QUIET = 20
"""Points before contact that the noise can be taken from."""
_OFF = 4.0
"""Standard errors that the force before contact may be from 0."""
_CHANCE = 1e-3
"""A misfit less likely than this is no chance."""


@dataclass(frozen=True)
class Explained:
    """A curve on its own: its likelihood with its noise, and the best parameters."""

    posed: Posed
    likelihood: Likelihood
    parameters: Array
    freedom: float
    """Degrees of freedom of the noise."""
    noise_from: str
    messages: tuple[str, ...]


def explain(posed: Posed) -> Explained:
    """Return the best parameters of a curve and its noise.

    Raises
    ------
    ConfigError
        Nothing explains the curve.
    """
    curve, asked = posed.curve, posed.asked
    messages = list(curve.messages)
    largest = float(np.max(np.abs(curve.force)))
    rough = Likelihood(
        curve.position, curve.force, asked.indenter, largest, asked.free, curve.stiffness
    )
    minimum = least(rough.minimise(start) for start in _starts(rough, asked.held))
    noise, freedom, source = _noise(rough, minimum.parameters, messages)
    likelihood = replace(rough, noise=noise)
    return Explained(posed, likelihood, minimum.parameters, freedom, source, tuple(messages))


def _starts(likelihood: Likelihood, held: Array) -> list[Array]:
    found = starts(likelihood, held)
    if not found:
        raise ConfigError(
            "is nowhere pushed back as an indenter would be; check signs, indenter and fix", "force"
        )
    return found


def _noise(rough: Likelihood, parameters: Array, messages: list[str]) -> tuple[float, float, str]:
    """Return standard deviation [N], its degrees of freedom, and where it comes from."""
    residuals = rough.residuals(parameters) * rough.noise
    least = rough.accuracy * rough.noise
    span = float(np.ptp(rough.position))
    before = rough.position < parameters[POINT] - 0.01 * span
    baseline = sum(k in rough.free for k in (OFFSET, SLOPE))
    freedom = residuals.size - len(rough.free)
    overall = float(np.sqrt(np.sum(residuals**2) / freedom))
    if before.sum() < _QUIET:
        messages.append(
            f"only {before.sum()} points lie before contact, so the noise is taken from the "
            "residuals of the fit, and how well the model fits cannot be told; start further out"
        )
        return max(overall, least), freedom, "residuals of the fit"
    # About their mean: an offset that is not fitted is no noise.
    mean = 0.0 if baseline else float(np.mean(residuals[before]))
    quiet = float(before.sum()) - max(baseline, 1)
    noise = max(float(np.sqrt(np.sum((residuals[before] - mean) ** 2) / quiet)), least)
    source = f"{before.sum()} points before contact"
    if abs(mean) > _OFF * noise / np.sqrt(quiet) and abs(mean) > 10 * least:
        messages.append(
            f"the force before contact is {-mean:.3g} N, not 0, and modulus and tension are off by "
            "it; fit it too, with baseline 'offset', or 'slope' if it drifts"
        )
    contact = residuals[~before]
    loose = max(contact.size - (len(rough.free) - baseline), 1)
    misfit = float(np.sum(contact**2)) / loose / noise**2
    if misfit > 1 and fdtrc(loose, quiet, misfit) < _CHANCE:
        held = "" if POINT in rough.free else f", contact from {parameters[POINT]:g} m on"
        messages.append(
            f"in contact the residuals are {np.sqrt(misfit):.2g} times the noise before it: the "
            f"model (this indenter, this elastic solid, no adhesion{held}) does not describe the "
            "curve; the intervals are widened by that factor"
        )
        return noise * float(np.sqrt(misfit)), min(quiet, loose), f"{source}, widened by the misfit"
    return noise, quiet, source
