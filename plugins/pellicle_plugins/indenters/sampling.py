"""The extent of the domain, inferred from the points at which a profile is evaluated."""

from __future__ import annotations

from typing import NamedTuple

from pellicle.arrays import Array
from pellicle.errors import ConfigError


class UniformAxis(NamedTuple):
    """Equally spaced points that sample one period [m]."""

    first: float
    number: int
    period: float

    @classmethod
    def of(cls, points: Array) -> UniformAxis:
        """Return the axis on which ``points`` [m] lie; one point has no spacing."""
        if points.size < 2:
            raise ConfigError("needs a grid of at least 2 points each way", "type")
        spacing = (points[-1] - points[0]) / (points.size - 1)
        return cls(float(points[0]), points.size, float(spacing * points.size))

    @property
    def spacing(self) -> float:
        """Distance between neighbouring points [m]."""
        return self.period / self.number
