"""The force on the indenter, and over the area of a periodic domain."""

from __future__ import annotations

from typing import ClassVar, Literal

from pellicle.components import Force, Prescription, Setting


class NormalForce(Prescription):
    """Force on the domain [N]."""

    type: Literal["force"] = "force"
    examples = ({},)
    unit: ClassVar[str] = "N"
    at_least: ClassVar[float | None] = 0.0
    may_pull: ClassVar[bool] = True

    def target(self, setting: Setting, value: float) -> Force:
        """Return the force itself."""
        return Force(value)


class MeanPressure(Prescription):
    """Force over the area of a periodic domain [Pa]."""

    type: Literal["mean_pressure"] = "mean_pressure"
    examples = ({},)
    unit: ClassVar[str] = "Pa"
    at_least: ClassVar[float | None] = 0.0
    may_pull: ClassVar[bool] = True
    needs_period: ClassVar[bool] = True

    def target(self, setting: Setting, value: float) -> Force:
        """Return the force on one period."""
        return Force(value * setting.grid.area)
