"""Checks of the points before contact: adhesion, drift, offset, slow noise, detector steps."""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr, ndtri

from pellicle.arrays import Array
from pellicle.fitting.parameters import SLOPE

from .noise import (
    CHANCE,
    FailedCheck,
    Noise,
    NoiseEstimate,
    Residuals,
    binned_noise,
    neighbour_noise,
)

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


def check_baseline(residuals: Residuals) -> NoiseEstimate:
    """Return the noise before contact about its trend, and the checks that fail there."""
    before = residuals.before
    force, travel = residuals.force[before], residuals.likelihood.travel[before]
    points = force.size
    independent = residuals.independent_noise(before)
    line = np.column_stack([np.ones(points), travel / travel[-1]])
    # The force as measured, since a fitted slope of the baseline absorbs part of a dip.
    measured = residuals.likelihood.force[before]
    slope, change = _slope(measured, line)
    messages: tuple[str, ...] = ()
    if SLOPE in residuals.baseline and ndtr(slope / independent.deviation) < CHANCE:
        messages = (
            f"the baseline falls by {-change:.3g} N towards contact: drift does that, but so does "
            "attraction of long range, which bends a curve as tension does; check whether it falls "
            "as steeply further out",
        )
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
        message = (
            f"the force dips by {drop:.3g} N below its baseline over the last {window} points "
            "before contact: that is adhesion, which the model does not have, and which bends a "
            "curve as tension does; measure without attraction, or fit the tension with a "
            "model of adhesion"
        )
        failed.append(FailedCheck("adhesion", message))
    else:
        far = points
    failed += _drift_or_offset(residuals, force[:far], line[:far], noise_of_sums.deviation)
    if slow is not None:
        message = (
            f"the noise before contact is correlated: {far} points carry as much information as "
            f"{max(far / slow.excess(independent), 1):.2g} independent ones, and the intervals are "
            "widened accordingly"
        )
        failed.append(FailedCheck("slow_noise", message))
    if residuals.step > _COARSE * neighbour_noise(force):
        message = (
            f"the force comes in steps of {residuals.step:.3g} N, larger than its noise, and "
            "values between them are not known; measure with a finer range of the detector"
        )
        failed.append(FailedCheck("steps", message))
    noise = _scatter(force, trend)
    noise = noise._replace(deviation=max(noise.deviation, residuals.floor))
    if failed:
        bins = np.zeros((residuals.force.size, _BINS))
        bins[before] = _equal_bins(points)
        sums = residuals.binned(bins)
        if sums is not None and sums.deviation > noise.deviation:
            noise = sums
    return NoiseEstimate(noise, tuple(failed), slow, messages)


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
            f"the force drifts by {change:.3g} N before contact, and modulus and tension are "
            "biased by its drift in contact; fit the baseline too, with baseline 'slope'"
        )
        return [FailedCheck("drift", message)]
    mean = float(np.mean(force))
    least = 10 * residuals.likelihood.accuracy * float(np.max(np.abs(residuals.likelihood.force)))
    if residuals.baseline or abs(mean) <= max(_OFFSET_LIMIT * noise / np.sqrt(force.size), least):
        return []
    message = (
        f"the force before contact is {mean:.3g} N, not 0, and modulus and tension are biased by "
        "it; fit the baseline too, with baseline 'offset'"
    )
    return [FailedCheck("offset", message)]
