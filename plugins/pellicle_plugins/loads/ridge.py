"""A straight contact line, or a stripe of liquid between two."""

from __future__ import annotations

from math import inf
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import boundary_of_run
from pellicle.errors import ConfigError
from pellicle.units import Length

from .round import Line, LineForce
from .shares import between, edges


class Ridge(Line):
    """Straight line force along y through the centre of a period, or a stripe of liquid.

    A stripe has two such lines, and an even pressure between them that balances both.
    """

    type: Literal["ridge"] = "ridge"
    examples = ({"line_force": "-30 mN/m", "width": "10 um"}, {"line_force": -0.03, "stripe": 2e-4})
    line_force: LineForce
    stripe: Annotated[
        Length | None,
        Field(
            title="width of the stripe",
            description="distance of the two lines of a stripe of liquid [m]; one line if absent",
        ),
    ] = None

    def cells_across(self, dx: float, dy: float) -> float:
        """Return how many cells lie across the width or the stripe, whichever is less."""
        return min(self.width or inf, self.stripe or inf) / dx

    def traction(self, x: Array, y: Array) -> Array:
        """Return the traction [Pa] on each cell; that of a stripe has the sum 0."""
        if boundary_of_run() == "free":
            raise ConfigError(
                'has no ends, and a free domain has; set grid.boundary = "periodic"', "type"
            )
        left, right = edges(x)
        width = self.width or float((right - left).max())
        half = 0.5 * (self.stripe or 0.0)
        if half + 0.5 * width > right[-1, 0]:
            raise ConfigError("is wider than a period; use a larger grid.size", "stripe")
        traction = np.zeros(x.shape)
        for line in [-half, half] if half else [0.0]:
            traction += self.line_force / width * between(x, line - width / 2, line + width / 2)
        if half:
            traction -= self.line_force / half * between(x, -half, half)
        return np.broadcast_to(traction, np.broadcast_shapes(x.shape, y.shape))
