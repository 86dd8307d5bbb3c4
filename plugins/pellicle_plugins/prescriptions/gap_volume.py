"""The volume between surface and indenter."""

from __future__ import annotations

from typing import ClassVar, Literal

from pellicle.components import Depth, Force, Prescription, Search, Setting, Variable
from pellicle.contact import Equilibrium
from pellicle.errors import ConfigError
from pellicle.units import readable


class GapVolume(Prescription):
    """Volume of the gap within the domain [m³]: the sum of gaps times the area of a cell."""

    type: Literal["gap_volume"] = "gap_volume"
    examples = ({},)
    unit: ClassVar[str] = "m3"
    at_least: ClassVar[float | None] = 0.0
    is_zero_at_rest: ClassVar[bool] = False
    variables: ClassVar[tuple[Variable, ...]] = (
        Variable("gap_volume", "m3", "volume between surface and indenter within the domain"),
        Variable("residual_gap_volume", "1", "relative error of the gap volume", "residual"),
    )

    def check(self, setting: Setting, value: float) -> None:
        """Refuse a volume larger than that at first touch."""
        most = _at_first_touch(setting)
        if most == float("inf"):
            raise ConfigError(
                "is not defined for an indenter that does not fill its domain: the gap beside it "
                "has no end; prescribe depth or force",
                "loading.gap_volume",
            )
        if value > most:
            raise ConfigError(
                f"{readable(value, self.unit)} is before first touch, where the volume is "
                f"{readable(most, self.unit)}; give less"
            )

    def target(self, setting: Setting, value: float) -> Search:
        """Return the search for the force with this volume of the gap."""
        return Search(
            value,
            _volume,
            control=Depth if setting.sticks else Force,
            increasing=False,
            resolution=1e-9 * (value or _at_first_touch(setting)),
            quantity="gap volume",
            unit="m3",
        )

    def report(self, setting: Setting, step: Equilibrium) -> dict[str, float]:
        """Return the volume of the gap."""
        return {"gap_volume": _volume(step)}


def _at_first_touch(setting: Setting) -> float:
    return (float(setting.profile.max()) - setting.mean_height) * setting.grid.area


def _volume(step: Equilibrium) -> float:
    return float(step.gap.sum()) * step.problem.grid.cell_area
