"""Force models: the force on an indenter as a function of named parameters.

A new model (adhesion, layers, relaxation) is one file with its `Parameter` records and a class
that satisfies `ForceModel`; likelihoods and initial guesses work with any.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Component, ForceCurve, HasForceCurve
from pellicle.components.calls import force_curve_of

_LENGTHS = (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0)
"""Elastocapillary lengths s of the initial guesses, over the measured range of positions."""


@dataclass(frozen=True)
class Parameter:
    """A quantity that a fit determines, or that the user fixes."""

    name: str
    unit: str
    """SI unit; m, N or N/m unless `logarithmic`, since a curve sets the scale of these only."""
    minimum: float = -np.inf
    """Least allowed value, which the best value may equal."""
    logarithmic: bool = False
    """Whether the fit varies the natural logarithm, as for a modulus of unknown magnitude."""
    shared: bool = False
    """Whether all curves of a pooled fit have the same value."""
    curve: int = 0
    """Index of the curve in a pooled fit; 0 if shared."""

    def of_curve(self, index: int) -> Parameter:
        """Return the parameter of one curve of a pooled fit."""
        return self if self.shared else replace(self, curve=index)

    def coordinate(self, value: float) -> float:
        """Return the coordinate that the fit varies: the value, or its natural logarithm."""
        return float(np.log(value)) if self.logarithmic else value

    def value(self, coordinate: float) -> float:
        """Return the value at a coordinate."""
        return float(np.exp(coordinate)) if self.logarithmic else coordinate


Values = Mapping[Parameter, float]
"""Values of parameters, each in its unit."""
Coordinates = dict[Parameter, float]
"""What a fit varies: the value of each parameter, or its natural logarithm if `logarithmic`."""

CONTACT_POINT = Parameter("contact_point", "m")
"""Position of first touch."""
MODULUS = Parameter("reduced_modulus", "Pa", logarithmic=True, shared=True)
"""E*."""
TENSION = Parameter("tension", "N/m", minimum=0.0, shared=True)
"""τ₀."""
OFFSET = Parameter("offset", "N")
"""Force of the baseline at the first position."""
SLOPE = Parameter("slope", "N/m")
"""Slope of the baseline."""


class ModelForce(NamedTuple):
    """Force of a model and its partial derivatives, each of shape (n,)."""

    force: Array
    """F [N]."""
    by_depth: Array
    """∂F/∂δ [N/m]."""
    by_parameter: Mapping[Parameter, Array]
    """Derivative of F with respect to the value of each parameter [N per unit]."""


class ForceModel(Protocol):
    """Force on an indenter, given the depth and the values of named parameters."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters, without contact point and baseline, which every curve has."""

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the model holds; infinite if there is none."""

    @property
    def accuracy(self) -> float:
        """Error of the force relative to the largest one; noise below this cannot be resolved."""

    @property
    def coarse(self) -> ForceModel | None:
        """The same model from coarser grids, if it is simulated, else None."""

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at depths [m] of shape (n,); 0 where ``depth`` ≤ 0."""

    def guesses(self, span: float) -> Iterable[Values]:
        """Yield values to compare with a curve whose positions span ``span`` [m]."""

    def scaled(self, values: Values, factor: float) -> Values:
        """Return values for which the force is ``factor`` times as large at every depth."""

    def description(self) -> dict[str, Any]:
        """Return indenter and solid as JSON data."""


class TensionModel(ForceModel, ABC):
    """Indenter on a linear elastic solid under tension: F = E* a(δ, s) with s = 2τ₀/E*.

    The dependence on E* and τ₀ follows from dimensional analysis: F/E* is an area a that depends on
    lengths only, among them the elastocapillary length s.
    """

    parameters: ClassVar[tuple[Parameter, ...]] = (MODULUS, TENSION)

    @abstractmethod
    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return F/E* [m²] and its partial derivatives at depths [m] and s = ``length`` [m]."""

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at depths [m] of shape (n,); 0 where ``depth`` ≤ 0."""
        modulus = values[MODULUS]
        length = 2 * values[TENSION] / modulus
        curve = self.force_curve(depth, length)
        return ModelForce(
            modulus * curve.force,
            modulus * curve.by_depth,
            {MODULUS: curve.force - length * curve.by_length, TENSION: 2 * curve.by_length},
        )

    def guesses(self, span: float) -> Iterator[Values]:
        """Yield E* = 1 Pa with tensions from none to one that dominates."""
        for length in _LENGTHS:
            yield {MODULUS: 1.0, TENSION: length * span / 2}

    def scaled(self, values: Values, factor: float) -> Values:
        """Return modulus and tension times ``factor``, which leaves s unchanged."""
        return {parameter: factor * value for parameter, value in values.items()}


@dataclass(frozen=True)
class ClosedFormModel(TensionModel):
    """Indenter with a force curve of its own, on a half-space under tension."""

    indenter: HasForceCurve
    accuracy: ClassVar[float] = 1e-6
    """Accuracy of the master curves that the shipped indenters interpolate."""
    coarse: ClassVar[None] = None

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds."""
        return self.indenter.depth_limit

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return F/E* [m²] and its partial derivatives at depths [m] and s = ``length`` [m]."""
        return force_curve_of(self.indenter, depth, length)

    def description(self) -> dict[str, Any]:
        """Return the indenter as JSON data."""
        if isinstance(self.indenter, Component):
            return {"indenter": self.indenter.model_dump(mode="json", exclude_none=True)}
        return {"indenter": {"type": type(self.indenter).__name__}}


def tension_model(curve: HasForceCurve) -> TensionModel:
    """Return the force model of anything that has a force curve."""
    return curve if isinstance(curve, TensionModel) else ClosedFormModel(curve)
