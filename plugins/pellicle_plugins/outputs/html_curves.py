"""Curves of the web page of a run or a study, with marks that follow its maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pellicle.components import Chart, Fields
from pellicle.results.path import label_of_step
from pellicle.results.result import Result
from pellicle.results.wording import wording
from pellicle.show import Picture, figures, profile, svg
from pellicle.show.drawing import draw, marks_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_PROFILES = 16
"""Largest number of load steps whose profile is on the page."""
_CURVES = {
    "force_depth": "Force against depth over the load steps.",
    "area_force": "Contact area against force over the load steps.",
    "time": "Force, depth and contact area over time.",
}


def curves_of_run(result: Result, chosen: list[int], begin: int) -> list[Picture]:
    """Return the curves of a run, marked at ``chosen`` steps; the ``begin``-th is shown first."""
    pictures = [_profiles(result, chosen, begin)]
    if result.dataset.sizes["step"] > 1:
        drawn = figures(result)
        pictures += [
            _picture(drawn[name], caption, chosen)
            for name, caption in _CURVES.items()
            if name in drawn
        ]
    return pictures


def _profiles(result: Result, chosen: list[int], begin: int) -> Picture:
    """Return the profile of a step, and those that take its place while another is mapped.

    Where many steps are mapped, some have the profile of the nearest one, as the caption says.
    """
    count = -(-len(chosen) // _PROFILES)

    def picture(index: int) -> Picture:
        label = label_of_step(result.dataset, index)
        return _picture(profile(result, index), f"Pressure and gap along x, at {label}.")

    # The step whose map is shown first is drawn, and every `count`-th before and after it.
    drawn = {index: picture(index) for index in chosen[begin % count :: count]}
    frames = [drawn[min(drawn, key=lambda drawn_step: abs(drawn_step - index))] for index in chosen]
    return replace(drawn[chosen[begin]], by_frame=frames if len(drawn) > 1 else ())


def curves_of_study(table: xr.Dataset) -> list[Picture]:
    """Return a figure for each variable that is drawn over a study."""
    return [
        _picture(chart, f"{wording(table[name]).words.capitalize()} over the study.")
        for name, chart in figures(table).items()
    ]


def _picture(chart: Chart | Fields, caption: str, marked: Sequence[int] = ()) -> Picture:
    """Return a picture, with marks at the load steps ``marked``."""
    marks: list[list[tuple[float, float]]] = []

    def fill(figure: Figure) -> None:
        # The page has a title, and a title may be longer than a figure is wide.
        drawn = draw(figure, replace(chart, title=""))
        if marked:
            marks.extend(marks_of(figure, drawn, marked))

    return Picture(svg(fill), caption, caption, marks)
