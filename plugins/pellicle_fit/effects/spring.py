"""A spring constant that is off."""

from typing import Annotated, ClassVar, Literal

from pellicle_fit.effect import Array, Curve, Fitted, Records, fitted


class Spring(Records, title="a wrong spring constant"):
    """The spring constant is 1 + ε times the one that the recorded force assumes."""

    type: Literal["spring"] = "spring"
    examples = ({"spring_error": {"value": 0, "deviation": 0.1}},)
    absorbed: ClassVar[str] = "modulus and tension make up for it exactly"
    spring_error: Annotated[float, Fitted("1", above=-0.9)] = fitted("ε of the spring constant")

    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return F / (1 + ε) [N]."""
        return force / (1 + self.spring_error)

    def stiffness(self, stiffness: float) -> float:
        """Return k (1 + ε) [N/m]."""
        return stiffness * (1 + self.spring_error)
