"""A round tip that is worn."""

from dataclasses import replace
from functools import cache
from typing import Annotated, Literal

import numpy as np

from pellicle import indenter
from pellicle.components import HasForceCurve
from pellicle_fit.contact.area_table import Areas
from pellicle_fit.contact.contact import Area, OwnArea
from pellicle_fit.effect import Array, Contact, Fitted, fitted

from .shape import Shape, in_place

_ERROR = 3e-3
"""Error of the force of a worn sphere."""
_SHARP = 1e-3
"""Radius of a flat that changes a force by less than a millionth, over √(Rδ)."""
_SCALE, _NODES = 0.01, 240
"""Scale of s over the flat, and nodes of the depth in the table of all worn tips."""


class WornTip(Shape, title="a worn tip"):
    """A paraboloid or a sphere whose tip is worn to a flat of radius b.

    A worn sphere has the force of a worn paraboloid times that of a sphere over that of a
    paraboloid at the same depth, which is right to 0.3 % up to b = 0.4 R.
    """

    type: Literal["worn_tip"] = "worn_tip"
    examples = ({}, {"flat_radius": "0.5 um"})
    flat_radius: Annotated[float, Fitted("m", at_least=0, starts=(0.1, 0.5))] = fitted(
        "radius b of the flat [m]"
    )

    def contact(self, contact: Contact) -> Contact:
        """Return the contact of the worn tip."""
        radius = contact.size * contact.own_radius
        whole = tip = in_place(contact, "paraboloid", radius=contact.own_radius)
        if not np.ndim(self.flat_radius) and np.ndim(contact.size) == 0:
            flat = self.flat_radius / contact.size or None
            tip = in_place(contact, "paraboloid", radius=contact.own_radius, flat_radius=flat)
        worn: Area = tip.area
        if np.ndim(self.flat_radius) or self.flat_radius:
            flat = np.maximum(self.flat_radius, _SHARP * np.sqrt(radius * contact.deepest))
            worn = OwnArea(_unit(), flat, flat**2 / radius)
        if getattr(contact.indenter, "type", "") == "paraboloid":
            return replace(tip, area=worn)

        def area(depth: Array, length: float) -> Array:
            round_, hertz = contact.area(depth, length), whole.area(depth, length)
            share = np.divide(round_, hertz, out=np.zeros_like(hertz), where=hertz > 0)
            return worn(depth, length) * share

        error = max(contact.error, _ERROR)
        return replace(tip, area=area, depth_limit=contact.depth_limit, error=error)


@cache
def _unit() -> Areas:
    """Return the areas of a tip of radius and flat 1, of which all worn tips are stretched."""
    tip = indenter("paraboloid", radius=1.0, flat_radius=1.0)
    assert isinstance(tip, HasForceCurve)
    return Areas(tip, 1 / _SHARP**2, _SCALE, _NODES)
