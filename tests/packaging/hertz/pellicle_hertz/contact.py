"""The file of ``pellicle hertz``."""

from typing import Annotated

from pydantic import Field

from pellicle.schema import FromFile
from pellicle.units import Length, Modulus


class Contact(FromFile):
    """A sphere in an elastic half-space."""

    examples = ({"radius": "5 um", "reduced_modulus": "2 kPa", "depth": "0.5 um"},)
    radius: Annotated[Length, Field(description="radius R [m]")]
    reduced_modulus: Annotated[Modulus, Field(description="E* [Pa]")]
    depth: Annotated[Length, Field(description="depth δ [m]")]

    @property
    def force(self) -> float:
        """F = 4/3 E* √R δ^(3/2) [N]."""
        return 4 / 3 * self.reduced_modulus * self.radius**0.5 * self.depth**1.5
