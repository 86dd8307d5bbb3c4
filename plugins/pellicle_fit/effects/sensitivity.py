"""A sensitivity of the deflection that is off."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict

from pellicle_fit.effect import Array, Contact, Curve, Fitted, Records, Weighed, fitted


class Sensitivity(Records):
    """Deflections that are told 1 + ε times too large, and so are the forces.

    The base is where it was sent: what is off is the way of the tip, by ε F/k.
    """

    model_config = ConfigDict(title="a sensitivity that is off")
    type: Literal["sensitivity"] = "sensitivity"
    examples = ({"sensitivity_error": {"value": 0, "deviation": 0.05}},)
    sensitivity_error: Annotated[float, Fitted("1", above=-0.9)] = fitted(
        "error ε of the deflection sensitivity"
    )

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse a free error, for which the modulus makes up."""
        if self.open and not isinstance(self.sensitivity_error, Weighed):
            return "needs a deviation: the modulus makes up for it"
        return ""

    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return (1 + ε) F [N]."""
        return force * (1 + self.sensitivity_error)
