"""The bed of springs."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import ConfigDict, Field

from pellicle.arrays import Array
from pellicle.components import Isotropic
from pellicle.units import FoundationStiffness


class Winkler(Isotropic):
    """Bed of independent springs: the surface yields only where it is pressed (Winkler 1867)."""

    model_config = ConfigDict(title="Winkler foundation")

    type: Literal["winkler"] = "winkler"
    examples = ({"foundation": "100 Pa/um"},)
    foundation: FoundationStiffness = Field(
        title="foundation stiffness", description="stiffness k of the springs per area [Pa/m]"
    )

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 1/k [m/Pa], the same for every wave; Johnson 1985, section 4.3."""
        return np.full(q.shape, 1 / self.foundation)

    def mean_compliance(self) -> float:
        """Return 1/k [m/Pa]."""
        return 1 / self.foundation
