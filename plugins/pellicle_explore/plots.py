"""The plots of the explorer: profile, pressure, and the force curve beside a measured one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.models.annotations import Legend, LegendItem
from bokeh.models.sources import ColumnDataSource
from bokeh.plotting import figure

import pellicle as pl
from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.units import axis_unit

from .solving import Frame

_BLUE, _ORANGE, _GREY = "#0072B2", "#D55E00", "#767676"


def read_measured(path: Path) -> pl.Measurement:
    """Return the only force curve of a file, without the rows that lack a number."""
    curve, *others = pl.read_curves(path).values()
    if others:
        raise ConfigError(f"holds {1 + len(others)} curves; give a file with one", "--curve")
    rows = np.isfinite(curve.position) & np.isfinite(curve.force)
    if np.unique(curve.position[rows]).size < 2:
        raise ConfigError("has no two positions with a force; give a curve that moves", "--curve")
    return replace(curve, position=curve.position[rows], force=curve.force[rows])


def _touch(curve: pl.Measurement) -> float:
    """Return the share of the positions at which the force has risen by 5 % of its range."""
    position = (curve.position - curve.position.min()) / np.ptp(curve.position)
    start = np.median(curve.force[position <= 0.1])
    above = curve.force > start + 0.05 * (curve.force.max() - start)
    return float(position[above].min(initial=1.0))


class Plots:
    """Figures of profile, pressure and force curve, and the data that they draw."""

    def __init__(self, measured: pl.Measurement | None) -> None:
        self._measured = measured
        self.share = _touch(measured) if measured else 0.0
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
        """Draw the load steps of a run, and a cut along x at the largest force."""
        cut, line = frame.cut, frame.line
        x, surface, gap = cut["x"].values, -cut["displacement"].values, cut["gap"].values
        pressure = line["pressure"].values
        indenter = surface + np.maximum(np.where(np.isfinite(gap), gap, np.nan), 0.0)
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
