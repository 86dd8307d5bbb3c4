"""A layer on a rigid base."""

from dataclasses import replace
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from pellicle.components import HasLayerForceCurve
from pellicle.units import Quantity
from pellicle_fit.contact import checked_area
from pellicle_fit.effect import Array, Bends, Contact, Curve, Fitted, fitted

_ERROR = 1e-4
"""Of the tables of force curves on layers, over the largest force."""


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
        if contact.is_own and isinstance(body, HasLayerForceCurve):
            limit = body.layer_depth_limit(self.thickness or 1.0, self.poissons_ratio)
            return "" if limit > 0 else "the curve of this tip on a layer is not known"
        return "needs an indenter whose curve on a layer is known"

    def contact(self, contact: Contact) -> Contact:
        """Return the contact with the layer."""
        body, size, ratio = contact.indenter, contact.size, self.poissons_ratio
        assert isinstance(body, HasLayerForceCurve)
        layer = self.thickness / size, ratio

        def area(depth: Array, length: float) -> Array:
            depth = depth / size
            curve = body.layer_force_curve(depth, length / size, *layer)
            return size**2 * checked_area(body, curve, depth)

        limit = size * body.layer_depth_limit(*layer)
        return replace(contact, area=area, depth_limit=limit, half_space=False, error=_ERROR)
