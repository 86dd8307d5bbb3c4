"""The noise of a curve from before the contact, and checks of what a fit leaves over."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc, ndtri

from pellicle.arrays import Array
from pellicle_fit.contact.curve import Curve

from .long_memory import exponent_of, fractional_differences

CHANCE = 1e-3
"""Probability that a check flags a curve without fault."""
_NEAR = 0.01
"""Distance from contact beyond which a row counts as before it, over the range of positions."""
FEWEST = 10
"""Rows before contact from which the noise is taken."""
_WINDOWS = (1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32)
"""Rows next to contact in which a dip is sought, over those before it."""
_BINS = 8
_DEPTHS = (1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4)
"""Edges of bins in contact, over the depth; narrow near first touch, where most models fail."""
_WILD = 7.0
"""Standard deviations from the mean of its neighbours beyond which a row is a spike."""
_NORMAL = 1.4826
"""Standard deviation of normal numbers over their median absolute deviation."""
_SHIFTED = 5.0
"""Mean of what is no offset, over its scatter."""
_COARSE = 2.0
"""Step of the detector, over the noise, beyond which what lies between two steps is lost."""
_LEAST = 1e-6
"""Least noise over the largest force, the accuracy of the force curves."""


class Flaw(Enum):
    """What contradicts an explanation, the plainest first, or, the last three, only the noise."""

    TOO_DEEP = "the curve goes deeper than the force of this contact is known"
    OFFSET = "the force before contact is not 0"
    DRIFT = "the force before contact has a slope"
    DIP = "the force dips before contact: something attracts, or the baseline bends"
    MISFIT = (
        "in contact the misfit exceeds the noise of the baseline or, without one, of neighbours"
    )
    PATTERN = "in contact the misfit follows a pattern"
    SPIKES = "single points lie far from their neighbours and shift the fit"
    SLOW = "the noise before contact is correlated; intervals take it so"
    STEPS = "the steps of the detector are coarser than the noise"


class Noise(NamedTuple):
    """An estimate of the noise; of two, that with the larger deviation is the greater."""

    deviation: float
    """Standard deviation of the force [N]; from sums over bins, that if noise is independent."""
    freedom: float

    def exceeds(self, other: Noise) -> bool:
        """Return whether an F-test rejects that both are of the same noise."""
        ratio = (self.deviation / max(other.deviation, 1e-300)) ** 2
        return ratio > 1 and bool(fdtrc(self.freedom, other.freedom, ratio) < CHANCE)


class ResidualCheck(NamedTuple):
    """The noise of a curve, widened where an explanation fails, and the flaws."""

    noise: Noise
    """As it is weighed: what is correlated or follows a pattern counts as more of it."""
    flaws: frozenset[Flaw]
    deviation: float
    """Standard deviation of what is left [N], before contact or, if it exceeds that, in it."""
    memory: float = 0.0
    """Exponent d of correlated noise that was taken as white; 0 if it is not of that kind."""

    @property
    def widening(self) -> float:
        """The noise that is weighed over the deviation of what is left."""
        return self.noise.deviation / self.deviation

    @property
    def describes(self) -> bool:
        """Whether no flaw contradicts the explanation."""
        return self.flaws <= {Flaw.SLOW, Flaw.SPIKES, Flaw.STEPS}

    @property
    def failed_checks(self) -> dict[str, str]:
        """Code of each flaw, and what it is in words."""
        return {flaw.name.lower(): flaw.value for flaw in Flaw if flaw in self.flaws}


def check_residuals(
    curve: Curve, residuals: Array, jacobian: Array, depth: Array, memory: float = 0.0
) -> ResidualCheck:
    """Return the noise that an explanation of least χ² leaves in a curve.

    Of noise with a memory d, that of its fractional differences.  Residuals are the recorded force
    less that of the explanation [N], and ``jacobian`` the derivatives of the latter, of shape
    (n, coordinates); depths are those of the base [m].
    """
    flaws, step = {Flaw.SLOW} if memory else set(), _step(curve.force)
    if memory:
        residuals, jacobian = (
            fractional_differences(residuals, memory),
            fractional_differences(jacobian, memory),
        )
    before = (depth < -_NEAR * curve.span) & curve.first_pass
    least = max(_LEAST * curve.largest, step / np.sqrt(12))
    if has_spikes(residuals, least):
        flaws.add(Flaw.SPIKES)
    if before.sum() < FEWEST:
        left = max(residuals.size - jacobian.shape[1], 1)
        noise = Noise(max(float(np.sqrt(np.sum(residuals**2) / left)), least), left)
        # Without a baseline neighbours tell the noise.
        if noise.exceeds(neighbour_noise(residuals, least)):
            flaws.add(Flaw.MISFIT)
        return ResidualCheck(noise, frozenset(flaws), noise.deviation)
    # Towards contact, on a retraction too.
    rows = np.flatnonzero(before)[:: -1 if curve.moves_out[before][0] else 1]
    free_flaws, white, noise = _before_contact(residuals[rows], curve.base[rows], least)
    far = noise if Flaw.SLOW in free_flaws else neighbour_noise(residuals[rows], least)
    deviation = white.deviation
    flaws |= free_flaws
    if step > _COARSE * neighbour_noise(residuals[rows]).deviation:
        flaws.add(Flaw.STEPS)
    inside, free = ~before, max(int(np.sum(~before)) - jacobian.shape[1], 1)
    scatter = Noise(float(np.sqrt(np.sum(residuals[inside] ** 2) / free)), free)
    usual = noise
    if scatter.exceeds(noise):
        flaws.add(Flaw.MISFIT)
        noise = Noise(scatter.deviation, min(noise.freedom, free))
        deviation = scatter.deviation
    bins = np.digitize(depth / max(float(depth.max()), 1e-300), _DEPTHS)
    # A second pass has bins of its own.
    bins += (len(_DEPTHS) + 1) * (curve.moves_out & curve.first_pass[0])
    sums = noise_of_bins(residuals, jacobian, np.where(before, -1, bins), 2 * (len(_DEPTHS) + 1))
    if sums and sums.exceeds(max(neighbour_noise(residuals[inside], least), far)):
        flaws.add(Flaw.PATTERN)
        noise = max(noise, Noise(sums.deviation, sums.freedom))
    elif sums and Flaw.SLOW in flaws:
        noise = max(noise, usual, sums)
    slow = Flaw.SLOW in flaws and Flaw.DIP not in flaws and not memory
    # An offset has all of a memory and is no noise.
    stays = abs(np.mean(residuals[before])) < _SHIFTED * np.std(residuals[before])
    exponent = exponent_of(residuals[before]) if slow and stays else 0.0
    return ResidualCheck(noise, frozenset(flaws), deviation, exponent)


def _before_contact(force: Array, base: Array, least: float) -> tuple[set[Flaw], Noise, Noise]:
    """Return flaws before contact, the noise of rows, and as it is weighed: of sums if it is slow.

    An explanation describes the rows before contact too: what is left is to have no mean, no slope
    and no dip.
    """
    line = _line(base)
    unit = line / np.linalg.norm(line, axis=0)
    independent, flaws = neighbour_noise(force, least), set()
    limit = float(ndtri(CHANCE / len(_WINDOWS)))
    # A line may explain more than a dip, which then has to be significant beside it.
    depth, window = max(_dip(force, unit[:, :1]), _dip(force, unit))
    dips = depth < limit * independent.deviation
    # A dip may begin before its window.
    far = slice(0, max(force.size - 2 * window, force.size // 4) if dips else force.size)
    rest = (force - line @ np.linalg.lstsq(line[far], force[far], rcond=None)[0])[far]
    freedom = max(rest.size - 2, 1)
    noise = white = Noise(max(float(np.sqrt(np.sum(rest**2) / freedom)), least), freedom)
    sums = _noise_about(rest, line[far])
    if sums and sums.exceeds(independent):
        flaws.add(Flaw.SLOW)
        noise = max(noise, sums)
    unit = line[far] / np.linalg.norm(line[far], axis=0)
    limit_of_line = -float(ndtri(CHANCE / 2)) * noise.deviation
    if dips and depth < limit * noise.deviation:
        flaws.add(Flaw.DIP)
    elif abs(unit[:, 1] @ force[far]) > limit_of_line:
        flaws.add(Flaw.DRIFT)
    elif abs(unit[:, 0] @ force[far]) > limit_of_line:
        flaws.add(Flaw.OFFSET)
    return flaws, white, noise


def is_straight(curve: Curve) -> bool:
    """Return whether a line leaves nothing but noise of the first pass, as of a mere baseline."""
    force, base = (of[curve.first_pass] for of in (curve.force, curve.base))
    line = _line(base)
    rest = force - line @ np.linalg.lstsq(line, force, rcond=None)[0]
    sums = _noise_about(rest, line)
    return not (sums and sums.exceeds(neighbour_noise(rest)))


def _line(base: Array) -> Array:
    """Return the columns of a constant and of a slope along the base, of shape (n, 2)."""
    return np.column_stack([np.ones(base.size), (base - base.mean()) / np.ptp(base)])


def _noise_about(rest: Array, line: Array) -> Noise | None:
    """Return the noise from sums over bins of rows in their order, less a line."""
    return noise_of_bins(rest, line, np.arange(rest.size) * _BINS // rest.size, _BINS)


def _dip(force: Array, trend: Array) -> tuple[float, int]:
    """Return the deepest mean of a window next to contact about a trend [N], and its rows.

    The mean is weighted, so that its noise is that of one row.
    """
    dips = []
    for share in _WINDOWS:
        window = np.where(np.arange(force.size) >= force.size * (1 - share), 1.0, 0.0)
        rows = int(window.sum())
        window -= trend @ (trend.T @ window)
        size = max(float(np.linalg.norm(window)), 1e-300)
        dips.append((float(window @ force) / size, rows))
    return min(dips)


def noise_of_bins(
    residuals: Array, jacobian: Array, bin_of: NDArray[np.intp], count: int
) -> Noise | None:
    """Return the noise from sums over bins; None if no bin is left.

    A fit has made residuals orthogonal to the columns of its Jacobian, so these are projected out
    of the bins, a column each with 1 in its rows; the sums are then orthogonalised.
    """
    bins = np.where(bin_of[:, None] == np.arange(count), 1.0, 0.0)
    norms = np.linalg.norm(jacobian, axis=0)
    span, _ = np.linalg.qr(jacobian[:, norms > 0] / norms[norms > 0])
    basis, sizes, _ = np.linalg.svd(bins - span @ (span.T @ bins), full_matrices=False)
    sums = basis[:, sizes > 1e-6 * np.sqrt(residuals.size)].T @ residuals
    return Noise(float(np.sqrt(np.mean(sums**2))), sums.size) if sums.size else None


def has_spikes(residuals: Array, least: float) -> bool:
    """Return whether rows lie further from the mean of their neighbours than any noise does."""
    off = residuals[1:-1] - (residuals[2:] + residuals[:-2]) / 2
    spread = _NORMAL * float(np.median(np.abs(off - np.median(off))))
    return bool(np.any(np.abs(off) > _WILD * max(spread, least)))


def neighbour_noise(force: Array, least: float = 0.0) -> Noise:
    """Return the noise from differences of neighbours, not below a least deviation [N].

    It has two thirds as many degrees of freedom as there are rows (von Neumann et al. 1941).
    """
    deviation = float(np.sqrt(np.mean(np.diff(force) ** 2) / 2))
    return Noise(max(deviation, least), 2 * force.size / 3)


def _step(force: Array) -> float:
    """Return the step of the detector [N] if all forces are whole numbers of it, else 0."""
    steps = np.diff(np.unique(force))
    steps = steps[steps > 1e-9 * np.ptp(force)]
    if not 0 < steps.size < 0.9 * force.size:
        return 0.0
    counts = steps / steps.min()
    return float(steps.min()) if np.all(np.abs(counts - np.round(counts)) < 0.05) else 0.0
