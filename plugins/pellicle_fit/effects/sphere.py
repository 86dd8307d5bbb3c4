"""A sphere in place of its shallow limit, and the reverse."""

from typing import Literal

from pellicle_fit.effect import Contact, Curve

from .shape import Shape, in_place

SHALLOW = 0.1
"""Depth over radius up to which a sphere is a paraboloid."""


class Sphere(Shape, title="a sphere, or a paraboloid, instead"):
    """A sphere in place of a paraboloid, or a paraboloid in place of a sphere."""

    type: Literal["sphere"] = "sphere"
    examples = ({},)

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse shallow curves too, on which both are one."""
        deep = curve.span > SHALLOW * (contact.tip_radius or 0.0)
        excuse = "" if deep else "on a shallow curve sphere and paraboloid are one"
        return super().excuse(contact, curve, beside) or excuse

    def contact(self, contact: Contact) -> Contact:
        """Return the contact of the other shape."""
        is_sphere = getattr(contact.indenter, "type", "") == "sphere"
        return in_place(contact, "paraboloid" if is_sphere else "sphere", radius=contact.own_radius)
