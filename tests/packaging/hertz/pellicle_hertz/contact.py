"""The file of ``pellicle hertz``."""

from typing import Annotated

from pydantic import Field

from pellicle.schema import FromFile
from pellicle.units import Length, Modulus


class Contact(FromFile):
    """A sphere in an elastic half-space."""

    radius: Annotated[Length, Field(description="radius R [m]", examples=["5 um"])]
    reduced_modulus: Annotated[Modulus, Field(description="E* [Pa]", examples=["2 kPa"])]
    depth: Annotated[Length, Field(description="depth δ [m]", examples=["0.5 um"])]

    @property
    def force(self) -> float:
        """F = 4/3 E* √R δ^(3/2) [N]."""
        return 4 / 3 * self.reduced_modulus * self.radius**0.5 * self.depth**1.5
