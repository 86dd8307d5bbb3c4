"""Another size of the indenter."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import ConfigDict

from pellicle_fit.effect import Bends, Contact, Curve, Fitted, Weighed, fitted


class Size(Bends):
    """All lengths of the indenter times 1 + ε: a radius that is known to a few per cent."""

    model_config = ConfigDict(title="another size of the indenter")
    type: Literal["size"] = "size"
    examples = ({"size_error": {"value": 0, "deviation": 0.03}},)
    rank: ClassVar[int] = 0
    size_error: Annotated[float, Fitted("1", above=-0.9, scope="indenter")] = fitted(
        "ε of the indenter's lengths"
    )

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse a free size, which scales the modulus."""
        if self.open and not isinstance(self.size_error, Weighed):
            return "needs a deviation: the modulus makes up for it"
        return ""

    def contact(self, contact: Contact) -> Contact:
        """Return the contact of the indenter with its lengths times 1 + ε."""
        return Contact.on_half_space(contact.indenter, contact.modulus, 1 + self.size_error)
