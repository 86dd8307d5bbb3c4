"""A kernel for pellicle: a surface whose stiffness is a power of the wavenumber."""

from typing import Annotated, Literal

from pydantic import Field

from pellicle import Isotropic
from pellicle.units import Length, Modulus, Quantity


class PowerLaw(Isotropic):
    """Stiffness k ∝ qⁿ: a Winkler foundation (n = 0), a graded solid, the half-space (n = 1)."""

    type: Literal["power_law"] = "power_law"
    reduced_modulus: Annotated[Modulus, Field(description="E* felt at q = 1/length [Pa]")]
    length: Annotated[Length, Field(description="length at which E* is felt [m]")]
    exponent: Annotated[float, Quantity("1", at_least=0, at_most=2), Field(description="power n")]

    def compliance(self, q):
        """Return G(q) = 2l / (E* (ql)ⁿ) [m/Pa]."""
        return 2 * self.length / (self.reduced_modulus * (q * self.length) ** self.exponent)
