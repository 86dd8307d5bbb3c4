"""The plots of the explorer: the profile, the pressure and the force curve of a run."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models.annotations import Legend, LegendItem
from bokeh.models.sources import ColumnDataSource
from bokeh.plotting import figure

import pellicle as pl
from pellicle.arrays import Array
from pellicle.show import with_rim
from pellicle.units import axis_unit

from .measured import touch
from .solving import Frame

_BLUE, _ORANGE, _GREY = "#0072B2", "#D55E00", "#767676"


class Plots:
    """Figures of profile, pressure and force curve, and the data that they draw."""

    def __init__(self, measured: pl.Curve | None) -> None:
        self._measured = measured
        self.share = touch(measured) if measured else 0.0
        self._per_depth = self._per_force = 1.0
        self._cut, self._line, self._path, self._curve = cut, line, path, curve = [
            ColumnDataSource({name: [] for name in names.split()})
            for names in ("x surface indenter", "x pressure", "depth force", "depth force")
        ]
        self.profile, self.pressure, self.force = [
            figure(height=height, sizing_mode="stretch_width", tools="pan,wheel_zoom,reset,save")
            for height in (240, 200, 260)
        ]
        for plot in (self.profile, self.pressure, self.force):
            plot.toolbar.logo = None
        surface = self.profile.line("x", "surface", source=cut, color=_BLUE, line_width=2)
        indenter = self.profile.line("x", "indenter", source=cut, color=_GREY, line_dash="dashed")
        _name_lines(self.profile, surface=surface, indenter=indenter)
        self.pressure.line("x", "pressure", source=line, color=_BLUE, line_width=2)
        computed = self.force.line("depth", "force", source=path, color=_BLUE, line_width=2)
        self.force.scatter("depth", "force", source=path, color=_BLUE, size=6)
        if measured is not None:
            laid_over = self.force.line("depth", "force", source=curve, color=_ORANGE)
            laid_over.glyph.update(line_width=2, line_dash="dotted")
            _name_lines(self.force, computed=computed, measured=laid_over)

    def shift(self, share: float) -> None:
        """Put the contact point of the measured curve at a share of its range."""
        self.share, curve = share, self._measured
        if curve is not None:
            start = curve.position.min() + share * np.ptp(curve.position)
            self._curve.data = {
                "depth": (curve.position - start) * self._per_depth,
                "force": curve.force * self._per_force,
            }

    def draw(self, frame: Frame) -> None:
        """Draw the load steps of a run, and a cut along x through its deepest point.

        The cut is at the largest force.
        """
        deepest = frame.largest["displacement"].max("x").argmax("y")
        cut = frame.largest.isel(y=int(deepest))
        x, surface = cut["x"].values, -cut["displacement"].values
        line = with_rim(cut) if cut["pressure"].values.min() >= 0 else cut
        pressure = line["pressure"].values
        indenter = surface + np.maximum(cut["gap"].where(np.isfinite).values, 0.0)
        depth, force = frame.steps["depth"].values, frame.steps["force"].values
        per_x = _label("x", x, "m", self.profile.xaxis, self.pressure.xaxis)
        per_height = _label("height", np.append(surface, indenter), "m", self.profile.yaxis)
        per_pressure = _label("pressure", pressure, "Pa", self.pressure.yaxis)
        self._per_depth = _label("depth", depth, "m", self.force.xaxis)
        self._per_force = _label("force", force, "N", self.force.yaxis)
        self._cut.data = {
            "x": x * per_x,
            "surface": surface * per_height,
            "indenter": indenter * per_height,
        }
        self._line.data = {"x": line["x"].values * per_x, "pressure": pressure * per_pressure}
        self._path.data = {"depth": depth * self._per_depth, "force": force * self._per_force}
        self.shift(self.share)


def _label(label: str, values: Array, unit: str, *axes: Any) -> float:
    """Label axes with a unit that suits values in SI; return the factor to that unit."""
    factor, name = axis_unit(values, unit)
    for axis in axes:
        axis.axis_label = f"{label} [{name}]"
    return factor


def _name_lines(plot: Any, **lines: Any) -> None:
    """Put the names of lines above a plot, where they cover none."""
    items = [LegendItem(label=name, renderers=[line]) for name, line in lines.items()]
    plot.add_layout(Legend(items=items, orientation="horizontal", border_line_alpha=0.0), "above")
