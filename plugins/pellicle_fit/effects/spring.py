"""A spring constant that is off."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict

from pellicle_fit.effect import Array, Contact, Curve, Fitted, Records, Weighed, fitted


class Spring(Records):
    """The spring constant is 1 + ε times the one that the recorded force assumes."""

    model_config = ConfigDict(title="a wrong spring constant")
    type: Literal["spring"] = "spring"
    examples = ({"spring_error": {"value": 0, "deviation": 0.1}},)
    spring_error: Annotated[float, Fitted("1", above=-0.9)] = fitted("ε of the spring constant")

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse a free spring constant, which scales the modulus."""
        if self.open and not isinstance(self.spring_error, Weighed):
            return "needs a deviation: modulus and tension make up for it exactly"
        return ""

    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return F / (1 + ε) [N]."""
        return force / (1 + self.spring_error)

    def stiffness(self, stiffness: float) -> float:
        """Return k (1 + ε) [N/m]."""
        return stiffness * (1 + self.spring_error)
