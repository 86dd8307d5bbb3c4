"""The plots of the explorer: the profile, the pressure and the force curve of a frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from bokeh.models.annotations.legends import Legend, LegendItem
from bokeh.models.sources import ColumnDataSource
from bokeh.plotting import figure

from pellicle.report.lines import edge_cells
from pellicle.report.style import OKABE_ITO
from pellicle.units import axis_unit

from .frames import Frame
from .measured import Measured

_BLUE, _ORANGE, _GREY = *OKABE_ITO[:2], "#767676"


class Plots:
    """Figures of profile, pressure and force curve, and the data that they draw."""

    def __init__(self, measured: Measured | None) -> None:
        self._measured = measured
        self._cut = ColumnDataSource(
            {"x": [], "surface": [], "indenter": [], "pressure": [], "edge": []}
        )
        self._path = ColumnDataSource({"depth": [], "force": []})
        self._curve = ColumnDataSource({"depth": [], "force": []})
        self._profile, self._pressure, self._force = (
            figure(height=height, sizing_mode="stretch_width", tools="pan,wheel_zoom,reset,save")
            for height in (240, 200, 260)
        )
        self.figures = {
            "profile": self._profile,
            "pressure": self._pressure,
            "force": self._force,
        }
        self._add_lines()
        for plot in self.figures.values():
            plot.toolbar.logo = None
            plot.toolbar_location = "right"

    def _add_lines(self) -> None:
        cut, path = self._cut, self._path
        surface = self._profile.line("x", "surface", source=cut, color=_BLUE, line_width=2)
        indenter = self._profile.line("x", "indenter", source=cut, color=_GREY, line_dash="dashed")
        _name_lines(self._profile, {"surface": surface, "indenter": indenter})
        self._pressure.line("x", "pressure", source=cut, color=_BLUE, line_width=2)
        self._pressure.scatter("x", "edge", source=cut, color=_BLUE, size=4)
        computed = self._force.line("depth", "force", source=path, color=_BLUE, line_width=2)
        self._force.scatter("depth", "force", source=path, color=_BLUE, size=6)
        if self._measured is not None:
            measured = self._force.line(
                "depth",
                "force",
                source=self._curve,
                color=_ORANGE,
                line_width=2,
                line_dash="dotted",
            )
            _name_lines(self._force, {"computed": computed, "measured": measured})

    def draw(self, frame: Frame, share: float) -> None:
        """Draw a frame, and the measured curve with its contact point at a share of its range.

        Cells at the edge of contact are dots: their pressure depends on where it passes them.
        """
        heights = np.append(frame.surface, frame.indenter)
        x, height, pressure = (
            axis_unit(values, unit)
            for values, unit in ((frame.x, "m"), (heights, "m"), (frame.pressure, "Pa"))
        )
        depth, force = axis_unit(frame.depth, "m"), axis_unit(frame.force, "N")
        edge = edge_cells(frame.pressure > 0) & bool(frame.pressure.min() >= 0)
        self._cut.data = {
            "x": frame.x * x[0],
            "surface": frame.surface * height[0],
            "indenter": frame.indenter * height[0],
            "pressure": np.where(edge, np.nan, frame.pressure) * pressure[0],
            "edge": np.where(edge, frame.pressure, np.nan) * pressure[0],
        }
        self._path.data = {"depth": frame.depth * depth[0], "force": frame.force * force[0]}
        if self._measured is not None:
            self._curve.data = {
                "depth": self._measured.depth(share) * depth[0],
                "force": self._measured.force * force[0],
            }
        _label(self._profile, f"x [{x[1]}]", f"height [{height[1]}]")
        _label(self._pressure, f"x [{x[1]}]", f"pressure [{pressure[1]}]")
        _label(self._force, f"depth [{depth[1]}]", f"force [{force[1]}]")


def _label(plot: Any, x: str, y: str) -> None:
    plot.xaxis.axis_label, plot.yaxis.axis_label = x, y


def _name_lines(plot: Any, lines: Mapping[str, Any]) -> None:
    """Put the names of lines above a plot, where they cover none."""
    items = [LegendItem(label=name, renderers=[line]) for name, line in lines.items()]
    plot.add_layout(Legend(items=items, orientation="horizontal", border_line_alpha=0.0), "above")
