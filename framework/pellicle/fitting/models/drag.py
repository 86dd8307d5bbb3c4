"""Drag of the solid or of the liquid around it, in proportion to contact radius and speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from pellicle.arrays import Array
from pellicle.fitting.parameters import Parameter, Values

from .effect import EffectModel
from .force_model import ModelForce

DRAG = Parameter("drag", "Pa s", minimum=0.0, shared=True)
"""η of the force η a dδ/dt, with the contact radius a."""


@dataclass(frozen=True)
class DragModel(EffectModel):
    """Elastic solid under tension with a drag η a dδ/dt in contact.

    The contact radius a is that without tension, half the slope of the force over E*.
    """

    effect: ClassVar[Parameter] = DRAG
    is_sudden: ClassVar[bool] = True
    """The rows at first touch weigh so much that χ² depends on which of them touch."""

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at depths [m] of the rows, of shape (n,)."""
        elastic = self.elastic.force(depth, values)
        radius = self.elastic.force_curve(depth, 0.0).by_depth / 2
        # The radius grows without limit at first touch; a difference over one row has a limit.
        step = float(np.ptp(depth)) / depth.size
        growth = (self.elastic.force_curve(depth + step, 0.0).by_depth / 2 - radius) / step
        drag = values[DRAG] * self.history.velocity
        return ModelForce(
            elastic.force + drag * radius,
            elastic.by_depth + drag * np.where(depth > 0, growth, 0.0),
            {**elastic.by_parameter, DRAG: self.history.velocity * radius},
        )

    def description(self) -> dict[str, Any]:
        """Return the indenter and the drag as JSON data."""
        return self.elastic.description() | {"drag": "contact radius × speed"}
