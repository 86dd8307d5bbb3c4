"""A constant force of the instrument."""

from collections.abc import Iterable
from typing import Annotated, ClassVar, Literal

from pellicle_fit.effect import Array, Curve, Fitted, Records, Sizes, Values, fitted


class Offset(Records, title="an offset"):
    """Constant force of the instrument."""

    type: Literal["offset"] = "offset"
    examples = ({}, {"offset": "10 pN"})
    rank: ClassVar[int] = 1
    offset: Annotated[float, Fitted("N", scope="curve")] = fitted("force without a load [N]")

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield the force before contact, which may be far from 0."""
        yield {"offset": sizes.shallow_force}

    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return F + F₀ [N]."""
        return force + self.offset
