"""A drag beside the solid."""

from typing import Annotated, Literal

from pellicle_fit.effect import Adds, Array, Contact, Curve, Fitted, fitted


class Drag(Adds):
    """Viscous drag η a v on the contact radius a, which is that without tension.

    The velocity v is that of the base, the mean of each pass.
    """

    type: Literal["drag"] = "drag"
    examples = ({}, {"drag": "1 Pa*s"})
    drag: Annotated[float, Fitted("Pa*s", at_least=0)] = fitted("viscosity η [Pa*s]")

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse contacts without a radius."""
        return "" if contact.half_space else "needs a contact radius"

    def force(self, contact: Contact, curve: Curve, depth: Array) -> Array:
        """Return η a v [N]."""
        return self.drag * curve.velocity * contact.radius(depth)
