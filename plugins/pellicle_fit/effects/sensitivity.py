"""A sensitivity of the deflection that is off."""

from typing import Annotated, ClassVar, Literal

from pellicle_fit.effect import Array, Curve, Fitted, Records, fitted


class Sensitivity(Records, title="a wrong sensitivity"):
    """Deflections that are told 1 + ε times too large, and so are the forces.

    The base is where it was sent: what is off is the way of the tip, by ε F/k.
    """

    type: Literal["sensitivity"] = "sensitivity"
    examples = ({"sensitivity_error": {"value": 0, "deviation": 0.05}},)
    absorbed: ClassVar[str] = "the modulus makes up for it"
    sensitivity_error: Annotated[float, Fitted("1", above=-0.9)] = fitted(
        "error ε of the deflection sensitivity"
    )

    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return (1 + ε) F [N]."""
        return force * (1 + self.sensitivity_error)
