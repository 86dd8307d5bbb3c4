"""Figures of a run or a study."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar, Literal

from pellicle.components import Output, Runs, Shown
from pellicle.results.result import Result
from pellicle.show import FIGURES, STUDY_FIGURES, figures, write_charts
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
        names = dict.fromkeys((*FIGURES, *STUDY_FIGURES))
        return tuple(f"-{name}.{format_}" for name in names for format_ in self.formats)

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield the figures of the result of a run, or of the table of a study."""
        shown = Result(runs.open()) if runs.axes is None else runs.table
        for name, figure in figures(shown).items():
            # Its numbers are those of the result.
            yield f"-{name}", [figure]

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figures in each format."""
        return write_charts(self.charts(runs), stem, self.formats, self.style)
