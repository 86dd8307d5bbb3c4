"""Indenter on an elastic solid, with an instrument whose force drifts in time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle.fitting.parameters import Parameter, Values

from .force_model import ModelForce, TensionModel
from .history import History

DRIFT = Parameter("drift", "N/s")
"""Rate of the force without a load."""


@dataclass(frozen=True)
class DriftModel:
    """Elastic solid under tension, and a force that grows with time from the first row on.

    On one pass at constant speed it is a sloping baseline; on two it does not turn back.
    """

    elastic: TensionModel
    history: History
    coarse: ClassVar[None] = None
    on_base: ClassVar[bool] = False

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Modulus, tension and drift."""
        return (*self.elastic.parameters, DRIFT)

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds."""
        return self.elastic.depth_limit

    @property
    def accuracy(self) -> float:
        """Error of the elastic force."""
        return self.elastic.accuracy

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at depths [m] of the rows, of shape (n,)."""
        elastic = self.elastic.force(depth, values)
        elapsed = self.history.time - float(np.min(self.history.loading_path[0]))
        force = elastic.force + values[DRIFT] * elapsed
        return ModelForce(force, elastic.by_depth, {**elastic.by_parameter, DRIFT: elapsed})

    def at_rows(self, rows: NDArray[np.intp]) -> DriftModel:
        """Return the model of some of the rows."""
        return replace(self, history=self.history.at_rows(rows))

    def guesses(self, span: float) -> Iterator[Values]:
        """Yield guesses of the elastic solid without drift."""
        for values in self.elastic.guesses(span):
            yield {**values, DRIFT: 0.0}

    def scaled(self, values: Values, factor: float) -> Values:
        """Return all values times ``factor``."""
        return {parameter: factor * value for parameter, value in values.items()}

    def description(self) -> dict[str, Any]:
        """Return the indenter and the drift as JSON data."""
        return self.elastic.description() | {"drift": "constant rate"}
