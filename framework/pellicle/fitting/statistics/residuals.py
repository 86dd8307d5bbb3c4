"""What a fit leaves of a curve, and the record of a check that it fails."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc

from pellicle.arrays import Array, Mask

from .likelihood import OFFSET, POINT, SLOPE, TENSION, Likelihood
from .noise import BinnedNoise, binned_noise, neighbour_noise, resolution

CHANCE = 3e-3
"""Share of curves without fault that a check flags."""
_NEAR = 0.01
"""Rows count as before contact if they lie further from it than this share of the range."""
_OF_NOISE = ("slow_noise", "spikes", "steps")


class FailedCheck(NamedTuple):
    """A check that a curve fails."""

    code: str
    message: str

    @property
    def of_model(self) -> bool:
        """Whether the model is wrong, so that no tension can be claimed; else only the noise."""
        return self.code not in _OF_NOISE

    def to_dict(self) -> dict[str, str]:
        """Return what JSON can hold."""
        return self._asdict()


class NoiseEstimate(NamedTuple):
    """Noise of all or of some rows, and the checks that fail there."""

    noise: float
    """Standard deviation of the force [N], widened by the checks that fail."""
    freedom: float
    """Degrees of freedom."""
    failed: tuple[FailedCheck, ...]
    slow: BinnedNoise | None = None
    """Noise of sums over bins before contact, where it exceeds that of independent points."""


class Residuals(NamedTuple):
    """What a fit leaves of a curve, in the order of its rows."""

    likelihood: Likelihood
    parameters: Array
    force: Array
    """Measured less model [N]."""
    jacobian: Array
    """Derivatives of the model in the parameters that the fit moves."""
    before: Mask
    """Whether a row lies before contact."""
    depth: Array
    """Position seen from contact [m]."""
    step: float
    """Least step of the force [N], if the detector has steps."""
    floor: float
    """Least noise [N] that can be told: accuracy of the model, rounding to steps."""

    @classmethod
    def of(cls, likelihood: Likelihood, parameters: Array) -> Residuals:
        """Return the residuals at the best parameters."""
        scaled, slopes = likelihood.expanded(parameters)
        # At its limit the fit does not move the tension.
        free = [k for k in likelihood.free if k != TENSION or parameters[TENSION]]
        depth = likelihood.position - parameters[POINT]
        largest = float(np.max(np.abs(likelihood.force)))
        step = resolution(likelihood.force)
        return cls(
            likelihood,
            parameters,
            -scaled * likelihood.noise,
            slopes[:, free] * likelihood.noise,
            depth < -_NEAR * float(np.ptp(likelihood.position)),
            depth,
            step,
            max(likelihood.accuracy * largest, step / np.sqrt(12)),
        )

    def is_free(self, which: int) -> bool:
        """Return whether a parameter is fitted."""
        return which in self.likelihood.free

    @property
    def baseline(self) -> int:
        """How many parameters of the baseline are fitted."""
        return sum(map(self.is_free, (OFFSET, SLOPE)))

    def independent_noise(self, rows: Mask) -> float:
        """Return the noise [N] of some rows as their neighbours show it, if independent."""
        return max(neighbour_noise(self.force[rows]), self.floor)

    def binned(self, bins: Array) -> BinnedNoise | None:
        """Return the noise that sums over bins show; a column of ``bins`` is 1 in its rows."""
        return binned_noise(self.force, self.jacobian, bins)


def exceeds(sums: BinnedNoise, noise: float, freedom: float) -> bool:
    """Return whether sums over bins vary more than noise [N] that is known that well."""
    return bool(fdtrc(sums.freedom, freedom, sums.excess(noise)) < CHANCE)


def independent_freedom(rows: int) -> float:
    """Return the degrees of freedom of the noise that differences of neighbours show."""
    return 2 * rows / 3
