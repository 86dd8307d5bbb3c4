"""The displacement of a base that holds the indenter by a spring, such as a cantilever."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from pellicle.components import Depth, Prescription, Setting, Variable
from pellicle.contact import Equilibrium
from pellicle.units import Quantity


class BaseDisplacement(Prescription):
    """Displacement z [m] of a base that holds the indenter by a spring: F = k (z − δ)."""

    type: Literal["base_displacement"] = "base_displacement"
    examples = ({"spring_constant": "0.1 N/m"},)
    unit: ClassVar[str] = "m"
    at_least: ClassVar[float | None] = 0.0
    may_pull: ClassVar[bool] = True
    variables: ClassVar[tuple[Variable, ...]] = (
        Variable("base_displacement", "m", "displacement of the base, 0 at first touch"),
    )

    spring_constant: Annotated[
        float,
        Quantity("N/m", above=0),
        Field(description="spring constant k of the spring that holds the indenter [N/m]"),
    ]

    def target(self, setting: Setting, value: float) -> Depth:
        """Return depth control with a spring between base and indenter."""
        return Depth(value, 1 / self.spring_constant)

    def report(self, setting: Setting, step: Equilibrium) -> dict[str, float]:
        """Return the displacement of the base."""
        return {"base_displacement": step.depth + step.force / self.spring_constant}
