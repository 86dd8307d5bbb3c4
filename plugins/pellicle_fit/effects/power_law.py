"""A solid that relaxes by a power law."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Literal

from pydantic import ConfigDict

from pellicle_fit.effect import Array, Fitted, Sizes, Values, fitted

from .relaxing import Relaxing


class PowerLaw(Relaxing):
    """Solid that relaxes by a power law, E(t) = E* (t / 1 s)^−α."""

    model_config = ConfigDict(title="power-law relaxation")
    type: Literal["power_law"] = "power_law"
    examples = ({}, {"relaxation_exponent": 0.2})
    relaxation_exponent: Annotated[float, Fitted("1", at_least=0, at_most=0.95)] = fitted(
        "exponent α"
    )

    def relaxed(self, time: float) -> float:
        """Return (t / 1 s)^−α."""
        return float(time**-self.relaxation_exponent)

    def primitive(self, time: Array) -> Array:
        """Return t^(1−α) / (1 − α) [s]."""
        power = 1 - self.relaxation_exponent
        return time**power / power

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield a solid that hardly relaxes and one that flows."""
        yield from ({"relaxation_exponent": exponent} for exponent in (0.05, 0.3))
