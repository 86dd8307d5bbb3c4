"""The plots of the explorer: profile, pressure, and the force curve."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models.annotations import Legend, LegendItem
from bokeh.models.sources import ColumnDataSource
from bokeh.plotting import figure

from pellicle.arrays import Array
from pellicle.units import axis_unit

from .solving import Frame

_BLUE, _GREY = "#0072B2", "#767676"


class Plots:
    """Figures of profile, pressure and force curve, and the data that they draw."""

    def __init__(self) -> None:
        self._cut, self._line, self._path = cut, line, path = [
            ColumnDataSource({name: [] for name in names.split()})
            for names in ("x surface indenter", "x pressure", "depth force")
        ]
        self.profile, self.pressure, self.force = [
            figure(height=height, sizing_mode="stretch_width", tools="pan,wheel_zoom,reset,save")
            for height in (240, 200, 260)
        ]
        for plot in (self.profile, self.pressure, self.force):
            plot.toolbar.logo = None
        surface = self.profile.line("x", "surface", source=cut, color=_BLUE, line_width=2)
        indenter = self.profile.line("x", "indenter", source=cut, color=_GREY, line_dash="dashed")
        names: dict[str, Any] = {"surface": surface, "indenter": indenter}
        items = [LegendItem(label=name, renderers=[line]) for name, line in names.items()]
        # Above the plot, where it covers no line.
        legend = Legend(items=items, orientation="horizontal", border_line_alpha=0.0)
        self.profile.add_layout(legend, "above")
        self.pressure.line("x", "pressure", source=line, color=_BLUE, line_width=2)
        self.force.line("depth", "force", source=path, color=_BLUE, line_width=2)
        self.force.scatter("depth", "force", source=path, color=_BLUE, size=6)

    def draw(self, frame: Frame) -> None:
        """Draw the load steps of a run, and a cut along x at the largest force."""
        cut, line = frame.section, frame.line
        x, surface, gap = cut["x"].values, -cut["displacement"].values, cut["gap"].values
        pressure = line["pressure"].values
        indenter = surface + np.maximum(np.where(np.isfinite(gap), gap, np.nan), 0.0)
        depth, force = frame.steps["depth"].values, frame.steps["force"].values
        per_x = _label("x", x, "m", self.profile.xaxis, self.pressure.xaxis)
        per_height = _label("height", np.append(surface, indenter), "m", self.profile.yaxis)
        per_pressure = _label("pressure", pressure, "Pa", self.pressure.yaxis)
        per_depth = _label("depth", depth, "m", self.force.xaxis)
        per_force = _label("force", force, "N", self.force.yaxis)
        self._cut.data = {
            "x": x * per_x,
            "surface": surface * per_height,
            "indenter": indenter * per_height,
        }
        self._line.data = {"x": line["x"].values * per_x, "pressure": pressure * per_pressure}
        self._path.data = {"depth": depth * per_depth, "force": force * per_force}


def _label(label: str, values: Array, unit: str, *axes: Any) -> float:
    """Label axes with a unit that suits values in SI; return the factor to that unit."""
    factor, name = axis_unit(values, unit)
    for axis in axes:
        axis.axis_label = f"{label} [{name}]"
    return factor
