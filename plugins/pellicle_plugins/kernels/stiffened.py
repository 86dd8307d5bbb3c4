"""Any kernel of a solid, stiffer or softer by a factor."""

from __future__ import annotations

from typing import cast

from pellicle.arrays import Array
from pellicle.components import HasRelaxation, Kernel
from pellicle.surface import HasClosedForm, mean_compliance


class Stiffened(Kernel):
    """A solid whose stiffness is a multiple of another's; made by `stiffened`, not registered."""

    solid: Kernel
    factor: float

    def compliance(self, q: Array) -> Array:
        """Return the compliance of the solid over the factor [m/Pa]."""
        return self.solid.compliance(q) / self.factor

    def mean_compliance(self) -> float:
        """Return the mean compliance of the solid over the factor [m/Pa]."""
        return mean_compliance(self.solid) / self.factor


class StiffenedClosedForm(Stiffened):
    """A stiffened solid whose Green's function is known in closed form."""

    def greens_function(self, r: Array) -> Array:
        """Return the Green's function of the solid over the factor [m/N]."""
        return cast(HasClosedForm, self.solid).greens_function(r) / self.factor

    def radial_primitive(self, r: Array) -> Array:
        """Return the radial primitive of the solid over the factor [m³/N]."""
        return cast(HasClosedForm, self.solid).radial_primitive(r) / self.factor


def stiffened(solid: Kernel, factor: float) -> Kernel:
    """Return the kernel of a solid ``factor`` > 0 times as stiff, with a closed form if it has one.

    Of a kernel that relaxes, only the solid is stiffened, not the skin.
    """
    if isinstance(solid, HasRelaxation):
        return solid.scaled(factor)
    kind = StiffenedClosedForm if isinstance(solid, HasClosedForm) else Stiffened
    return kind.model_construct(solid=solid, factor=factor)
