"""Elastic solid with one effect beside it: a drift of the instrument, or a drag."""

from __future__ import annotations

from abc import ABC
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle_fit.parameters import Parameter, Values

from .force_model import ForceModel, ModelForce, TensionModel
from .history import History

DRIFT = Parameter("drift", "N/s")
"""Rate of the force without a load."""
DRAG = Parameter("drag", "Pa s", minimum=0.0, shared=True)
"""η of the force η a dδ/dt, with the contact radius a."""


@dataclass(frozen=True)
class EffectModel(ForceModel, ABC):
    """Elastic solid under tension, and an effect whose force is proportional to one parameter."""

    elastic: TensionModel
    history: History
    effect: ClassVar[Parameter]
    coarse: ClassVar[None] = None
    on_base: ClassVar[bool] = False

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Modulus, tension and the parameter of the effect."""
        return (*self.elastic.parameters, self.effect)

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds."""
        return self.elastic.depth_limit

    @property
    def accuracy(self) -> float:
        """Error of the elastic force."""
        return self.elastic.accuracy

    def guesses(self, span: float) -> Iterator[Values]:
        """Yield guesses of the elastic solid without the effect."""
        for values in self.elastic.guesses(span):
            yield {**values, self.effect: 0.0}

    def scaled(self, values: Values, factor: float) -> Values:
        """Return all values times ``factor``."""
        return {parameter: factor * value for parameter, value in values.items()}


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
