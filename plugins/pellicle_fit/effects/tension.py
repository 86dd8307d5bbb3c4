"""The tension of the surface."""

from dataclasses import replace
from typing import Annotated, ClassVar, Literal

from pellicle_fit.effect import Bends, Contact, Fitted, fitted


class Tension(Bends):
    """A skin under tension on the solid, as `tensed_membrane` has it."""

    type: Literal["tension"] = "tension"
    examples = ({}, {"tension": "1 mN/m"})
    rank: ClassVar[int] = 3
    tension: Annotated[float, Fitted("N/m", at_least=0, starts=(0.0, 0.015, 0.15, 1.5))] = fitted(
        "surface tension τ₀ [N/m]"
    )

    def contact(self, contact: Contact) -> Contact:
        """Return the contact under the tension: E* A(δ, s) with s = 2τ₀/E*."""
        return replace(contact, tension=self.tension)
