"""Fields along a line through the centre, of several runs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle.components import Runs
from pellicle.results.derived import as_array
from pellicle.results.path import has_interaction
from pellicle.schema.expression import names_in
from pellicle.show.fields import EDGE_CELLS, edge_cells
from pellicle.show.style import LINES, MARKERS, colour
from pellicle_plugins.validation.reference import exact_line

from .base import Reference, XYFigure, add_legend, scaled, set_scales

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_ACROSS = {"x": "y", "y": "x"}
_MARKERS = 90


class Profiles(XYFigure):
    """Fields along x or y through the centre, one curve for each value of an axis.

    Other axes of a study are at their first value, steps at the last. ``x`` and
    ``y`` are arithmetic over the fields and numbers of each run; the numbers drawn are written as
    CSV beside the figure.
    """

    type: Literal["profiles"] = "profiles"
    examples = ({"by": "step", "label": "{depth * 1e6} µm", "reference": "axisymmetric"},)
    along: Annotated[Literal["x", "y"], Field(description="direction of the line")] = "x"
    x: Annotated[
        str | None, Field(description="expression for the horizontal axis; the position if absent")
    ] = None
    y: Annotated[str, Field(description="expression for the vertical axis")] = "pressure"
    reference: Reference = None

    def draw(self, axes: Axes, runs: Runs) -> Iterator[dict[str, object]]:
        """Draw the curves, and yield the rows of the numbers drawn."""
        across = _ACROSS[self.along]
        lines = [(n, run.isel({across: run.sizes[across] // 2})) for n, run in self.steps(runs)]
        curves = [(name, line, *self._columns(line)) for name, line in lines]
        factors = [1.0, 1.0]
        if curves:
            # Units that suit all curves.
            xs, ys, line = [c[2] for c in curves], [c[3] for c in curves], lines[0][1]
            factors[0], x_label = scaled(self.x or self.along, xs, self.x_label, line)
            factors[1], y_label = scaled(self.y, ys, self.y_label, line)
            axes.set(xlabel=x_label, ylabel=y_label, title=self.title)
        shows_pressure = "pressure" in names_in(self.y)
        ordered, marked = self.is_ordered(runs), False
        for number, (name, line, x, y) in enumerate(curves):
            hue = colour(number, len(curves), ordered=ordered)
            drawn_x, drawn_y = x.values * factors[0], y.values * factors[1]
            contact = line["contact"].values
            edge = edge_cells(contact & (shows_pressure and not has_interaction(line)))
            marked |= bool(edge.any())
            axes.plot(drawn_x[edge], drawn_y[edge], ".", color=hue, markersize=3)
            drawn_y, style = np.where(edge, np.nan, drawn_y), {"color": hue, "linewidth": 1.2}
            every, line_or_marker = 1, LINES[number % len(LINES)]
            if self.reference:
                # Cells on both sides of the centre alike.
                every, line_or_marker = max(1, x.size // _MARKERS), MARKERS[number % len(MARKERS)]
                style |= {"markersize": 3.5, "markerfacecolor": "white"}
            label = name.words or None
            axes.plot(drawn_x[::every], drawn_y[::every], line_or_marker, label=label, **style)
            yield from _rows(name.key, "run", x, y)
            if self.reference:
                x, y = self._columns(exact_line(line))
                drawn_x, drawn_y = x.values * factors[0], y.values * factors[1]
                axes.plot(drawn_x, drawn_y, color="black", linewidth=0.8, zorder=1)
                yield from _rows(name.key, "semi-analytic", x, y)
        if self.reference:
            axes.plot([], [], color="black", linewidth=0.8, label="semi-analytic")
        if marked:
            axes.plot([], [], ".", color="0.4", markersize=3, label=EDGE_CELLS)
        set_scales(axes, ())
        add_legend(axes)

    def _columns(self, line: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
        """Return x and y along a line, each with a value for every point."""
        import xarray as xr

        x, y = (as_array(text, line) for text in (self.x or self.along, self.y))
        x, y = (xr.DataArray(0.0 * line[self.along] + axis, attrs=axis.attrs) for axis in (x, y))
        return x, y


def _rows(curve: str, series: str, x: xr.DataArray, y: xr.DataArray) -> Iterator[dict[str, object]]:
    for px, py in zip(x.values, y.values, strict=True):
        yield {"curve": curve, "series": series, "x": px, "y": py}
