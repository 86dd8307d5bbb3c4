"""The force on the indenter."""

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
