"""A drag beside the solid."""

from __future__ import annotations

from typing import Annotated, Literal

from pellicle.arrays import Array
from pellicle_fit.contact import Contact
from pellicle_fit.curve import Curve
from pellicle_fit.effect import Adds, Fitted, fitted


class Drag(Adds):
    """A drag η a dδ/dt on the contact radius a, that without tension."""

    type: Literal["drag"] = "drag"
    examples = ({}, {"drag": "1 Pa*s"})
    drag: Annotated[float, Fitted("Pa*s", at_least=0)] = fitted("viscosity η [Pa*s]")

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse curves without times, and contacts without a radius."""
        if curve.time is None:
            return "needs times or a speed"
        known = contact.half_space and not beside & {"layer", "stiff_surface"}
        return "" if known else "needs a contact radius"

    def force(self, contact: Contact, curve: Curve, depth: Array) -> Array:
        """Return η a dδ/dt [N]."""
        return self.drag * curve.velocity * contact.radius(depth)
