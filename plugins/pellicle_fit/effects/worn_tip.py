"""A paraboloid with a worn tip."""

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from pellicle_fit.effect import Array, Contact, Fitted, fitted

from .shape import Shape


class WornTip(Shape, title="a worn tip"):
    """A paraboloid or a sphere whose tip is worn to a flat of radius b.

    δ = (a/R) √(a² − b²), F = (2 E*/3R) (2a² + b²) √(a² − b²) (Popov, Heß & Willert 2019), times the
    force of a sphere over that of a paraboloid at the same depth.
    """

    type: Literal["worn_tip"] = "worn_tip"
    examples = ({}, {"flat_radius": "0.5 um"})
    flat_radius: Annotated[float, Fitted("m", at_least=0, starts=(0.1, 0.5))] = fitted(
        "radius b of the flat [m]"
    )

    def contact(self, contact: Contact) -> Contact:
        """Return the contact of the worn tip."""
        radius, flat = contact.tip_radius or 0.0, self.flat_radius

        def area(depth: Array, length: float) -> Array:
            deep = np.maximum(depth, 0.0)
            squared = (flat**2 + np.sqrt(flat**4 + 4 * (radius * deep) ** 2)) / 2
            rise = np.sqrt(np.maximum(squared - flat**2, 0.0))
            hertz = 4 / 3 * np.sqrt(radius * np.maximum(deep, 1e-90) ** 3)
            worn = 2 / (3 * radius) * (2 * squared + flat**2) * rise
            whole = contact.tabulated(float(np.max(deep))).area(depth, length)
            return worn * np.where(deep > 0, whole / hertz, 0.0)

        return replace(contact, area=area)
