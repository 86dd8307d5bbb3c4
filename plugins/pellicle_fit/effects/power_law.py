"""A solid that relaxes by a power law."""

from typing import Annotated, Literal

from pellicle_fit.effect import Array, Fitted, fitted

from .relaxing import Relaxing


class PowerLaw(Relaxing, title="power-law relaxation"):
    """Solid that relaxes by a power law, E(t) = E* (t / 1 s)^−α."""

    type: Literal["power_law"] = "power_law"
    examples = ({}, {"relaxation_exponent": 0.2})
    relaxation_exponent: Annotated[
        float, Fitted("1", at_least=0, at_most=0.95, starts=(0.05, 0.3))
    ] = fitted("exponent α")

    def relaxed(self, time: float) -> float:
        """Return (t / 1 s)^−α."""
        left: float = time**-self.relaxation_exponent
        return left

    def primitive(self, time: Array) -> Array:
        """Return t^(1−α) / (1 − α) [s]."""
        power = 1 - self.relaxation_exponent
        return time**power / power
