"""Figures of a run or a study."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, Literal

from pellicle.components import Output, Runs
from pellicle.results.result import Result
from pellicle.show.plotting import FIGURES, STUDY_FIGURES, TIME, save_figures
from pellicle.show.style import FigureStyle

from .base import Formats, StyleField


class Figures(Output):
    """Pressure map, profiles through the centre, force and area curves, also over time."""

    type: Literal["figures"] = "figures"
    examples = ({},)
    shares_stem: ClassVar[bool] = True
    formats: Formats = ("png",)
    style: StyleField = FigureStyle()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the figures of a run and of a study."""
        names = dict.fromkeys((*FIGURES, TIME, *STUDY_FIGURES))
        return tuple(f"-{name}.{format_}" for name in names for format_ in self.formats)

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Draw the result of a run, or the table of a study."""
        shown = Result(runs.open()) if runs.axes is None else runs.table
        return save_figures(shown, stem.parent, stem.name, self.formats, self.style)
