"""A kernel for pellicle: the tensed membrane once more, as someone who only has its symbol."""

from typing import Annotated, Literal

from pydantic import Field

from pellicle import Isotropic, hookimpl
from pellicle.units import Modulus, Tension


class Skin(Isotropic):
    """Half-space under a tensed skin, known by its compliance alone."""

    type: Literal["skin"] = "skin"
    reduced_modulus: Annotated[Modulus, Field(description="reduced modulus E* [Pa]")]
    tension: Annotated[Tension, Field(description="tension [N/m]")]

    def compliance(self, q):
        """Return G(q) = 1/(E* q/2 + tension q²) [m/Pa]."""
        return 1 / (self.reduced_modulus * q / 2 + self.tension * q**2)


@hookimpl
def register_components(register):
    """Register the kernel."""
    register(Skin)
