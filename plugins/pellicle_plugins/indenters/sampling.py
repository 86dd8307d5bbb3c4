"""The extent of the domain, as an indenter can tell it from the points that it is asked for."""

from __future__ import annotations

from typing import NamedTuple

from pellicle.arrays import Array
from pellicle.errors import ConfigError


class Axis(NamedTuple):
    """Equally spaced points that sample one period."""

    first: float
    number: int
    period: float

    @classmethod
    def of(cls, points: Array) -> Axis:
        """Return the axis on which ``points`` [m] lie.

        Raises
        ------
        ConfigError
            One point does not tell how far it is to the next.
        """
        if points.size < 2:
            raise ConfigError("needs a grid of at least 2 points each way", "type")
        spacing = (points[-1] - points[0]) / (points.size - 1)
        return cls(float(points[0]), points.size, float(spacing * points.size))

    @property
    def spacing(self) -> float:
        """Distance from one point to the next [m]."""
        return self.period / self.number

    def shifted(self, cells: float) -> Axis:
        """Return the axis with all points moved by a number of cells."""
        return self._replace(first=self.first + cells * self.spacing)
