"""Noise of a curve, estimated from neighbouring points, detector steps, and sums over bins."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc

from pellicle.arrays import Array, Mask
from pellicle.fitting.parameters import OFFSET, SLOPE, Coordinates, Parameter

from .likelihood import Likelihood

CHANCE = 3e-3
"""Probability that a check flags a curve without fault."""
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


class FailedCheck(NamedTuple):
    """A check that a curve fails."""

    code: str
    message: str

    @property
    def of_model(self) -> bool:
        """Whether it contradicts the model (so that no tension is shown) or only the noise."""
        return self.code not in _OF_NOISE


class Noise(NamedTuple):
    """An estimate of the noise; of two, that with the larger deviation is the greater."""

    deviation: float
    """Standard deviation of the force [N]; from sums over bins, that if noise is independent."""
    freedom: float
    """Degrees of freedom."""

    def excess(self, other: Noise) -> float:
        """Return the variance over that of ``other``."""
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
    """Measured minus model [N]."""
    jacobian: Array
    """Derivatives of the model by the coordinates that the fit varies."""
    before: Mask
    """Whether a point lies before contact."""
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
            jacobian[:, likelihood.columns(varied)] * likelihood.noise,
            depth < -_NEAR * float(np.ptp(likelihood.position)),
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
