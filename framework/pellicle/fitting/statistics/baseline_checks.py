"""Checks of the rows before contact: adhesion, drift, offset, slow noise, steps."""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr, ndtri

from pellicle.arrays import Array

from .likelihood import SLOPE
from .noise import BinnedNoise, binned_noise, neighbour_noise
from .residuals import CHANCE, FailedCheck, NoiseEstimate, Residuals, exceeds, independent_freedom

_OFF = 4.0
"""Standard errors that the force before contact may be from 0."""
_WINDOWS = (1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32)
"""Shares of the rows before contact in which a dip is sought, next to contact."""
_FEWEST = 3
"""Rows of the narrowest such window."""
_DEEPEST = float(ndtri(CHANCE / len(_WINDOWS)))
"""Standard errors by which the deepest of these windows lies off the baseline by chance."""
_BINS = 8
_COARSE = 2.0
"""Steps of the detector larger than this, over the noise, hide what lies between them."""


def check_baseline(residuals: Residuals) -> NoiseEstimate:
    """Return the noise before contact, about its trend, and what there is besides noise."""
    before = residuals.before
    force, travel = residuals.force[before], residuals.likelihood.travel[before]
    rows = force.size
    independent = residuals.independent_noise(before)
    line = np.column_stack([np.ones(rows), travel / travel[-1]])
    # As measured: a slope of the baseline that is fitted takes up a part of a dip.
    measured = residuals.likelihood.force[before]
    depth, window, drop = _deepest_dip(measured, line[:, :1], independent)
    if abs(_slope(measured, line)[0]) > abs(depth) * independent:
        # A line explains more than a dip, which must then show beside the line.
        depth, window, drop = _deepest_dip(measured, line, independent)
    # A dip may begin before its window.
    far = max(rows - 2 * window, rows // 4) if depth < _DEEPEST else rows
    slow = _slow(force[:far], line[:far], independent)
    noise_of_sums = independent if slow is None else max(slow.noise, independent)
    failed: list[FailedCheck] = []
    trend = line
    if depth * independent < _DEEPEST * noise_of_sums:
        trend = np.column_stack([line, _last(window, rows)])
        failed.append(_adhesion(drop, window))
    else:
        far = rows
    failed += _drift_or_offset(residuals, force[:far], line[:far], noise_of_sums)
    if slow is not None:
        failed.append(_slow_noise(slow, independent, far))
    if residuals.step > _COARSE * neighbour_noise(force):
        failed.append(_steps(residuals.step))
    left = force - trend @ np.linalg.lstsq(trend, force, rcond=None)[0]
    freedom = rows - trend.shape[1]
    noise = max(float(np.sqrt(np.sum(left**2) / freedom)), residuals.floor)
    if failed:
        bins = np.zeros((residuals.force.size, _BINS))
        bins[before] = _equal_bins(rows)
        sums = residuals.binned(bins)
        if sums is not None and sums.noise > noise:
            return NoiseEstimate(sums.noise, sums.freedom, tuple(failed), slow)
    return NoiseEstimate(noise, freedom, tuple(failed), slow)


def falling_baseline(residuals: Residuals) -> tuple[str, ...]:
    """Return a caution if a fitted baseline falls towards contact, as attraction would have it."""
    if not residuals.is_free(SLOPE):
        return ()
    before = residuals.before
    force, travel = residuals.likelihood.force[before], residuals.likelihood.travel[before]
    line = np.column_stack([np.ones(force.size), travel / travel[-1]])
    slope, steepness = _slope(force, line)
    if ndtr(slope / residuals.independent_noise(before)) >= CHANCE:
        return ()
    change = slope * steepness * float(np.ptp(line[:, 1]))
    return (
        f"the baseline falls by {-change:.3g} N towards contact, which drift does, and attraction "
        "of long range too, which bends a curve as tension does: see whether it falls as much "
        "further out",
    )


def _deepest_dip(force: Array, baseline: Array, noise: float) -> tuple[float, int, float]:
    """Return the depth of the deepest dip next to contact in standard errors, its rows, and [N].

    The depth is negative.  What the columns of ``baseline`` span is fitted beside the dip.
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


def _slow(force: Array, line: Array, independent: float) -> BinnedNoise | None:
    """Return the noise about a line, if it is more than what neighbours show, else None.

    Sums over bins show slow noise best; the scatter itself shows data that were smoothed.
    """
    rows = force.size
    left = force - line @ np.linalg.lstsq(line, force, rcond=None)[0]
    scatter = BinnedNoise(float(np.sqrt(np.sum(left**2) / (rows - 2))), rows - 2)
    shown = [scatter, binned_noise(force, line, _equal_bins(rows))]
    slow = [
        noise
        for noise in shown
        if noise is not None and exceeds(noise, independent, independent_freedom(rows))
    ]
    return max(slow, default=None, key=lambda noise: noise.noise)


def _slope(force: Array, line: Array) -> tuple[float, float]:
    """Return the slope of the force in units of the noise of one row, and the slope of 1 of it."""
    basis, triangle = np.linalg.qr(line)
    return float(basis[:, 1] @ force), 1 / float(triangle[1, 1])


def _last(window: int, rows: int) -> Array:
    """Return 1 in the last rows, 0 elsewhere."""
    return np.where(np.arange(rows) >= rows - window, 1.0, 0.0)


def _equal_bins(rows: int) -> Array:
    """Return a column for each bin of neighbouring rows, all of about the same size."""
    number = np.arange(rows) * _BINS // max(rows, 1)
    return np.where(number[:, None] == np.arange(_BINS), 1.0, 0.0)


def _adhesion(drop: float, window: int) -> FailedCheck:
    return FailedCheck(
        "adhesion",
        f"the force dips by {drop:.3g} N below its baseline over the last {window} points before "
        "contact: that is adhesion, which the model does not have, and which bends a curve as "
        "tension does; measure where nothing attracts, or fit the tension with a model of adhesion",
    )


def _drift_or_offset(
    residuals: Residuals, force: Array, line: Array, noise: float
) -> list[FailedCheck]:
    """Return whether the force before contact drifts, or is not 0, and is fitted without that."""
    slope, steepness = _slope(force, line)
    if not residuals.is_free(SLOPE) and 2 * ndtr(-abs(slope) / noise) < CHANCE:
        change = slope * steepness * float(np.ptp(line[:, 1]))
        return [
            FailedCheck(
                "drift",
                f"the force drifts by {change:.3g} N before contact, and modulus and tension are "
                "off by what it drifts in contact; fit the baseline too, with baseline 'slope'",
            )
        ]
    mean = float(np.mean(force))
    least = 10 * residuals.likelihood.accuracy * float(np.max(np.abs(residuals.likelihood.force)))
    if residuals.baseline or abs(mean) <= max(_OFF * noise / np.sqrt(force.size), least):
        return []
    return [
        FailedCheck(
            "offset",
            f"the force before contact is {mean:.3g} N, not 0, and modulus and tension are off by "
            "it; fit the baseline too, with baseline 'offset'",
        )
    ]


def _slow_noise(slow: BinnedNoise, independent: float, rows: int) -> FailedCheck:
    excess = slow.excess(independent)
    return FailedCheck(
        "slow_noise",
        f"the noise before contact is correlated: {rows} points tell no more than "
        f"{max(rows / excess, 1):.2g} independent ones, and the intervals are widened by that",
    )


def _steps(step: float) -> FailedCheck:
    return FailedCheck(
        "steps",
        f"the force comes in steps of {step:.3g} N, larger than its noise, and what lies between "
        "them is not known; measure with a finer range of the detector",
    )
