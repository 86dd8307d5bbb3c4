"""A skin on any other kernel."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from pellicle.arrays import Array
from pellicle.components import (
    Branch,
    FromRegistry,
    HasRelaxation,
    HasTimeSpan,
    Kernel,
    MayBeBondedLayer,
)
from pellicle.surface import mean_compliance

from .skin import Skin
from .stiffened import stiffened


class Coated(Skin):
    """Skin with tension and bending stiffness on any other kernel.

    The stiffnesses of substrate and skin add at each wave number. This is exact if the skin
    transmits normal tractions only, as a tension does.
    """

    type: Literal["coated"] = "coated"
    substrate: Annotated[
        Kernel,
        FromRegistry(),
        Field(
            examples=[{"type": "half_space", "reduced_modulus": "10 kPa"}],
            description="the kernel under the skin: a table with type",
        ),
    ]

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 1/(1/G_s + τ₀ q² + B q⁴) [m/Pa], with G_s of the substrate."""
        substrate = self.substrate.compliance(q)
        return substrate / (1 + substrate * self.skin_stiffness(q))

    def mean_compliance(self) -> float:
        """Return G(0) of the substrate [m/Pa]: a uniform displacement does not bend the skin."""
        return mean_compliance(self.substrate)

    def branches(self) -> tuple[Branch, ...]:
        """Return the branches of the substrate: the skin is elastic."""
        return self.substrate.branches() if isinstance(self.substrate, HasRelaxation) else ()

    def time_span(self) -> tuple[float, float]:
        """Return the span of the substrate [s]; all times if it states none."""
        substrate = self.substrate
        return substrate.time_span() if isinstance(substrate, HasTimeSpan) else (0.0, math.inf)

    def scaled(self, share: float) -> Kernel:
        """Return the skin on an elastic substrate ``share`` times as stiff."""
        return self.model_copy(update={"substrate": stiffened(self.substrate, share)})

    def without_skin(self) -> Kernel:
        """Return the substrate, without any skin of its own."""
        if isinstance(self.substrate, HasRelaxation):
            return self.substrate.without_skin()
        return self.substrate

    def bonded_layer(self) -> tuple[float, float] | None:
        """Return thickness [m] and Poisson's ratio of a substrate that is a bonded layer.

        None if it is not, or if the skin resists bending.
        """
        if self.bending or not isinstance(self.substrate, MayBeBondedLayer):
            return None
        return self.substrate.bonded_layer()
