"""An indenter with its heights multiplied."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import Array
from pellicle.units import Quantity

from .transformed import Transformed, profile_of


class Scaled(Transformed):
    """Another indenter with its heights multiplied by a factor."""

    type: Literal["scaled"] = "scaled"
    factor: Annotated[
        float,
        Quantity("1", at_least=0),
        Field(
            title="height factor", examples=[0.5], description="factor of the heights; 0 is flat"
        ),
    ]

    def profile(self, x: Array, y: Array) -> Array:
        """Return factor · f [m], or −inf where f is −inf."""
        profile = profile_of(self.part, x, y, "part")
        # −inf · 0 would be NaN.
        return np.multiply(profile, self.factor, out=profile.copy(), where=np.isfinite(profile))
