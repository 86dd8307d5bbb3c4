"""Pictures of a run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pellicle import hookimpl
from pellicle.components import Output, Place
from pellicle.report.plotting import FIGURES, STUDY_FIGURES, save_figures, save_study_figures
from pellicle.results.result import Result

from .base import Formats

if TYPE_CHECKING:
    import xarray as xr


class Figures(Output):
    """Pressure map, profiles through the centre, force and area curves."""

    type: Literal["figures"] = "figures"
    formats: Formats = ("png",)

    def endings(self) -> tuple[str, ...]:
        """Return those of the figures of a run and of a study."""
        names = dict.fromkeys((*FIGURES, *STUDY_FIGURES))
        return tuple(f"-{name}.{format_}" for name in names for format_ in self.formats)

    def close(self, place: Place, result: Result) -> tuple[Path, ...]:
        """Draw the result and return the files."""
        return save_figures(result, place.directory, place.name, self.formats)

    def study(self, place: Place, table: xr.Dataset) -> tuple[Path, ...]:
        """Draw the table and return the files."""
        return save_study_figures(table, place.directory, place.name, self.formats)


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the figures."""
    register(Figures)
