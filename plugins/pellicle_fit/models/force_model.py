"""Force models: the force on an indenter as a function of named parameters.

A new model (adhesion, layers, relaxation) is one file with its `Parameter` records and a class
that satisfies `ForceModel`; likelihoods and initial guesses work with any.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle.components import Component, ForceCurve, HasForceCurve
from pellicle_fit.parameters import MODULUS, TENSION, Parameter, Values

from .checked_curve import checked_curve

_LENGTHS = (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0)
"""Elastocapillary lengths s of the initial guesses, over the measured range of positions."""


class ModelForce(NamedTuple):
    """Force of a model and its partial derivatives, each of shape (n,)."""

    force: Array
    """F [N]."""
    by_depth: Array
    """∂F/∂δ [N/m]."""
    by_parameter: Mapping[Parameter, Array]
    """Derivative of F with respect to the value of each parameter [N per unit].

    For a solid with a memory that of the contact point too, at equal depths: the time in contact.
    """


class DeferredDerivatives(Mapping[Parameter, Array]):
    """Derivatives by parameter that are computed when the first of them is read.

    The balance of a cantilever evaluates a model some six times, and reads them once.
    """

    def __init__(self, compute: Callable[[], Mapping[Parameter, Array]]) -> None:
        self._compute = compute

    @cached_property
    def _values(self) -> Mapping[Parameter, Array]:
        return self._compute()

    def __getitem__(self, parameter: Parameter) -> Array:
        """Return the derivative by a parameter."""
        return self._values[parameter]

    def __iter__(self) -> Iterator[Parameter]:
        """Iterate over the parameters."""
        return iter(self._values)

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self._values)


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
    def on_base(self) -> bool:
        """Whether depths are those of the cantilever's base, whose bending the model includes."""

    @property
    def coarse(self) -> ForceModel | None:
        """The same model from coarser grids, if it is simulated, else None."""

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at depths [m] of shape (n,); 0 where ``depth`` ≤ 0.

        ``values`` has the contact point too.
        """

    def guesses(self, span: float) -> Iterable[Values]:
        """Yield values to compare with a curve whose positions span ``span`` [m]."""

    def scaled(self, values: Values, factor: float) -> Values:
        """Return values for which the force is ``factor`` times as large at every depth."""

    def description(self) -> dict[str, Any]:
        """Return indenter and solid as JSON data."""


@runtime_checkable
class HasRows(Protocol):
    """A force model that belongs to the rows of one curve."""

    def at_rows(self, rows: NDArray[np.intp]) -> ForceModel:
        """Return the model of some of the rows."""


class TensionModel(ForceModel, ABC):
    """Indenter on a linear elastic solid under tension: F = E* a(δ, s) with s = 2τ₀/E*.

    The dependence on E* and τ₀ follows from dimensional analysis: F/E* is an area a that depends on
    lengths only, among them the elastocapillary length s.
    """

    parameters: ClassVar[tuple[Parameter, ...]] = (MODULUS, TENSION)
    on_base: ClassVar[bool] = False

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
        return checked_curve(self.indenter, ForceCurve, depth, length)

    def description(self) -> dict[str, Any]:
        """Return the indenter as JSON data."""
        return {"indenter": described(self.indenter)}


def described(indenter: object) -> dict[str, Any]:
    """Return an indenter, or the fields of one, as JSON data."""
    if isinstance(indenter, Component):
        return indenter.model_dump(mode="json", exclude_none=True)
    return dict(indenter) if isinstance(indenter, Mapping) else {"type": type(indenter).__name__}


def tension_model(curve: HasForceCurve) -> TensionModel:
    """Return the force model of anything that has a force curve."""
    return curve if isinstance(curve, TensionModel) else ClosedFormModel(curve)
