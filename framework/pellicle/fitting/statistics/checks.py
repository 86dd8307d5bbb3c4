"""Checks of a fit by its own residuals, and the noise that they leave."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc

from pellicle.arrays import Array

from .baseline_checks import check_baseline, falling_baseline
from .likelihood import POINT, Likelihood
from .noise import BinnedNoise
from .residuals import CHANCE, FailedCheck, NoiseEstimate, Residuals, exceeds, independent_freedom

_QUIET = 20
"""Rows before contact that the noise can be taken from."""
_DEPTHS = (0, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4, 1)
"""Edges of bins of the rows in contact, over the depth: most models fail near first touch."""
_WILD = 7.0
"""Standard deviations from the mean of its neighbours beyond which a row is a spike."""
_NORMAL = 1.4826
"""Standard deviation of normal numbers over their median absolute deviation."""


class Examined(NamedTuple):
    """Noise of a curve, and what its residuals show of the model."""

    noise: float
    """Standard deviation of the force [N], widened by the checks that fail."""
    freedom: float
    """Degrees of freedom."""
    source: str
    """What the noise was taken from."""
    failed: tuple[FailedCheck, ...]
    messages: tuple[str, ...]


def examine(likelihood: Likelihood, parameters: Array) -> Examined:
    """Return the noise of a curve at its best parameters, and the checks that it fails there.

    The noise is the scatter before contact about what drifts or dips there, or what the sums of
    residuals over bins show if a check fails.  The noise of ``likelihood`` cancels.
    """
    residuals = Residuals.of(likelihood, parameters)
    spikes = _spikes(residuals)
    count = int(residuals.before.sum())
    messages: tuple[str, ...] = ()
    if count < _QUIET:
        source = "residuals of the fit"
        messages = (
            f"only {count} points lie before contact, so the noise is taken from the residuals of "
            "the fit, and drift or adhesion before contact cannot be told; start further out, or "
            "fit the baseline too if the force out there is not 0",
        )
        whole = _check_whole(residuals)
    else:
        source = f"{count} points before contact"
        messages = falling_baseline(residuals)
        whole = _check_contact(residuals, check_baseline(residuals))
    failed = (*spikes, *whole.failed)
    if failed:
        source += f"; checks that fail: {', '.join(check.code for check in failed)}"
    return Examined(whole.noise, whole.freedom, source, failed, messages)


def _spikes(residuals: Residuals) -> list[FailedCheck]:
    """Return whether rows lie far from both neighbours."""
    force = residuals.force
    if force.size < _QUIET:
        return []
    off = force[1:-1] - (force[2:] + force[:-2]) / 2
    spread = max(_NORMAL * float(np.median(np.abs(off - np.median(off)))), residuals.floor)
    # A spike also moves the means beside it, by half as much and to the other side.
    wild = np.abs(off) > _WILD * spread
    wild[1:-1] &= (np.abs(off[1:-1]) >= np.abs(off[:-2])) & (np.abs(off[1:-1]) >= np.abs(off[2:]))
    if not (count := int(wild.sum())):
        return []
    first = int(np.argmax(wild)) + 1
    return [
        FailedCheck(
            "spikes",
            f"{count} points lie more than {_WILD:g} standard deviations from their neighbours, "
            f"first that at {residuals.likelihood.position[first]:.6g} m: such spikes are no "
            "normal noise, and shift the fit; leave them out",
        )
    ]


def _check_whole(residuals: Residuals) -> NoiseEstimate:
    """Return the noise of a curve that has too few rows before contact."""
    rows = residuals.force.size
    freedom = rows - len(residuals.likelihood.free)
    noise = max(float(np.sqrt(np.sum(residuals.force**2) / freedom)), residuals.floor)
    independent = residuals.independent_noise(np.ones(rows, dtype=bool))
    sums = residuals.binned(_contact_bins(residuals))
    if sums is None or not exceeds(sums, independent, independent_freedom(rows)):
        return NoiseEstimate(noise, freedom, ())
    failed = (_pattern(residuals, sums, independent),)
    if sums.noise <= noise:
        return NoiseEstimate(noise, freedom, failed)
    return NoiseEstimate(sums.noise, sums.freedom, failed)


def _check_contact(residuals: Residuals, before: NoiseEstimate) -> NoiseEstimate:
    """Return the noise with what the residuals in contact add to that before."""
    contact = ~residuals.before
    count = int(contact.sum())
    loose = max(count - len(residuals.likelihood.free) + residuals.baseline, 1)
    scatter = float(np.sqrt(np.sum(residuals.force[contact] ** 2) / loose))
    noise, freedom, failed = before.noise, before.freedom, list(before.failed)
    if scatter > noise and fdtrc(loose, freedom, (scatter / noise) ** 2) < CHANCE:
        failed.append(_misfit(residuals, scatter / noise))
        noise, freedom = scatter, min(freedom, loose)
    sums = residuals.binned(_contact_bins(residuals))
    if sums is None:
        return NoiseEstimate(noise, freedom, tuple(failed))
    independent = residuals.independent_noise(contact)
    if before.slow is None:
        wrong = exceeds(sums, independent, independent_freedom(count))
    else:
        wrong = exceeds(sums, max(before.slow.noise, independent), before.slow.freedom)
    if wrong:
        failed.append(_pattern(residuals, sums, independent))
    # Noise that is slower than the bins before contact shows in the wider ones in contact.
    if (wrong or before.slow is not None) and sums.noise > noise:
        noise, freedom = sums.noise, sums.freedom
    return NoiseEstimate(noise, freedom, tuple(failed))


def _contact_bins(residuals: Residuals) -> Array:
    """Return a column for each bin of the rows in contact, narrow near first touch."""
    share = residuals.depth / float(residuals.depth[-1])
    number = np.digitize(share, _DEPTHS[1:-1])
    number[residuals.before] = -1
    return np.where(number[:, None] == np.arange(len(_DEPTHS) - 1), 1.0, 0.0)


def _model(residuals: Residuals) -> str:
    """Return what the model takes for granted."""
    point = residuals.parameters[POINT]
    fixed = "" if residuals.is_free(POINT) else f", contact from {point:g} m on"
    return f"the model (this indenter, this elastic solid, no adhesion{fixed})"


def _misfit(residuals: Residuals, factor: float) -> FailedCheck:
    return FailedCheck(
        "misfit",
        f"in contact the residuals are {factor:.2g} times the noise before it: "
        f"{_model(residuals)} does not describe the curve; the intervals are widened by that "
        "factor",
    )


def _pattern(residuals: Residuals, sums: BinnedNoise, independent: float) -> FailedCheck:
    factor = np.sqrt(sums.excess(independent))
    return FailedCheck(
        "pattern",
        f"in contact the residuals follow a pattern, with sums {factor:.2g} times those of "
        f"independent noise: {_model(residuals)} does not describe the curve; the intervals are "
        "widened by that factor",
    )
