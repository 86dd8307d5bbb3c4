"""A layer on a rigid base."""

from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle.components import HasLayerForceCurve
from pellicle.units import Quantity
from pellicle_fit.contact.area_table import checked_area, cubic, cubics, last, layer
from pellicle_fit.effect import Array, Bends, Contact, Curve, Fitted, fitted

_ERROR = 1e-4
"""Of the tables of force curves on layers, over the largest force."""
_STEPS, _NEAR = 64, 1e-4
"""Steps in √δ of an area under a tension, and how near to each other trials share them."""


class Layer(Bends, title="a thin layer"):
    """Elastic layer of thickness h, bonded to a rigid base, in place of the half-space."""

    type: Literal["layer"] = "layer"
    examples = ({}, {"thickness": "10 um", "poissons_ratio": 0.4})
    rank: ClassVar[int] = 2
    thickness: Annotated[
        float, Fitted("m", above=0, log=True, starts=(0.5, 2.0, 10.0), limits=(1e-2, 1e3))
    ] = fitted("thickness h [m]")
    poissons_ratio: Annotated[
        float, Quantity("1", at_least=0, at_most=0.5), Field(description="Poisson's ratio ν")
    ] = 0.5

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse an indenter without a curve on layers, or one whose tip is another."""
        body = contact.indenter
        if contact.is_bare and isinstance(body, HasLayerForceCurve):
            limit = body.layer_depth_limit(self.thickness or 1.0, self.poissons_ratio)
            return "" if limit > 0 else "the curve of this tip on a layer is not known"
        return "needs an indenter whose curve on a layer is known"

    def contact(self, contact: Contact) -> Contact:
        """Return the contact with the layer."""
        body, size, ratio = contact.indenter, contact.size, self.poissons_ratio
        assert isinstance(body, HasLayerForceCurve)
        thickness = np.asarray(self.thickness / size)
        of_layer, limit = layer(body, contact.deepest, ratio)

        def under_tension(length: float) -> tuple[Array, Array]:
            pairs = np.broadcast_arrays(thickness, length / size)
            known: list[tuple[float, float, float, Any]] = []
            steps, values = [], []
            for h, s in zip(*(pair.ravel().tolist() for pair in pairs), strict=True):
                # Trials beside each other, as for derivatives, differ to first order.
                near = (entry for entry in known if abs(entry[0] - h) < _NEAR * h)
                near = (entry for entry in near if abs(entry[1] - s) < _NEAR * (s + _NEAR * h))
                if (entry := next(near, None)) is None:
                    step = np.sqrt(min(contact.deepest, float(limit(h)))) / _STEPS
                    depths = (step * np.arange(_STEPS + 1)) ** 2
                    of = body.layer_force_curve(depths, s, h, ratio)
                    checked_area(body, of, depths)
                    entry = h, s, step, of
                    known.append(entry)
                h_, s_, step, of = entry
                steps.append(step)
                values.append(of.force + of.by_thickness * (h - h_) + of.by_length * (s - s_))
            return np.reshape(steps, (-1, 1)), cubics(np.array(values))

        splines = last(under_tension)

        def area(depth: Array, length: float) -> Array:
            depth = depth / size
            if not np.any(length):
                return np.asarray(size**2 * of_layer(depth, thickness))
            step, of = splines(length)
            root = np.sqrt(np.maximum(depth, 0.0)) / step
            area = cubic(of, np.minimum(root, _STEPS), 1.0)
            return np.asarray(size**2 * area.reshape(np.shape(depth + length + thickness)))

        deep: Any = size * limit(thickness)
        return replace(contact, area=area, depth_limit=deep, half_space=False, error=_ERROR)
