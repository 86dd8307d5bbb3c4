"""A cone in place of a bead."""

from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np

from pellicle_fit.effect import Contact, Curve

from .shape import Shape, in_place


class Cone(Shape, title="a cone instead"):
    """A cone in place of a bead, of 45°: its angle cannot be told from the modulus."""

    type: Literal["cone"] = "cone"
    examples = ({},)
    holds_modulus: ClassVar[bool] = False

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse a cone."""
        is_cone = getattr(contact.indenter, "type", "") == "cone"
        return "the indenter is one" if is_cone else super().excuse(contact, curve, beside)

    def contact(self, contact: Contact) -> Contact:
        """Return the contact of a cone."""
        return in_place(replace(contact, size=1.0), "cone", half_angle=float(np.pi / 4))
