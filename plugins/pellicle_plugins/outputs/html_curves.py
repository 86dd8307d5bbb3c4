"""Curves of the web page of a run or a study, with marks that follow its maps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pellicle import registry
from pellicle.components import Chart, Fields, Output, Runs, Table
from pellicle.results import Result, column_of, has_load, label_of_step
from pellicle.show import SIZE, Picture, PlacedSeries, figure_of, marks_of, svg

from .figures import figures_of, figures_of_study
from .step_figures import profile

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PROFILES = 16
"""Largest number of load steps whose profile is on the page."""
_CURVES = {
    "force_depth": "Force against depth over the load steps.",
    "area_force": "Contact area against force over the load steps.",
    "time": "Force, depth and contact area over time.",
}
_UNDER_LOAD = {
    "profile": "The surface along x through the centre, and the traction on it.",
    "time": "Height and width of the ridge, and depth of the dimple, over time.",
    "load": "Height and width of the ridge, and depth of the dimple, over what varies of the load.",
}


def curves_of_run(result: Result, mapped_steps: list[int], begin: int) -> list[Picture]:
    """Return the curves of a run, marked at ``chosen`` steps; the ``begin``-th is shown first."""
    if has_load(result.dataset):
        shown = [(name, figure) for name, figure in figures_of(result) if name in _UNDER_LOAD]
        return [picture(figure, _UNDER_LOAD[name]) for name, figure in shown]
    pictures = [_profiles(result, mapped_steps, begin)]
    if result.dataset.sizes["step"] > 1:
        pictures += [
            picture(figure, _CURVES[name], mapped_steps)
            for name, figure in figures_of(result)
            if name in _CURVES
        ]
    return pictures


def _profiles(result: Result, steps: list[int], begin: int) -> Picture:
    """Return the profile of a step, and those that take its place while another is mapped.

    Where many steps are mapped, some have the profile of the nearest one, as the caption says.
    """
    count = -(-len(steps) // _PROFILES)

    def of_step(index: int) -> Picture:
        label = label_of_step(result.dataset, index)
        return picture(profile(result, index), f"Pressure and gap along x, at {label}.")

    # The step whose map is shown first is drawn, and every `count`-th before and after it.
    drawn = {index: of_step(index) for index in steps[begin % count :: count]}
    frames = [drawn[min(drawn, key=lambda drawn_step: abs(drawn_step - index))] for index in steps]
    return replace(drawn[steps[begin]], by_frame=frames if len(drawn) > 1 else ())


def curves_of_study(runs: Runs) -> Iterator[Picture]:
    """Yield a figure for each variable that is drawn over a study."""
    for name, chart in figures_of_study(runs):
        words = column_of(runs.table[name]).words.capitalize()
        title = runs.table.attrs["title"]
        remarks = [line for line in chart.title.splitlines() if line != title]
        yield picture(chart, f"{', '.join([f'{words} over the study', *remarks])}.")


def curves_of_outputs(
    runs: Runs, configuration: Mapping[str, Any], mapped_steps: Sequence[int] = ()
) -> Iterator[Picture]:
    """Yield what the other outputs of a run or study show, marked at ``chosen`` steps."""
    for table in configuration.get("outputs") or ():
        output = registry().make(Output, table)
        beside = output.type_name in ("figures", "html") or type(output).charts is Output.charts
        if beside or output.scope == ("study" if runs.axes is None else "run"):
            continue
        name = getattr(output, "title", "") or getattr(output, "name", "") or output.type_name
        # The output that fails is told of as it is written.
        with suppress(Exception):
            for _, part in output.charts(runs):
                if not isinstance(part, (bytes, Table)):
                    yield picture(part, f"{name[0].upper()}{name[1:]}.", mapped_steps)


def picture(
    shown: Chart | Fields | Sequence[Chart | Fields], caption: str, marked: Sequence[int] = ()
) -> Picture:
    """Return a picture, with marks at the load steps ``marked``."""
    marks: list[list[tuple[float, float]]] = []
    drawn: list[PlacedSeries] = []
    # The page has a title, and a title may be longer than a figure is wide.
    fill, size = figure_of(shown, titled=False)

    def mark(figure: Figure) -> None:
        if marked:
            marks.extend(marks_of(figure, drawn, marked))

    drawing = svg(lambda figure: drawn.extend(fill(figure)), size, mark)
    return Picture(drawing, caption, caption, marks, wide=size[0] > SIZE[0])
