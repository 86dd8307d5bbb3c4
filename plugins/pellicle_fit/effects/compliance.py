"""A compliance in series: a soft holder, or a sensitivity that is off."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Literal

from pydantic import ConfigDict

from pellicle_fit.effect import Array, Fitted, Sizes, Values, Yields, fitted

_MOST = 0.3
"""Largest give over the way, at the largest force."""


class Compliance(Yields):
    """Something in series that gives way by u = cF, of either sign.

    A deflection sensitivity that is off by a share ε puts the tip wrong by ε F/k: c = ε/k.
    """

    model_config = ConfigDict(title="a compliance in series, such as a sensitivity that is off")
    type: Literal["compliance"] = "compliance"
    examples = ({}, {"compliance": "2 m/N"})
    compliance: Annotated[float, Fitted("m/N")] = fitted("compliance c [m/N]")

    def give(self, force: Array) -> Array:
        """Return cF [m]."""
        return self.compliance * force

    def limits(self, sizes: Sizes) -> Mapping[str, tuple[float, float]]:
        """Return compliances that give way by less than the solid does."""
        most = _MOST * sizes.length / sizes.force
        return {"compliance": (-most, most)}

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield a little give of either sign."""
        yield from ({"compliance": c * sizes.length / sizes.force} for c in (0.05, -0.05))
