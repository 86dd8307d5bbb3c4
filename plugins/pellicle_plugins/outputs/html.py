"""A self-contained web page of a run or a study."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import tomli_w
from pydantic import Field

from pellicle import Grid, Run
from pellicle.arrays import Dataset
from pellicle.components import Output, Runs, Table
from pellicle.config.describe import FieldRow, inputs
from pellicle.errors import StorageError
from pellicle.files import atomic_write
from pellicle.results.derived import FIRST_RUN
from pellicle.results.path import has_interaction, label_of_step
from pellicle.results.result import Result
from pellicle.results.runs import axes_of, progress_of, runs_of
from pellicle.show import tables
from pellicle.show.drawing import DIVERGING
from pellicle.show.fields import default_step, without_round_off
from pellicle.show.html import Code, Notice, Picture, Section, Text, page
from pellicle.show.maps import Field as MapField
from pellicle.show.maps import Frame, Maps, frame, side
from pellicle.show.methods import methods
from pellicle.show.sentences import (
    aim_of_path,
    caption_of_runs,
    caption_of_setup,
    caption_of_steps,
    range_of_path,
    run_names,
    sentence_of_step,
    sentence_of_study,
    status_of_run,
    status_of_study,
)
from pellicle.variables import WALL_PRESSURE

from .html_curves import curves_of_outputs, curves_of_run, curves_of_study, picture
from .step_figures import cross_section

FIELDS = {
    "pressure": MapField("contact pressure", "Pa", blank=True),
    "gap": MapField("gap", "m", "Blues", power=0.5),
}
"""The variables that are mapped."""
_STICKING = {
    "pressure": MapField("pressure", "Pa", DIVERGING, blank=True, centred=True),
    WALL_PRESSURE: MapField("wall pressure", "Pa", blank=True),
    "gap": FIELDS["gap"],
}
"""The variables that are mapped where there is an interaction."""


class Html(Output):
    """Web page of a run or a study: status, numbers, zoomable maps, figures, inputs, provenance.

    It is one file that loads nothing, so it can be kept, sent and viewed without a network. For a
    study it shows the last step of each run.
    """

    type: Literal["html"] = "html"
    examples = ({}, {"points": 8, "frames": 1})
    shares_stem: ClassVar[bool] = True
    points: int = Field(
        512,
        ge=8,
        le=4096,
        description="largest number of pixels along each side of a map; with more cells or "
        "many maps, a pixel is the mean over a block, as the page states",
    )
    frames: int = Field(
        64,
        ge=1,
        description="largest number of load steps of a run, or runs of a study, that are "
        "mapped; of more, evenly spaced ones up to the last",
    )

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffix of the page."""
        return (".html",)

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the page."""
        table, path = runs.table, Path(f"{stem}.html")
        configuration = json.loads(runs.configuration)
        varied: tuple[str, ...] = ()
        if runs.axes is None:
            run = configuration
            sections = self._sections_of_run(Result(runs.open()), run, runs)
        else:
            run = json.loads(table.attrs[FIRST_RUN])
            varied = tuple(axes_of(table))
            sections = self._sections_of_study(runs, run)
        sections += [
            Section("Methods", [Text(methods(run, table.attrs, varied))]),
            Section("Provenance", tables.origin(table.attrs, inputs(run, Run))),
            Section("How to reproduce it", [*_reproduce(configuration, stem)]),
        ]
        date = table.attrs["date"].replace("T", " ").replace("+00:00", " UTC")
        kind = "Run" if runs.axes is None else "Study"
        with atomic_write(path) as part:
            text = page(table.attrs["title"] or stem.name, sections, f"{kind} of pellicle, {date}")
            part.write_text(text, encoding="utf-8")
        return (path,)

    def _sections_of_run(
        self, result: Result, configuration: dict[str, Any], runs: Runs
    ) -> list[Section]:
        data = result.dataset
        maps, chosen = self._maps_of_steps(result)
        step_shown = default_step(data) % data.sizes["step"]
        first, label = sentence_of_step(data, step_shown), label_of_step(data, step_shown)
        section = cross_section(data.isel(step=step_shown))
        setup = picture(section, caption_of_setup(configuration, label))
        aim = aim_of_path(data, result.path_summary)
        lead, rest = (aim, first) if aim else (first, range_of_path(data))
        sentences = [Text(lead, lead=True), *([Text(rest)] if rest else [])]
        of_steps, off = tables.all_steps(data), data["contact_area"].values == 0
        if off.any() and not off.all():
            apart, *_ = tables.all_steps(data.isel(step=off))
            apart = replace(apart, caption="Results of the steps out of contact.", folded=True)
            of_steps = [*tables.all_steps(data.isel(step=~off))[:-1], apart, of_steps[-1]]
        numbers = [*tables.path(data), *of_steps, *tables.oscillations(data)]
        return [
            Section("In short", [*sentences, Notice(*status_of_run(result))]),
            Section("Maps", [maps]),
            Section("Curves", curves_of_run(result, chosen, maps.begin)),
            Section("Outputs", [*curves_of_outputs(runs, configuration, chosen)]),
            Section("Numbers", numbers),
            Section("Set-up", [setup, _inputs(inputs(configuration, Run))]),
        ]

    def _sections_of_study(self, runs: Runs, first_run: dict[str, Any]) -> list[Section]:
        table = runs.table
        rows, names_of_runs = list(runs_of(table)), run_names(table)
        frames, setups = dict[int, Frame](), list[Picture]()
        mapped = _STICKING if has_interaction(table) else FIELDS
        solved = [index for index, row in enumerate(rows) if progress_of(row)[0]]
        chosen = self._chosen(len(solved))
        points = side(self.points, len(chosen) * len(mapped))
        for index in (solved[number] for number in chosen):
            try:
                run = runs.open(rows[index]["run"].item())
            except StorageError:
                continue
            step, label = run.isel(step=default_step(run)), names_of_runs[index]
            if WALL_PRESSURE not in step:
                step = step.assign({WALL_PRESSURE: step["pressure"]})
            shown = without_round_off(step)
            frames[index] = _frame(label, Result(step).grid, shown, mapped, points)
            if not setups:
                caption = caption_of_setup(first_run, label)
                setups.append(picture(cross_section(step), caption))
        sentence = sentence_of_study(table, len(rows))
        lead = [Text(sentence, lead=True)] if sentence else []
        caption = caption_of_runs(table, len(frames))
        maps = Maps(caption, "run", tuple(mapped.values()), list(frames.values()))
        of_runs = tables.runs(table, mapped=list(frames))
        numbers = [of_runs, *tables.paths_of_runs(table)]
        given = tables.inputs_of_study(table, inputs(first_run, Run))
        return [
            Section("In short", [*lead, Notice(*status_of_study(table))]),
            Section("Maps", [maps] if frames else []),
            Section("Curves", [*curves_of_study(runs)]),
            Section("Outputs", [*curves_of_outputs(runs, first_run)]),
            Section("Numbers", numbers),
            Section("Set-up", [*setups, _inputs(given)]),
        ]

    def _maps_of_steps(self, result: Result) -> tuple[Maps, list[int]]:
        """Return the maps of load steps, and the indices of the steps."""
        data, grid = result.dataset, result.grid
        steps = data.sizes["step"]
        chosen = self._chosen(steps)
        mapped = _STICKING if has_interaction(data) else FIELDS
        points = side(self.points, len(chosen) * len(mapped))
        frames = []
        for index in chosen:
            step = without_round_off(data.isel(step=index))
            label = f"{index + 1}: {label_of_step(data, index)}"
            label += "" if step["converged"].item() else ", NOT CONVERGED"
            note = sentence_of_step(data, index)
            frames.append(replace(_frame(label, grid, step, mapped, points), note=note))
        step_shown = default_step(data) % steps
        begin = int(np.searchsorted(chosen, step_shown, side="right")) - 1
        names = [field.name for field in mapped.values()]
        caption = caption_of_steps(data, names, len(chosen))
        return Maps(caption, "load step", tuple(mapped.values()), frames, max(begin, 0)), chosen

    def _chosen(self, count: int) -> list[int]:
        """Return the indices that are mapped: all, or evenly spaced ones up to the last."""
        number = min(count, self.frames)
        return [(count * (index + 1) + number - 1) // number - 1 for index in range(number)]


def _frame(
    label: str, grid: Grid, step: Dataset, mapped: dict[str, MapField], points: int
) -> Frame:
    signed = any(field.centred for field in mapped.values())
    empty = [index for index, field in enumerate(mapped.values()) if signed and field.blank]
    return frame(label, grid, [step[name].values for name in mapped], points, empty)


def _inputs(fields: Iterable[FieldRow]) -> Table:
    caption = "All inputs that determine the result, defaults included."
    return tables.inputs((i for i in fields if not i.name.startswith("outputs.")), caption)


def _reproduce(configuration: dict[str, Any], stem: Path) -> Iterator[Code]:
    name, folder = f"{stem.name}.toml", stem.parent.resolve().name or stem.name
    given = "with the units that were given; numbers without one are"
    units = given if "study" in configuration else ""
    yield Code(tomli_w.dumps(configuration), f"The whole configuration, {units} in SI.", name)
    yield Code(
        f"pellicle run {shlex.quote(name)} -o {shlex.quote(folder)}",
        "With that file in the current folder, and the files that it names at their paths; their "
        "content is compared with its hash where the configuration has one:",
    )
