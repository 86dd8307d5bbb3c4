"""Figures of a run or a study."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import prod
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from pellicle.analysis import legs
from pellicle.arrays import DataArray, Dataset
from pellicle.components import Axis, Chart, Fields, Look, Output, Runs, Series
from pellicle.results import (
    Result,
    StoredRuns,
    column_of,
    has_interaction,
    has_load,
    has_times,
    is_periodic,
    is_seed,
    prescribed_variable,
)
from pellicle.show import FigureStyle, write_charts
from pellicle.variables import CONTACT_AREA, CORRECTED_AREA

from .base import MOST_LEGS, Formats, StyleField
from .curves import MOST_PANELS, Curves
from .step_figures import load_profile, pressure_map, profile

_MOST_NAMED = 10
_ALIKE = 10.0
"""Ratio of the times that runs take up to which one axis shows all."""
_OVER_TIME = "force", "depth", "contact_area"
_OF_LOAD = "ridge_height", "dimple_depth", "ridge_width"
FIGURES = "pressure", "profile", "force_depth", "area_force", "time", "load"
"""Figures of a run, which are the suffixes of the file names too."""
STUDY_FIGURES = "force", "contact_area", "contact_fraction", *_OF_LOAD
"""Variables that may be drawn for a study, which are the suffixes of the file names too."""


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
        names = *FIGURES, *STUDY_FIGURES
        return tuple(f"-{name}.{format_}" for name in names for format_ in self.formats)

    def charts(self, runs: Runs) -> Iterator[tuple[str, Chart | Fields]]:
        """Return the figures of the result of a run, or of the table of a study."""
        is_run = runs.axes is None
        shown = figures_of(Result(runs.open())) if is_run else figures_of_study(runs)
        return ((f"-{name}", figure) for name, figure in shown)

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figures in each format."""
        # Their numbers are those of the result.
        alone = ((suffix, [figure]) for suffix, figure in self.charts(runs))
        return write_charts(alone, stem, self.formats, self.style)


def figures_of(result: Result) -> Iterator[tuple[str, Chart | Fields]]:
    """Yield each figure of a run with its suffix; with times there is one over them."""
    yield "pressure", pressure_map(result)
    if has_load(result.dataset):
        yield "profile", load_profile(result)
        if result.dataset.sizes["step"] > 1:
            yield "time" if has_times(result.dataset) else "load", over_path(result)
        return
    yield "profile", profile(result)
    yield "force_depth", force_depth(result)
    yield "area_force", area_force(result)
    if has_times(result.dataset) and result.dataset.sizes["step"] > 1:
        yield "time", over_time(result)


def figures_of_study(runs: Runs) -> Iterator[tuple[str, Chart]]:
    """Yield each figure of a study with its variable: force, and contact fraction or area.

    A free domain has no nominal area of which the contact is a fraction.
    """
    area = "contact_fraction" if is_periodic(runs.table) else "contact_area"
    names = _OF_LOAD if has_load(runs.table) else ("force", area)
    for name in names if "force" in runs.table else ():
        yield name, study_curves(runs, name)


def force_depth(result: Result) -> Chart:
    """Return force against depth over the load steps."""
    return _curves(result, {"force": ""}, "depth")


def area_force(result: Result) -> Chart:
    """Return the contact area, counted over cells and corrected, against force."""
    corrected = {
        str(name): column_of(variable).words.removeprefix(f"{CONTACT_AREA}, ")
        for name, variable in result.dataset.data_vars.items()
        if str(name).startswith(CORRECTED_AREA)
    }
    counted = "counted over cells" if corrected else ""
    return _curves(result, {"contact_area": counted} | corrected, "force")


def over_time(result: Result) -> Chart:
    """Return force, depth and contact area against time, one above the other."""
    data = result.dataset
    series = [
        replace(_series(data, "time", name, Look(number, marker=0)), panel=number)
        for number, name in enumerate(_OVER_TIME)
    ]
    axes = [_axis(data[name], signed=True) for name in _OVER_TIME]
    return Chart(_axis(data["time"]), axes, series, data.attrs["title"], hues=len(_OVER_TIME))


def over_path(result: Result) -> Chart:
    """Return height, depth and width of the surface against the time or what varies of a load."""
    data, series = result.dataset, list[Series]()
    x = "time" if has_times(data) else prescribed_variable(data)
    for number, name in enumerate(_OF_LOAD):
        curve = _series(data, x, name, Look(number, number))
        series.append(replace(curve, legend=column_of(data[name]).words, panel=number // 2))
    axes = [Axis("height, depth", "m", limits=(0.0, None)), _axis(data["ridge_width"])]
    return Chart(_axis(data[x]), axes, series, data.attrs["title"], heights=(2, 1), hues=3)


def study_curves(runs: Runs, variable: str) -> Chart:
    """Return a variable of a study against the depth, one colour for each value of its first axis.

    Where steps have times of one magnitude, it is shown against the time; where each run has one
    step only, against its longest axis of numbers. Seeds only repeat runs, of which the mean is
    drawn, and further axes have panels. The title says which values are left out.
    """
    table = runs.table
    varied = [str(d) for d in table["status"].dims if d != "step" and table.sizes[d] > 1]
    axes = sorted(varied, key=lambda axis: is_seed(table[axis]))
    numbers = [axis for axis in axes if table[axis].dtype.kind in "if"]
    x = depth = prescribed_variable(table) if has_load(table) else "depth"
    if has_times(table):
        ends = table["time"].max("step")
        x = "time" if ends.max() <= _ALIKE * ends.min() else depth
    if table.sizes["step"] == 1 and numbers:
        x = max(numbers, key=lambda axis: (not is_seed(table[axis]), table.sizes[axis]))
    rest = [axis for axis in axes if axis != x]
    seeds = [axis for axis in rest[1:] if is_seed(table[axis])][:1]
    remarks = [table.attrs["title"]]
    for axis in rest[:1]:
        if (count := table.sizes[axis]) > _MOST_NAMED:
            table = table.isel({axis: slice(None, None, -(-count // _MOST_NAMED))})
            selection = f"{table.sizes[axis]} of {count} values"
            remarks.append(f"{selection} of {column_of(table[axis]).words}")
    panels = [axis for axis in rest[1:] if axis not in seeds]
    while prod(table.sizes[axis] for axis in panels) > MOST_PANELS:
        axis = panels.pop()
        remarks.append(column_of(table[axis]).text(table[axis].values[0].item()))
        table = table.isel({axis: 0})
    title = "\n".join(filter(None, remarks))
    curves = Curves(x=x, y=variable, by=rest[:1], over=(*seeds, None)[0], title=title)
    ((_, chart),) = curves.charts(StoredRuns(table, runs.open, runs.configuration))
    assert isinstance(chart, Chart)
    start = None if has_interaction(table) else 0.0
    return replace(chart, y=[replace(axis, limits=(start, None)) for axis in chart.y])


def _curves(result: Result, labels: dict[str, str], against: str) -> Chart:
    """Return variables, with their labels, against another over the steps of a run."""
    data = result.dataset
    pulls, path = has_interaction(data), legs(data["depth"].values)
    told = path if pulls or (has_times(data) and len(path) <= MOST_LEGS) else ()
    series = [
        replace(_series(data, against, name, Look(n, n, n)), legend=label, legs=told)
        for n, (name, label) in enumerate(labels.items())
    ]
    first = next(iter(labels))
    x, y = _axis(data[against], signed=pulls), _axis(data[first], signed=pulls)
    return Chart(x, [y], series, data.attrs["title"], hues=len(labels))


def _series(data: Dataset, x: str, y: str, look: Look) -> Series:
    """Return one variable of the steps of a run against another."""
    good = data["converged"].values.astype(bool)
    points = data[x].values.astype(float), data[y].values.astype(float)
    steps = np.arange(good.size, dtype=np.int64)
    return Series(*points, name=y, look=look, converged=good, steps=steps)


def _axis(variable: DataArray, *, signed: bool = False) -> Axis:
    unit = str(variable.attrs.get("units", "1"))
    start = None if signed else 0.0
    return Axis(column_of(variable).words, unit, limits=(start, None), signed=signed)
