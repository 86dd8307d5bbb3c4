"""Electrostatic attraction."""

from typing import Annotated, Literal

import numpy as np

from pellicle_fit.effect import Adds, Fitted, fitted


class Attraction(Adds):
    """Attraction −F₀ e^(−g/λ) of opposite charges over a gap g, −F₀ in contact."""

    type: Literal["attraction"] = "attraction"
    examples = ({}, {"attraction": "0.1 nN", "attraction_range": "50 nm"})
    attraction: Annotated[float, Fitted("N", at_least=0)] = fitted("force F₀ [N]")
    attraction_range: Annotated[float, Fitted("m", above=0, log=True)] = fitted("range λ [m]")

    def force(self, contact, curve, depth):
        """Return the force [N] at depths δ = −g [m]."""
        return -self.attraction * np.exp(np.minimum(depth, 0) / self.attraction_range)
