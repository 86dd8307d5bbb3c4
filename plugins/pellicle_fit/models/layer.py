"""Indenter on an elastic layer that is bonded to a rigid base, under tension."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from pellicle.arrays import Array
from pellicle.components import ForceCurve, HasLayerForceCurve, LayerForceCurve
from pellicle_fit.parameters import MODULUS, TENSION, THICKNESS, Coordinates, Parameter, Values

from .checked_curve import checked_curve
from .force_model import ForceModel, ModelForce, TensionModel, described
from .solid import Solid, layer_table
from .solid import solid as solid_of

ACCURACY = 1e-4
"""Relative error of the force of the shipped indenters on a layer."""
_THICKNESSES = (0.5, 2.0, 10.0, 200.0)
"""Thicknesses of the initial guesses, over the measured range of positions."""


@dataclass(frozen=True)
class LayerModel(TensionModel):
    """Indenter on a bonded layer of known thickness and Poisson's ratio, under tension."""

    indenter: HasLayerForceCurve
    thickness: float
    """h [m]."""
    poissons_ratio: float
    """ν, from 0 to ½."""
    accuracy: ClassVar[float] = ACCURACY
    coarse: ClassVar[None] = None

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds, whatever the tension."""
        return self.indenter.layer_depth_limit(self.thickness, self.poissons_ratio)

    def force_curve(self, depth: Array, length: float) -> ForceCurve:
        """Return F/E* [m²] and its partial derivatives at depths [m] and s = ``length`` [m]."""
        curve = checked_curve(
            self.indenter, LayerForceCurve, depth, length, self.thickness, self.poissons_ratio
        )
        return ForceCurve(curve.force, curve.by_depth, curve.by_length)

    def description(self) -> dict[str, Any]:
        """Return the indenter and the layer as JSON data."""
        kernel = layer_table(self.poissons_ratio, thickness=self.thickness)
        return {"indenter": described(self.indenter), "kernel": kernel}


@dataclass(frozen=True)
class FreeLayerModel(ForceModel):
    """Indenter on a bonded layer whose thickness is a parameter of the fit, under tension."""

    indenter: HasLayerForceCurve
    poissons_ratio: float
    """ν, from 0 to ½."""
    parameters: ClassVar[tuple[Parameter, ...]] = (MODULUS, TENSION, THICKNESS)
    depth_limit: ClassVar[float] = float("inf")
    """That of the thickness that is fitted; see `at`."""
    accuracy: ClassVar[float] = ACCURACY
    coarse: ClassVar[None] = None
    on_base: ClassVar[bool] = False

    def at(self, thickness: float) -> LayerModel:
        """Return the model of a given thickness [m]."""
        return LayerModel(self.indenter, thickness, self.poissons_ratio)

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at depths [m] of shape (n,); 0 where ``depth`` ≤ 0."""
        modulus = values[MODULUS]
        length = 2 * values[TENSION] / modulus
        curve = checked_curve(
            self.indenter, LayerForceCurve, depth, length, values[THICKNESS], self.poissons_ratio
        )
        return ModelForce(
            modulus * curve.force,
            modulus * curve.by_depth,
            {
                MODULUS: curve.force - length * curve.by_length,
                TENSION: 2 * curve.by_length,
                THICKNESS: modulus * curve.by_thickness,
            },
        )

    def guesses(self, span: float) -> Iterator[Values]:
        """Yield guesses of E* and τ₀ at several thicknesses."""
        for ratio in _THICKNESSES:
            for values in self.at(ratio * span).guesses(span):
                yield {**values, THICKNESS: ratio * span}

    def scaled(self, values: Values, factor: float) -> Values:
        """Return modulus and tension times ``factor``, which leaves s unchanged."""
        return {**values, **{p: factor * values[p] for p in (MODULUS, TENSION)}}

    def description(self) -> dict[str, Any]:
        """Return the indenter and what is known of the layer as JSON data."""
        kernel = layer_table(self.poissons_ratio)
        return {"indenter": described(self.indenter), "kernel": kernel}


def known_layer(indenter: object, solid: Solid) -> LayerModel | None:
    """Return the model of a bonded layer; None if the solid is another or has to be simulated.

    A bonded layer is what is elastic and has the compliance of one at its depth and ratio.
    """
    kernel, ratio, thickness = solid.kernel, solid.poissons_ratio, solid.kernel.depth_to_base()
    if ratio is None or ratio < 0 or math.isinf(thickness) or kernel.branches():
        return None
    bonded = solid_of(layer_table(ratio, thickness=thickness)).kernel
    q = np.geomspace(1e-2, 1e2, 9) / thickness
    is_bonded = np.allclose(kernel.compliance(q), bonded.compliance(q), rtol=1e-9, atol=0)
    if not is_bonded or not isinstance(indenter, HasLayerForceCurve):
        return None
    model = LayerModel(indenter, thickness, ratio)
    # A punch is too wide for the curve at any depth, or at none.
    return model if model.depth_limit > 0 else None


def with_thickness(model: ForceModel, parameters: Coordinates) -> ForceModel:
    """Return the layer of the thickness in ``parameters`` if it is free, any other model itself."""
    if not isinstance(model, FreeLayerModel):
        return model
    return model.at(THICKNESS.value(parameters[THICKNESS]))
