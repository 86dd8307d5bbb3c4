"""Figures of a result or a study on matplotlib Axes, with units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.analysis import Leg, legs
from pellicle.arrays import Array, Mask
from pellicle.results.dimensions import parts
from pellicle.results.path import has_interaction, has_times
from pellicle.results.result import Result
from pellicle.results.wording import is_periodic, wording
from pellicle.variables import CONTACT_AREA, CORRECTED_AREA

from .fields import pressure_map, profile
from .leg_styles import MOST_LEGS, draw_legs, name_legs
from .saving import save_figure
from .style import MARKERS, FigureStyle, colour, is_log_spaced, is_ordered, is_seed

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_NAMED = 10
_MOST_MARKED = 80


def force_depth(result: Result, axes: Axes) -> None:
    """Draw force against depth over the load steps."""
    _curve(result, axes, {"force": None}, "depth")


def area_force(result: Result, axes: Axes) -> None:
    """Draw the contact area, of the cells and corrected, against force."""
    labels: dict[str, str | None] = {"contact_area": "cells in contact"}
    for name, variable in result.dataset.data_vars.items():
        if str(name).startswith(CORRECTED_AREA):
            labels[str(name)] = wording(variable).words.removeprefix(f"{CONTACT_AREA}, ")
    _curve(result, axes, labels, "force")
    if not has_interaction(result.dataset):
        axes.legend()


def over_time(result: Result, figure: Figure) -> None:
    """Draw force, depth and contact area against time, one above the other."""
    data = result.dataset
    panels = figure.subplots(len(_OVER_TIME), sharex=True)
    time_axis = wording(data["time"])
    good = data["converged"].values.astype(bool)
    t = data["time"].values * time_axis.scale.factor
    for axes, (name, hue) in zip(panels, _OVER_TIME.items(), strict=True):
        y_axis = wording(data[name])
        y = data[name].values * y_axis.scale.factor
        _draw_line(axes, t, y, good, None, color=hue, linestyle="-", marker="o")
        axes.set_ylabel(y_axis.head)
        axes.axhline(0.0, color="0.4", linewidth=0.6)
        axes.grid(alpha=0.3)
    panels[0].set_title(data.attrs.get("title", ""))
    panels[-1].set_xlabel(time_axis.head)
    figure.align_ylabels(panels)


_OVER_TIME = {"force": "C0", "depth": "C1", "contact_area": "C2"}
TIME = "time"
"""Suffix of the figure over time, which runs with times have."""
FIGURES: dict[str, Callable[[Result, Axes], None]] = {
    "pressure": pressure_map,
    "profile": profile,
    "force_depth": force_depth,
    "area_force": area_force,
}
"""Figures of a run on one pair of axes, by the suffix of the file name."""
STUDY_FIGURES = "force", "contact_area", "contact_fraction"
"""Variables that may be drawn for a study, which are the suffixes of the file names too."""


def save_figures(
    shown: Result | xr.Dataset,
    directory: Path,
    name: str,
    formats: Iterable[str],
    style: FigureStyle | None = None,
) -> tuple[Path, ...]:
    """Write the figures of a result, or of the table of `pellicle.run_study`; return the files.

    They are ``directory/name-figure.format``.
    """
    files: list[Path] = []
    for suffix, fill in drawings(shown).items():
        files += save_figure(fill, directory / f"{name}-{suffix}", formats, style=style)
    return tuple(files)


def drawings(shown: Result | xr.Dataset) -> dict[str, Callable[[Figure], None]]:
    """Return what fills each figure of a result or of a study's table, by the suffix of its file.

    A study has force, and contact fraction or area: a free domain has no nominal area of which the
    contact is a fraction.
    """

    def fill(draw: Callable[[Axes], None], figure: Figure) -> None:
        draw(figure.add_subplot())

    if not isinstance(shown, Result):
        area = "contact_fraction" if is_periodic(shown) else "contact_area"
        names = ("force", area) if "force" in shown else ()
        curves = {name: partial(study_curves, shown, variable=name) for name in names}
        return {name: partial(fill, draw) for name, draw in curves.items()}
    figures: dict[str, Callable[[Figure], None]] = {
        suffix: partial(fill, partial(draw, shown)) for suffix, draw in FIGURES.items()
    }
    if has_times(shown.dataset) and shown.dataset.sizes["step"] > 1:
        figures[TIME] = partial(over_time, shown)
    return figures


def study_curves(table: xr.Dataset, axes: Axes, variable: str) -> None:
    """Draw a variable of a study against the depth, one colour for each value of its first axis.

    Where steps have times, it is drawn against the time; where each run has one step only, against
    the first axis of numbers instead.
    """
    # The horizontal axis, and the dimension along which each line goes.
    dimensions = [str(d) for d in table["status"].dims if d != "step"]
    numbers = [d for d in dimensions if table[d].dtype.kind in "if" and table.sizes[d] > 1]
    over_steps = table.sizes["step"] > 1 or not numbers
    along = "step" if over_steps else numbers[0]
    against = ("time" if has_times(table) else "depth") if over_steps else along
    # Values of the first of the others have colours of their own; seeds are only repetitions.
    rest = [d for d in dimensions if d != along]
    compared = sorted(rest, key=lambda d: is_seed(table[d]) or table.sizes[d] == 1)[:1]
    stacked = [str(d) for d in table["status"].dims if d not in (along, *compared)]
    y_axis, x_axis = wording(table[variable]), wording(table[against])
    named_by = wording(table[compared[0]]) if compared else None
    many = table.sizes[compared[0]] if compared else 1
    ordered = bool(compared) and is_ordered(table, compared[0])
    pulls, paths = has_interaction(table), list[list[Leg]]()
    for number, part in enumerate(parts(table, compared)):
        hue = colour(number, many, ordered=ordered)
        marker = MARKERS[number % len(MARKERS)]
        # Of many values only some are named: colours change evenly between them.
        named = compared and number % -(-many // _MOST_NAMED) == 0
        label = named_by.text(part[compared[0]].item()) if named and named_by else ""
        for line in parts(part, stacked):
            x = line[against].values * x_axis.scale.factor
            y = line[variable].values * y_axis.scale.factor
            path, good = None, line["converged"].values
            if pulls and against == "depth":
                finished = np.isfinite(line["depth"].values)
                x, y, good = x[finished], y[finished], good[finished]
                path = legs(line["depth"].values[finished])
                paths.append(path)
            _draw_line(axes, x, y, good, path, color=hue, marker=marker, linestyle="-", label=label)
            label = ""
    axes.set(xlabel=x_axis.head, ylabel=y_axis.head, title=table.attrs.get("title", ""))
    if along != "step" and is_log_spaced(table[against].values):
        axes.set_xscale("log")
    if pulls:
        axes.axhline(0.0, color="0.4", linewidth=0.6)
        if paths:
            name_legs(axes, paths, "C0" if many == 1 else "0.4")
    else:
        axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    if compared or axes.get_legend_handles_labels()[1]:
        # matplotlib takes long to find the best place among many curves.
        axes.legend(fontsize="small", loc="upper left" if many > _MOST_NAMED else "best")


def _curve(result: Result, axes: Axes, labels: Mapping[str, str | None], against: str) -> None:
    """Draw variables, with their labels, against another over the steps of a run."""
    data = result.dataset
    y_axis, x_axis = wording(data[next(iter(labels))]), wording(data[against])
    good = data["converged"].values.astype(bool)
    pulls, path = has_interaction(data), legs(data["depth"].values)
    hysteretic = pulls or (has_times(data) and len(path) <= MOST_LEGS)
    x = data[against].values * x_axis.scale.factor
    for number, (variable, label) in enumerate(labels.items()):
        y = data[variable].values * y_axis.scale.factor
        style = {"color": f"C{number}", "linestyle": "--" if number else "-", "label": label}
        style["marker"] = "s" if number and hysteretic else "o"
        _draw_line(axes, x, y, good, path if hysteretic else None, **style)
    axes.set(xlabel=x_axis.head, ylabel=y_axis.head)
    if hysteretic:
        name_legs(axes, [path], "C0" if len(labels) == 1 else "0.4")
        if axes.get_legend_handles_labels()[1]:
            axes.legend(fontsize="small")
    if pulls:
        axes.axhline(0.0, color="0.4", linewidth=0.6)
    else:
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    axes.set_title(result.dataset.attrs.get("title", ""))
    if not good.all():
        axes.annotate("× not converged", (0.02, 0.95), xycoords="axes fraction", color="red")


def _draw_line(
    axes: Axes, x: Array, y: Array, good: Mask, path: Iterable[Leg] | None, **style: Any
) -> None:
    """Draw a line over the steps of a run, in the legs of its ``path`` if there is one.

    Red crosses lie on the steps that are not ``good``; without a path, few steps have markers.
    """
    if path is None:
        marker = style["marker"] if x.size <= _MOST_MARKED else ""
        axes.plot(x, y, mfc="white", **style | {"marker": marker, "markersize": 4})
    else:
        draw_legs(axes, path, x, y, markersize=4, **style)
    axes.plot(x[~good], y[~good], "x", color="red", markersize=9)
