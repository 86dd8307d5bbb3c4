"""A polymer brush in series with the solid."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict

from pellicle_fit.effect import Array, Fitted, Sizes, Values, Yields, fitted


class Brush(Yields):
    """Polymer brush on the solid, compressed by u under F = F₁ (exp(2πu/L) − 1).

    The force on a brush of length L falls with what is left of it as exp(−2π(L − u)/L) (Alexander
    1977; Butt et al. 1999).
    """

    model_config = ConfigDict(title="a brush")
    type: Literal["brush"] = "brush"
    examples = ({}, {"brush_length": "100 nm", "brush_force": "50 pN"})
    brush_length: Annotated[float, Fitted("m", above=0, log=True)] = fitted(
        "length L of the brush [m]"
    )
    brush_force: Annotated[float, Fitted("N", above=0, log=True)] = fitted(
        "force F₁ that compresses it by L ln 2/2π [N]"
    )

    def give(self, force: Array) -> Array:
        """Return L/2π ln(1 + F/F₁) [m]."""
        return self.brush_length / (2 * np.pi) * np.log1p(np.maximum(force, 0) / self.brush_force)

    def limits(self, sizes: Sizes) -> Mapping[str, tuple[float, float]]:
        """Return brushes that the curve compresses; others are linear springs."""
        length, force = 3 * sizes.length, sizes.force
        return {"brush_length": (1e-3 * length, length), "brush_force": (1e-4 * force, force)}

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield brushes from a thin one to one as long as the way, that yield early."""
        for share in (0.05, 0.3, 1.0):
            yield {"brush_length": share * sizes.length, "brush_force": 0.05 * sizes.force}
