"""Curves of the web page of a run or a study, with marks that follow its maps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from pellicle.results.path import label_of_step
from pellicle.results.result import Result
from pellicle.results.wording import wording
from pellicle.show.fields import profile
from pellicle.show.html import Picture
from pellicle.show.plotting import TIME, drawings
from pellicle.show.saving import svg

from .html_tables import names_of_numbers

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_PROFILES = 16
"""Largest number of load steps whose profile is on the page."""
_CURVES = {
    "profile": "Pressure and gap along x, at {step}.",
    "force_depth": "Force against depth over the load steps.",
    "area_force": "Contact area, of the cells and corrected, against force over the load steps.",
    TIME: "Force, depth and contact area over time.",
}


def curves_of_run(result: Result, chosen: list[int], begin: int) -> list[Picture]:
    """Return the curves of a run, marked at ``chosen`` steps; the ``begin``-th is shown first."""
    fills = {name: fill for name, fill in drawings(result).items() if name in _CURVES}
    several = result.dataset.sizes["step"] > 1
    marks = partial(_marks, data=result.dataset, chosen=chosen)
    return [
        _profiles(result, chosen, begin)
        if name == "profile"
        else _picture(fill, _CURVES[name], marks)
        for name, fill in fills.items()
        if several or name == "profile"
    ]


def _profiles(result: Result, chosen: list[int], begin: int) -> Picture:
    """Return the profile of a step, and those that take its place while another is mapped.

    Where many steps are mapped, some have the profile of the nearest one, as the caption says.
    """
    count = -(-len(chosen) // _PROFILES)

    def picture(index: int) -> Picture:
        label = label_of_step(result.dataset, index)
        caption = _CURVES["profile"].format(step=label)
        return _picture(lambda figure: profile(result, figure.add_subplot(), index), caption)

    # The step whose map is shown first is drawn, and every `count`-th before and after it.
    drawn = {index: picture(index) for index in chosen[begin % count :: count]}
    frames = [drawn[min(drawn, key=lambda drawn_step: abs(drawn_step - index))] for index in chosen]
    return replace(drawn[chosen[begin]], by_frame=frames if len(drawn) > 1 else ())


def curves_of_study(table: xr.Dataset) -> list[Picture]:
    """Return a figure for each variable that is drawn over a study."""
    return [
        _picture(fill, f"{wording(table[name]).words.capitalize()} over the study.")
        for name, fill in drawings(table).items()
    ]


_Marks = list[list[tuple[float, float]]]


def _picture(
    fill: Callable[[Figure], None], caption: str, marked: Callable[[Figure], _Marks] | None = None
) -> Picture:
    """Return a picture, with the marks that ``marked`` returns for the filled figure."""
    marks: _Marks = []

    def untitled(figure: Figure) -> None:
        fill(figure)
        # The page has a title, and a title may be longer than a figure is wide.
        for axes in figure.axes:
            axes.set_title("")
        if marked:
            marks.extend(marked(figure))

    return Picture(svg(untitled), caption, caption, marks)


def _marks(figure: Figure, data: xr.Dataset, chosen: list[int]) -> _Marks:
    """Return the points of ``chosen`` steps on the curves of a figure, as shares from top left.

    The labels of axes tell which variables they show.
    """
    numbers = (data[name] for name in names_of_numbers(data))
    values = {
        shown.head: v.values[chosen] * shown.scale.factor
        for v in numbers
        for shown in (wording(v),)
    }
    across = figure.axes[-1].get_xlabel()
    marks: _Marks = [[] for _ in chosen]
    figure.draw_without_rendering()
    for axes in figure.axes:
        x, y = values.get(across), values.get(axes.get_ylabel())
        if x is None or y is None:
            continue
        pixels = axes.transData.transform(np.column_stack([x, y]))
        shares = figure.transFigure.inverted().transform(pixels)
        for points, (left, bottom) in zip(marks, shares.tolist(), strict=True):
            if np.isfinite([left, bottom]).all():
                points.append((left, 1 - bottom))
    return marks
