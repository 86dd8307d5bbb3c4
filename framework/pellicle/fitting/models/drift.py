"""Indenter on an elastic solid, with an instrument whose force drifts in time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle.fitting.parameters import Parameter, Values

from .effect import EffectModel
from .force_model import ModelForce

DRIFT = Parameter("drift", "N/s")
"""Rate of the force without a load."""


@dataclass(frozen=True)
class DriftModel(EffectModel):
    """Elastic solid under tension, and a force that grows with time from the first row on.

    On one pass at constant speed it is a sloping baseline; on two it does not turn back.
    """

    effect: ClassVar[Parameter] = DRIFT

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at depths [m] of the rows, of shape (n,)."""
        elastic = self.elastic.force(depth, values)
        elapsed = self.history.time - float(np.min(self.history.loading_path[0]))
        force = elastic.force + values[DRIFT] * elapsed
        return ModelForce(force, elastic.by_depth, {**elastic.by_parameter, DRIFT: elapsed})

    def at_rows(self, rows: NDArray[np.intp]) -> DriftModel:
        """Return the model of some of the rows."""
        return replace(self, history=self.history.at_rows(rows))

    def description(self) -> dict[str, Any]:
        """Return the indenter and the drift as JSON data."""
        return self.elastic.description() | {"drift": "constant rate"}
