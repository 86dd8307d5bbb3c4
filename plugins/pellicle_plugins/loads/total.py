"""The sum of several loads."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import FromRegistry, Load
from pellicle.errors import problems_within


class Sum(Load):
    """Tractions of several loads added, such as a drop and a point force."""

    type: Literal["sum"] = "sum"
    examples = (
        {
            "parts": [
                {"type": "ring", "radius": "0.3 mm", "line_force": "-30 mN/m"},
                {"type": "disc", "radius": "0.3 mm", "pressure": "200 Pa"},
            ]
        },
    )
    parts: tuple[Annotated[Load, FromRegistry()], ...] = Field(
        min_length=1, description="the loads to add: tables with type"
    )

    @property
    def has_line_without_width(self) -> bool:
        """Whether any part has one."""
        return any(part.has_line_without_width for part in self.parts)

    def cells_across(self, dx: float, dy: float) -> float:
        """Return that of the finest part."""
        return min(part.cells_across(dx, dy) for part in self.parts)

    def traction(self, x: Array, y: Array) -> Array:
        """Return the sum of the tractions [Pa]."""
        traction = np.zeros(np.broadcast_shapes(x.shape, y.shape))
        for index, part in enumerate(self.parts):
            with problems_within(f"parts.{index}"):
                traction += part.traction(x, y)
        return traction
