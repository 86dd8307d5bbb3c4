"""The images of an indenter on a periodic grid."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import cos, sin
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import read_only
from pellicle.errors import ConfigError
from pellicle.grid import Grid
from pellicle.units import readable

# Distance from a cell centre, over the spacing, below which a point is that centre: shifts by whole
# cells then move a profile to the last bit.
_ROUNDING = 1e-9


class Lattice(NamedTuple):
    """The repetition of a periodic grid, in coordinates turned against those of the grid."""

    grid: Grid
    angle: float = 0.0
    """Angle of the grid's x axis from that of the coordinates [rad]."""

    def envelope(self, profile: Callable[[Array, Array], Array], x: Array, y: Array) -> Array:
        """Return the highest of the profiles [m] of a body and its images at given points [m].

        The images are the nearest and the eight around it, so the result does not depend on the
        period from which the points are taken.
        """
        points = [
            self._nearest(position, axis) for axis, position in enumerate(self._turned(x, y, 1))
        ]
        highest = None
        for steps in product((0, -1, 1), repeat=2):
            image = [p + n * edge for p, n, edge in zip(points, steps, self.grid.size, strict=True)]
            heights = profile(*map(read_only, self._turned(image[0], image[1], -1)))
            highest = heights if highest is None else np.maximum(highest, heights)
        assert highest is not None
        return highest

    def roll(self, profile: Callable[[Array, Array], Array], x: Array, y: Array) -> Array:
        """Return the profile [m] of a body known at the cells of a period only, moved by cells."""
        centred, cells = self.grid.coordinates(), []
        for number, (edge, points) in enumerate(zip(self.grid.spacing, (x, y), strict=True)):
            shift = -float(points.mean()) / edge if self.grid.points[number] > 1 else 0.0
            if abs(shift - round(shift)) > _ROUNDING * max(1.0, abs(shift)):
                raise ConfigError(
                    f"its heights are known at the cells only, and {readable(shift * edge, 'm')} "
                    f"along {'xy'[number]} is no whole number of cells of {readable(edge, 'm')}; "
                    "move it by whole cells, or the other parts of a sum instead"
                )
            cells.append(round(shift))
        return np.roll(profile(*map(read_only, centred)), cells, axis=(0, 1))

    def _turned(self, x: Array, y: Array, sign: int) -> tuple[Array, Array]:
        """Return points in the axes of the grid, or with ``sign`` −1 points of those axes back."""
        if not self.angle:
            return x, y
        c, s = cos(self.angle), sign * sin(self.angle)
        return c * x + s * y, c * y - s * x

    def _nearest(self, points: Array, axis: int) -> Array:
        """Return coordinates [m] less whole periods, within half a period of the origin."""
        period, number = self.grid.size[axis], self.grid.points[axis]
        points = points - period * np.round(points / period)
        cell = points / self.grid.spacing[axis] + (number - 1) / 2
        near = np.round(cell)
        centre = (near - (number - 1) / 2) * self.grid.spacing[axis]
        return np.where(np.abs(cell - near) < _ROUNDING, centre, points)
