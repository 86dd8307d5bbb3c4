"""A compliance in series: a soft holder, or a sensitivity that is off."""

from typing import Annotated, Literal

from pellicle_fit.effect import Array, Fitted, Yields, fitted


class Compliance(Yields, title="a compliance in series (or a wrong sensitivity)"):
    """Something in series that gives way by u = cF, of either sign.

    A deflection sensitivity that is off by a share ε puts the tip wrong by ε F/k: c = ε/k.
    """

    type: Literal["compliance"] = "compliance"
    examples = ({}, {"compliance": "2 m/N"})
    # It gives way by less than the solid does.
    compliance: Annotated[float, Fitted("m/N", starts=(0.05, -0.05), limits=(-0.3, 0.3))] = fitted(
        "compliance c [m/N]"
    )

    def give(self, force: Array) -> Array:
        """Return cF [m]."""
        return self.compliance * force
