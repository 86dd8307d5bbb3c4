"""What effects have in common that put another shape in place of the indenter."""

from dataclasses import replace
from functools import lru_cache
from typing import ClassVar

from pellicle import indenter
from pellicle.components import HasForceCurve
from pellicle_fit.effect import Bends, Contact, Curve


class Shape(Bends):
    """Another shape in place of the indenter."""

    rank: ClassVar[int] = 1

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse a tip that is not round."""
        return "" if contact.tip_radius else "needs a round tip"


def in_place(contact: Contact, name: str, **fields: float | None) -> Contact:
    """Return the contact of another indenter in place of that of one, of the same size."""
    of = Contact.on_half_space
    exchanged = of(_body(name, **fields), contact.modulus, contact.deepest, contact.size)
    return replace(exchanged, tension=contact.tension)


@lru_cache(maxsize=64)
def _body(name: str, **fields: float | None) -> HasForceCurve:
    body = indenter(name, **fields)
    assert isinstance(body, HasForceCurve)
    return body
