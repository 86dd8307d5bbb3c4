"""Fields along a line through the centre, of several runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

import numpy as np
from pydantic import Field

from pellicle.arrays import DataArray, Dataset
from pellicle.components import Axis, Chart, Look, Runs, Series, Shown, Table
from pellicle.results import as_array, has_interaction
from pellicle.schema import names_in
from pellicle.show import with_rim
from pellicle.variables import FIELDS, WALL_PRESSURE
from pellicle_plugins.validation.reference import exact_line

from .base import Reference, TableFigure, XLabel, YLabel, axis_of

_ACROSS = {"x": "y", "y": "x"}
_MARKERS = 90


class Profiles(TableFigure):
    """Fields along x or y through the centre, one curve for each value of an axis.

    Other axes of a study are at their first value, steps at the last. ``x`` and
    ``y`` are arithmetic over the fields and numbers of each run; the numbers drawn are written as
    CSV beside the figure.
    """

    type: Literal["profiles"] = "profiles"
    examples = ({"by": "step", "label": "{depth * 1e6} µm", "reference": "axisymmetric"},)
    along: Literal["x", "y"] = Field("x", description="direction of the line")
    x_label: XLabel = None
    y_label: YLabel = None
    x: str | None = Field(
        None, description="expression for the horizontal axis; the position if absent"
    )
    y: str = Field("pressure", description="expression for the vertical axis")
    reference: Reference = None

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield the curves, and their numbers in the cells."""
        across = _ACROSS[self.along]
        lines = [(n, run.isel({across: run.sizes[across] // 2})) for n, run in self.steps(runs)]
        series, rows = list[Series](), list[tuple[object, ...]]()
        for number, (name, line) in enumerate(lines):
            x, y = self._columns(line)
            rows += [(name.key, "run", *point) for point in zip(x.values, y.values, strict=True)]
            look, shown = Look(number, number), line
            if self._fields() == {"pressure"} and not has_interaction(line):
                shown = with_rim(line)
            if self.reference:
                # Cells on both sides of the centre alike, without those whose place the rim takes.
                marked = np.isin(line[self.along], shown[self.along])
                marked[np.arange(x.size) % max(1, x.size // _MARKERS) > 0] = False
                x, y = x[marked], y[marked]
                look = Look(number, None, number)
            else:
                x, y = self._columns(shown)
            # At a rim that sticks the pressure has a peak in single cells.
            in_cells = has_interaction(line) and self._fields() & {"pressure", WALL_PRESSURE}
            profile = Series(x.values, y.values, legend=name.words, look=look)
            series.append(replace(profile, stepped="mid") if in_cells else profile)
            if self.reference:
                x, y = self._columns(exact_line(line))
                is_last = number == len(lines) - 1
                legend, look = "semi-analytic" if is_last else "", Look(None)
                series.append(
                    Series(x.values, y.values, legend=legend, look=look, role="reference")
                )
                points = zip(x.values, y.values, strict=True)
                rows += [(name.key, "semi-analytic", *point) for point in points]
        x_axis, y_axis = Axis(""), Axis("")
        if lines:
            x_axis = axis_of(self.x or self.along, self.x_label, lines[0][1])
            y_axis = axis_of(self.y, self.y_label, lines[0][1])
        hues, ordered = len(lines), self.is_ordered(runs)
        yield "", Table.of_rows(("curve", "series", "x", "y"), rows)
        yield "", Chart(x_axis, [y_axis], series, self.title, hues=hues, ordered=ordered)

    def _fields(self) -> set[str]:
        return (names_in(self.x or self.along) | names_in(self.y)) & {*FIELDS, WALL_PRESSURE}

    def _columns(self, line: Dataset) -> tuple[DataArray, DataArray]:
        """Return x and y along a line, each with a value for every point."""
        import xarray as xr

        x, y = (as_array(text, line) for text in (self.x or self.along, self.y))
        x, y = (xr.DataArray(0.0 * line[self.along] + axis, attrs=axis.attrs) for axis in (x, y))
        return x, y
