"""A round tip that is worn."""

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from pellicle_fit.effect import Array, Contact, Fitted, fitted

from .shape import Shape, in_place

_ERROR = 3e-3
"""Error of the force of a worn sphere."""


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
        flat = self.flat_radius or None
        worn = in_place(contact, "paraboloid", radius=contact.tip_radius, flat_radius=flat)
        if getattr(contact.indenter, "type", "") == "paraboloid":
            return worn
        whole = in_place(contact, "paraboloid", radius=contact.tip_radius)

        def area(depth: Array, length: float) -> Array:
            round_, hertz = contact.area(depth, length), whole.area(depth, length)
            share = np.divide(round_, hertz, out=np.zeros_like(hertz), where=hertz > 0)
            return worn.area(depth, length) * share

        error = max(contact.error, _ERROR)
        return replace(worn, area=area, depth_limit=contact.depth_limit, error=error)
