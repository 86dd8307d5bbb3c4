"""Depths of the indenter, of its mean plane, and of what holds it by a spring."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from pellicle.components import Depth, Prescription, Setting, Variable
from pellicle.contact import Equilibrium
from pellicle.errors import ConfigError
from pellicle.units import Quantity, readable


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
        _refuse_beyond_full_contact(setting, value, value)

    def target(self, setting: Setting, value: float) -> Depth:
        """Return the depth itself."""
        return Depth(value)


def _refuse_beyond_full_contact(setting: Setting, depth: float, value: float) -> None:
    """Refuse a ``depth`` [m] that no load reaches; ``value`` [m] is what the user prescribed."""
    mean = setting.mean_height
    if depth >= -mean and not setting.operator.has_mean_compliance:
        raise ConfigError(
            f"{readable(value, 'm')} is beyond full contact: on a periodic grid the depth is "
            f"measured from the mean plane, and this indenter's is {readable(-mean, 'm', 4)} above "
            "its lowest point, at any load; give less, or prescribe mean_pressure"
        )


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
        if value < mean and not setting.sticks:
            raise ConfigError(
                f"{readable(value, 'm')} is before first touch: this indenter's lowest point is "
                f"{readable(-mean, 'm')} below its mean plane; give {readable(mean, 'm')} or more"
            )
        _refuse_beyond_full_contact(setting, value - mean, value)

    def target(self, setting: Setting, value: float) -> Depth:
        """Return the depth of the lowest point."""
        return Depth(value - setting.mean_height)

    def report(self, setting: Setting, step: Equilibrium) -> dict[str, float]:
        """Return the depth of the mean plane."""
        return {"mean_plane_depth": step.depth + setting.mean_height}


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

    spring_constant: Annotated[float, Quantity("N/m", above=0)] = Field(
        description="spring constant k of the spring that holds the indenter [N/m]"
    )

    def target(self, setting: Setting, value: float) -> Depth:
        """Return depth control with a spring between base and indenter."""
        return Depth(value, 1 / self.spring_constant)

    def report(self, setting: Setting, step: Equilibrium) -> dict[str, float]:
        """Return the displacement of the base."""
        return {"base_displacement": step.depth + step.force / self.spring_constant}
