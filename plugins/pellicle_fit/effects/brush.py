"""A polymer brush in series with the solid."""

from typing import Annotated, Literal

import numpy as np

from pellicle_fit.effect import Array, Fitted, Yields, fitted


class Brush(Yields, title="a brush"):
    """Polymer brush on the solid, compressed by u under F = F₁ (exp(2πu/L) − 1).

    The force on a brush of length L falls with what is left of it as exp(−2π(L − u)/L) (Alexander
    1977; Butt et al. 1999).
    """

    type: Literal["brush"] = "brush"
    examples = ({}, {"brush_length": "100 nm", "brush_force": "50 pN"})
    # Brushes that a curve does not compress are linear springs.
    brush_length: Annotated[
        float, Fitted("m", above=0, log=True, starts=(0.05, 0.3, 1.0), limits=(3e-3, 3.0))
    ] = fitted("length L of the brush [m]")
    brush_force: Annotated[
        float, Fitted("N", above=0, log=True, starts=(0.05,), limits=(1e-4, 1.0))
    ] = fitted("force F₁ that compresses it by L ln 2/2π [N]")

    def give(self, force: Array) -> Array:
        """Return L/2π ln(1 + F/F₁) [m]."""
        return self.brush_length / (2 * np.pi) * np.log1p(np.maximum(force, 0) / self.brush_force)
