"""The give of a rough tip or sample."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict

from pellicle_fit.effect import Array, Contact, Curve, Fitted, Sizes, Values, Yields, fitted


class RoughToe(Yields):
    """Asperities between a round tip and the solid, flattened by u = λ ln(1 + (F/F₁)^⅓).

    Asperities with heights that fall off exponentially over λ carry a mean pressure that grows as
    exp(u/λ), whatever each of them does (Greenwood & Tripp 1967); that of a round tip, F/πa², grows
    as F^⅓ (Hertz).
    """

    model_config = ConfigDict(title="a rough surface")
    type: Literal["rough_toe"] = "rough_toe"
    examples = ({}, {"height": "20 nm", "toe_force": "10 pN"})
    height: Annotated[float, Fitted("m", above=0, log=True)] = fitted("scale λ of the heights [m]")
    toe_force: Annotated[float, Fitted("N", above=0, log=True)] = fitted(
        "force F₁ at which they are flattened by λ ln 2 [N]"
    )

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse tips that are not round."""
        return "" if contact.tip_radius else "needs a round tip"

    def give(self, force: Array) -> Array:
        """Return λ ln(1 + (F/F₁)^⅓) [m]."""
        return self.height * np.log1p(np.cbrt(np.maximum(force, 0) / self.toe_force))

    def limits(self, sizes: Sizes) -> Mapping[str, tuple[float, float]]:
        """Return asperities that the curve flattens."""
        length, force = 0.3 * sizes.length, sizes.force
        return {"height": (1e-3 * length, length), "toe_force": (1e-6 * force, force)}

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield low and high asperities."""
        for share in (0.01, 0.1):
            yield {"height": share * sizes.length, "toe_force": 0.01 * sizes.force}
