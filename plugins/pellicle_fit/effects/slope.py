"""A baseline with a slope."""

from typing import Annotated, ClassVar, Literal

from pellicle_fit.effect import Array, Curve, Fitted, Records, fitted


class Slope(Records, title="a sloping baseline"):
    """A force that grows with the position of the base, as optical interference makes it."""

    type: Literal["slope"] = "slope"
    examples = ({}, {"slope": "10 uN/m"})
    rank: ClassVar[int] = 1
    slope: Annotated[float, Fitted("N/m", scope="curve")] = fitted("slope of the baseline [N/m]")

    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return F + slope × way from the first position [N]."""
        return force + self.slope * (curve.base - float(curve.base.min()))
