"""The depth of the indenter."""

from __future__ import annotations

from typing import ClassVar, Literal

from pellicle.components import Depth, Prescription, Setting
from pellicle.errors import ConfigError
from pellicle.units import readable


class IndenterDepth(Prescription):
    """Depth of the indenter's lowest point [m] below the undeformed surface; 0 at first touch.

    On a periodic grid whose mean displacement is 0, as for a half-space, it is measured from the
    mean plane of the surface.
    """

    type: Literal["depth"] = "depth"
    examples = ({},)
    unit: ClassVar[str] = "m"
    at_least: ClassVar[float | None] = 0.0
    may_pull: ClassVar[bool] = True

    def check(self, setting: Setting, value: float) -> None:
        """Refuse a depth that no load reaches."""
        refuse_beyond_full_contact(setting, value, value)

    def target(self, setting: Setting, value: float) -> Depth:
        """Return the depth itself."""
        return Depth(value)


def refuse_beyond_full_contact(setting: Setting, depth: float, value: float) -> None:
    """Refuse a ``depth`` [m] that no load reaches; ``value`` [m] is what the user prescribed."""
    mean = setting.mean_height
    if depth >= -mean and not setting.operator.has_mean_compliance:
        raise ConfigError(
            f"{readable(value, 'm')} is beyond full contact: on a periodic grid the depth is "
            f"measured from the mean plane, and this indenter's is {readable(-mean, 'm', 4)} above "
            "its lowest point, at any load; give less, or prescribe mean_pressure"
        )
