"""Another size of the indenter."""

from typing import Annotated, ClassVar, Literal

from pellicle_fit.effect import Bends, Contact, Fitted, fitted


class Size(Bends, title="another size of the indenter"):
    """All lengths of the indenter times 1 + ε: a radius that is known to a few per cent."""

    type: Literal["size"] = "size"
    examples = ({"size_error": {"value": 0, "deviation": 0.03}},)
    absorbed: ClassVar[str] = "the modulus makes up for it"
    rank: ClassVar[int] = 0
    size_error: Annotated[float, Fitted("1", above=-0.9, scope="indenter")] = fitted(
        "ε of the indenter's lengths"
    )

    def contact(self, contact: Contact) -> Contact:
        """Return the contact of the indenter with its lengths times 1 + ε."""
        size, of = 1 + self.size_error, Contact.on_half_space
        return of(contact.indenter, contact.modulus, contact.deepest, size)
