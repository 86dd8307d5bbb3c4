"""Noise of a curve from neighbours, detector steps and sums over bins; checks before contact.

The points before contact show adhesion, drift, offset, slow noise and detector steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import bdtrc, fdtrc, ndtr, ndtri

from pellicle.arrays import Array, Mask
from pellicle.units import decimal, readable
from pellicle_fit.long_memory import differenced
from pellicle_fit.models.adhesive import WORK_OF_ADHESION
from pellicle_fit.parameters import OFFSET, SLOPE, Coordinates, Parameter

from .likelihood import Likelihood

CHANCE = 1e-3
"""Probability that a check flags a curve without fault."""
_FAILING = 0.01
"""Probability that a curve without fault fails some check of the model."""
_RARE = 0.05
"""Probability below which the number of failing curves is not attributed to chance."""
_NEAR = 0.01
"""Distance from contact beyond which a point counts as before it, over the range of positions."""
_OF_NOISE = ("slow_noise", "spikes", "steps")
_TIES = 0.9
"""Number of distinct values over that of points below which the values may be detector steps."""
_OFF_STEP = 0.05
"""Largest deviation of a value from a multiple of the detector step, over the step."""
_EQUAL = 1e-9
"""Difference, over the range, below which values differ by rounding only."""
_RANK = 1e-6
"""Singular values below this share of a norm belong to combinations of bins without points."""
_OFFSET_LIMIT = 4.0
"""Standard errors beyond which the mean force before contact counts as an offset."""
_WINDOWS = (1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32)
"""Widths of the windows next to contact in which a dip is sought, over the points before it."""
_FEWEST = 3
"""Points of the narrowest window."""
_DEEPEST = float(ndtri(CHANCE / len(_WINDOWS)))
"""Standard errors of the deepest dip that is due to chance (Bonferroni's correction)."""
_BINS = 8
_COARSE = 2.0
"""Detector step, over the noise, beyond which values between the steps are lost."""


class FailedCheck(NamedTuple):
    """A check that a curve fails."""

    code: str
    message: str

    @property
    def of_model(self) -> bool:
        """Whether it contradicts the model (so that no tension is shown) or only the noise."""
        return self.code not in _OF_NOISE


def is_beyond_chance(failing: int, curves: int) -> bool:
    """Return whether more of the curves fail a check of the model than do so by chance."""
    return failing > 0 and bool(bdtrc(failing - 1, curves, _FAILING) <= _RARE)


def doubt_of_tension(failed: Sequence[FailedCheck]) -> bool:
    """Return whether failed checks are such that a better fit is not evidence of a tension."""
    return any(check.of_model for check in failed)


class Noise(NamedTuple):
    """An estimate of the noise; of two, that with the larger deviation is the greater."""

    deviation: float
    """Standard deviation of the force [N]; from sums over bins, that if noise is independent."""
    freedom: float
    """Degrees of freedom."""

    def excess(self, other: Noise) -> float:
        """Return the ratio of the variance to that of ``other``."""
        return (self.deviation / other.deviation) ** 2

    def exceeds(self, other: Noise) -> bool:
        """Return whether an F-test rejects that both are of the same noise."""
        if self <= other:
            return False
        return bool(fdtrc(self.freedom, other.freedom, self.excess(other)) < CHANCE)


class NoiseEstimate(NamedTuple):
    """Noise of all or of some points, and the checks that they fail."""

    noise: Noise
    """Widened by the failed checks."""
    failed: tuple[FailedCheck, ...]
    slow: Noise | None = None
    """Noise before contact from sums over bins, where it exceeds that of independent points."""
    messages: tuple[str, ...] = ()
    """Further warnings."""


class Residuals(NamedTuple):
    """Residuals of a fit, in the order of the points."""

    likelihood: Likelihood
    parameters: Coordinates
    force: Array
    """Measured minus model [N]; of noise with a memory, its fractional differences."""
    measured: Array
    """Measured force [N], likewise."""
    jacobian: Array
    """Derivatives of the model by the coordinates that the fit varies."""
    before: Mask
    """Whether a point lies before contact on the first pass."""
    depth: Array
    """Position relative to the contact point [m]."""
    step: float
    """Step of the detector [N]; 0 if the force has none."""
    floor: float
    """Least noise [N] that can be resolved, by the accuracy of the model and the detector step."""

    @classmethod
    def of(cls, likelihood: Likelihood, parameters: Coordinates) -> Residuals:
        """Return the residuals at the best parameters."""
        scaled, jacobian = likelihood.linearised(parameters)
        # The fit does not vary a parameter at its minimum.
        varied = [p for p in likelihood.free if parameters[p] != p.minimum]
        depth = likelihood.depth(parameters)
        largest = float(np.max(np.abs(likelihood.force)))
        step = resolution(likelihood.force)
        return cls(
            likelihood,
            parameters,
            -scaled * likelihood.noise,
            differenced(likelihood.force, likelihood.memory)
            if likelihood.memory
            else likelihood.force,
            jacobian[:, likelihood.columns(varied)] * likelihood.noise,
            (depth < -_NEAR * float(np.ptp(likelihood.position))) & likelihood.first_pass,
            depth,
            step,
            max(likelihood.accuracy * largest, step / np.sqrt(12)),
        )

    @property
    def baseline(self) -> tuple[Parameter, ...]:
        """The fitted parameters of the baseline."""
        return tuple(p for p in (OFFSET, SLOPE) if p in self.likelihood.free)

    def independent_noise(self, points: Mask) -> Noise:
        """Return the noise of some points, from differences of neighbours.

        It has two thirds as many degrees of freedom as there are points (von Neumann et al. 1941).
        """
        force = self.force[points]
        return Noise(max(neighbour_noise(force), self.floor), 2 * force.size / 3)

    def binned(self, bins: Array) -> Noise | None:
        """Return the noise from sums over bins; a column of ``bins`` is 1 at its points, else 0."""
        return binned_noise(self.force, self.jacobian, bins)


def check_baseline(residuals: Residuals) -> NoiseEstimate:
    """Return the noise before contact about its trend, and the checks that fail there."""
    before = residuals.before
    force, travel = residuals.force[before], residuals.likelihood.travel[before]
    points = force.size
    independent = residuals.independent_noise(before)
    line = np.column_stack([np.ones(points), travel / np.ptp(residuals.likelihood.travel)])
    # The force as measured, since a fitted slope of the baseline absorbs part of a dip.
    # A model of adhesion has a dip of its own.
    adheres = WORK_OF_ADHESION in residuals.likelihood.force_model.parameters
    measured = force if adheres else residuals.measured[before]
    slope, change = _slope(measured, line)
    messages: tuple[str, ...] = ()
    if SLOPE in residuals.baseline and ndtr(slope / independent.deviation) < CHANCE:
        messages = (_falling_baseline(-change),)
    depth, window, drop = _deepest_dip(measured, line[:, :1], independent.deviation)
    if abs(slope) > abs(depth) * independent.deviation:
        # A line explains more than a dip, so the dip has to be significant beside the line.
        depth, window, drop = _deepest_dip(measured, line, independent.deviation)
    # A dip may begin before its window.
    far = max(points - 2 * window, points // 4) if depth < _DEEPEST else points
    slow = _slow_noise(force[:far], line[:far], independent)
    noise_of_sums = independent if slow is None else max(slow, independent)
    failed: list[FailedCheck] = []
    trend = line
    if depth * independent.deviation < _DEEPEST * noise_of_sums.deviation:
        trend = np.column_stack([line, _last(window, points)])
        failed.append(_adhesion(drop, window))
    else:
        far = points
    failed += _drift_or_offset(residuals, force[:far], line[:far], noise_of_sums.deviation)
    if slow is not None:
        failed.append(_correlated(far, max(far / slow.excess(independent), 1)))
    if residuals.step > _COARSE * neighbour_noise(force):
        failed.append(_coarse_steps(residuals.step))
    noise = _scatter(force, trend)
    noise = noise._replace(deviation=max(noise.deviation, residuals.floor))
    if failed:
        bins = np.zeros((residuals.force.size, _BINS))
        bins[before] = _equal_bins(points)
        sums = residuals.binned(bins)
        if sums is not None and sums.deviation > noise.deviation:
            noise = sums
    return NoiseEstimate(noise, tuple(failed), slow, messages)


def _falling_baseline(fall: float) -> str:
    """Return the warning of a baseline that falls by a force [N] towards contact."""
    return (
        f"the baseline falls by {readable(fall, 'N', 3)} towards contact: drift does that, "
        "but so does attraction of long range, which bends a curve as tension does; check "
        "whether it falls as steeply further out"
    )


def _adhesion(drop: float, window: int) -> FailedCheck:
    """Return the check of a force that dips by ``drop`` [N] over the last points."""
    message = (
        f"the force dips by {readable(drop, 'N', 3)} below its baseline over the last {window} "
        "points before contact: that is adhesion, which the model does not have, and which bends "
        "a curve as tension does; measure without attraction, or fit the tension with a model of "
        "adhesion"
    )
    return FailedCheck("adhesion", message)


def _correlated(points: int, independent: float) -> FailedCheck:
    """Return the check of points that carry the information of fewer independent ones."""
    message = (
        f"the noise before contact is correlated: {points} points carry as much information as "
        f"{decimal(independent, 2)} independent ones, and the intervals are widened accordingly"
    )
    return FailedCheck("slow_noise", message)


def _coarse_steps(step: float) -> FailedCheck:
    """Return the check of a force that is rounded to steps [N] larger than its noise."""
    message = (
        f"the force comes in steps of {readable(step, 'N', 3)}, larger than its noise, and "
        "values between them are not known; measure with a finer range of the detector"
    )
    return FailedCheck("steps", message)


def _deepest_dip(force: Array, baseline: Array, noise: float) -> tuple[float, int, float]:
    """Return the depth of the deepest dip next to contact, its number of points, and its drop [N].

    The depth is in standard errors, and negative.  The columns of ``baseline`` are fitted together
    with the dip.
    """
    deepest, width, drop = 0.0, 0, 0.0
    basis, _ = np.linalg.qr(baseline)
    for share in _WINDOWS:
        window = int(share * force.size)
        if window < _FEWEST:
            break
        step = _last(window, force.size)
        step -= basis @ (basis.T @ step)
        norm = float(np.linalg.norm(step))
        depth = float(step @ force) / (noise * norm)
        if depth < deepest:
            deepest, width, drop = depth, window, -depth * noise / norm
    return deepest, width, drop


def _slow_noise(force: Array, line: Array, independent: Noise) -> Noise | None:
    """Return the noise about a line if it exceeds that from differences of neighbours, else None.

    Sums over bins reveal slow noise best; the scatter of the points reveals smoothed data.
    """
    estimates = (_scatter(force, line), binned_noise(force, line, _equal_bins(force.size)))
    return max((noise for noise in estimates if noise and noise.exceeds(independent)), default=None)


def _scatter(force: Array, trend: Array) -> Noise:
    """Return the noise about a trend, whose terms are the columns of ``trend``."""
    remainder = force - trend @ np.linalg.lstsq(trend, force, rcond=None)[0]
    freedom = force.size - trend.shape[1]
    return Noise(float(np.sqrt(np.sum(remainder**2) / freedom)), freedom)


def _slope(force: Array, line: Array) -> tuple[float, float]:
    """Return the slope of the force in units whose standard error is the noise of one point.

    The second value is the change of the force [N] that this slope makes over the points.
    """
    basis, triangle = np.linalg.qr(line)
    slope = float(basis[:, 1] @ force)
    return slope, slope * (1 / float(triangle[1, 1])) * float(np.ptp(line[:, 1]))


def _last(window: int, points: int) -> Array:
    """Return 1 at the last ``window`` of the points, 0 elsewhere."""
    return np.where(np.arange(points) >= points - window, 1.0, 0.0)


def _equal_bins(points: int) -> Array:
    """Return a column for each bin of neighbouring points, all bins of about the same size."""
    index = np.arange(points) * _BINS // max(points, 1)
    return np.where(index[:, None] == np.arange(_BINS), 1.0, 0.0)


def _drift_or_offset(
    residuals: Residuals, force: Array, line: Array, noise: float
) -> list[FailedCheck]:
    """Return a failed check if the force before contact is neither fitted nor constant and 0."""
    slope, change = _slope(force, line)
    if SLOPE not in residuals.baseline and 2 * ndtr(-abs(slope) / noise) < CHANCE:
        message = (
            f"the force drifts by {readable(change, 'N', 3)} before contact, and modulus and "
            "tension are biased by its drift in contact; fit the baseline too, with baseline "
            "'slope'"
        )
        return [FailedCheck("drift", message)]
    mean = float(np.mean(force))
    least = 10 * residuals.likelihood.accuracy * float(np.max(np.abs(residuals.likelihood.force)))
    if residuals.baseline or abs(mean) <= max(_OFFSET_LIMIT * noise / np.sqrt(force.size), least):
        return []
    message = (
        f"the force before contact is {readable(mean, 'N', 3)}, not 0, and modulus and tension "
        "are biased by it; fit the baseline too, with baseline 'offset'"
    )
    return [FailedCheck("offset", message)]


def neighbour_noise(values: Array) -> float:
    """Return the standard deviation of noise from differences of neighbours, without drift."""
    return float(np.sqrt(np.mean(np.diff(values) ** 2) / 2))


def resolution(values: Array) -> float:
    """Return the detector step if all values are a whole number of steps apart, else 0."""
    steps = np.diff(np.unique(values))
    steps = steps[steps > _EQUAL * float(np.ptp(values))]
    if not 0 < steps.size < _TIES * values.size:
        return 0.0
    step = float(steps.min())
    # Equal values alone do not mean steps: a curve without noise is 0 before contact.
    counts = steps / step
    return step if np.all(np.abs(counts - np.round(counts)) < _OFF_STEP) else 0.0


def binned_noise(residuals: Array, jacobian: Array, bins: Array) -> Noise | None:
    """Return the noise from sums of residuals over bins; None if no bin is left.

    ``bins`` has a column for each bin, 1 at its points and 0 elsewhere.  Residuals of a fit are
    orthogonal to the columns of its ``jacobian``, so these are projected out of the bins too; the
    sums are then orthogonalised.
    """
    # A column that is zero stays zero.
    tiny = float(np.finfo(float).eps) * float(np.linalg.norm(jacobian))
    span, _ = np.linalg.qr(jacobian / np.maximum(np.linalg.norm(jacobian, axis=0), tiny))
    remainder = bins - span @ (span.T @ bins)
    basis, sizes, _ = np.linalg.svd(remainder, full_matrices=False)
    basis = basis[:, sizes > _RANK * np.sqrt(residuals.size)]
    sums = basis.T @ (residuals - span @ (span.T @ residuals))
    if not sums.size:
        return None
    return Noise(float(np.sqrt(np.mean(sums**2))), sums.size)
