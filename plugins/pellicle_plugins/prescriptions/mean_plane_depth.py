"""The depth of the mean plane of a rough surface."""

from __future__ import annotations

from typing import ClassVar, Literal

from pellicle.components import Depth, Prescription, Setting, Variable
from pellicle.contact import Equilibrium
from pellicle.errors import ConfigError
from pellicle.units import readable

from .depth import refuse_beyond_full_contact


class MeanPlaneDepth(Prescription):
    """Depth of the mean plane of the indenter's heights [m]; negative where the plane is above."""

    type: Literal["mean_plane_depth"] = "mean_plane_depth"
    examples = ({},)
    unit: ClassVar[str] = "m"
    is_zero_at_rest: ClassVar[bool] = False
    variables: ClassVar[tuple[Variable, ...]] = (
        Variable("mean_plane_depth", "m", "depth of the indenter's mean plane"),
    )

    def check(self, setting: Setting, value: float) -> None:
        """Refuse an indenter without a mean plane, and a depth that no load reaches."""
        mean = setting.mean_height
        endless = setting.grid.boundary == "free" and setting.footprint == "unbounded"
        if endless or mean == -float("inf"):
            raise ConfigError(
                "is not defined for an indenter that extends beyond a free domain, or does not "
                "fill its domain: it has no mean plane; prescribe depth",
                "loading.mean_plane_depth",
            )
        if value < mean and not setting.law:
            raise ConfigError(
                f"{readable(value, 'm')} is before first touch: this indenter's lowest point is "
                f"{readable(-mean, 'm')} below its mean plane; give {readable(mean, 'm')} or more"
            )
        refuse_beyond_full_contact(setting, value - mean, value)

    def target(self, setting: Setting, value: float) -> Depth:
        """Return the depth of the lowest point."""
        return Depth(value - setting.mean_height)

    def report(self, setting: Setting, step: Equilibrium) -> dict[str, float]:
        """Return the depth of the mean plane."""
        return {"mean_plane_depth": step.depth + setting.mean_height}
