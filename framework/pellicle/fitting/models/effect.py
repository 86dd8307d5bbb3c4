"""Elastic solid with one effect beside it that depends on the history of a curve."""

from __future__ import annotations

from abc import ABC
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from pellicle.fitting.parameters import Parameter, Values

from .force_model import ForceModel, TensionModel
from .history import History


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
