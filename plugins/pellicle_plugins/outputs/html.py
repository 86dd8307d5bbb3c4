"""A self-contained web page of a run or a study."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import tomli_w
from pydantic import Field

from pellicle import show
from pellicle.arrays import Dataset
from pellicle.components import Output, Runs
from pellicle.errors import StorageError
from pellicle.files import atomic_write
from pellicle.results import (
    Result,
    axes_of,
    configuration_of,
    has_interaction,
    has_load,
    label_of_step,
    progress_of,
    runs_of,
)
from pellicle.show import DIVERGING, Code, Frame, Maps, Notice, Picture, Section, Text
from pellicle.variables import WALL_PRESSURE

from .html_curves import curves_of_outputs, curves_of_run, curves_of_study, picture
from .html_sentences import (
    aim_of_path,
    caption_of_runs,
    caption_of_steps,
    range_of_path,
    sentence_of_step,
    sentence_of_study,
)
from .step_figures import cross_section

_FIELDS = {
    "pressure": show.Field("contact pressure", "Pa", blank=True),
    "gap": show.Field("gap", "m", "Blues", power=0.5),
}
"""The variables that are mapped."""
_STICKING = {
    "pressure": show.Field("pressure", "Pa", DIVERGING, blank=True, centred=True),
    WALL_PRESSURE: show.Field("wall pressure", "Pa", blank=True),
    "gap": _FIELDS["gap"],
}
"""The variables that are mapped where there is an interaction."""
_UNDER_LOAD = {
    "displacement": show.Field("displacement", "m", DIVERGING, centred=True),
    "pressure": show.Field("traction", "Pa", DIVERGING, blank=True, centred=True),
}
"""The variables that are mapped under a load."""


class Html(Output):
    """Web page of a run or a study: status, numbers, zoomable maps, figures, inputs, provenance.

    It is one file that loads nothing, so it can be kept, sent and viewed without a network. For a
    study it shows the last step of each run.
    """

    type: Literal["html"] = "html"
    examples = ({}, {"points": 8, "frames": 1})
    shares_stem: ClassVar[bool] = True
    suffixes: ClassVar[tuple[str, ...]] = (".html",)
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

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the page."""
        table, path = runs.table, Path(f"{stem}.html")
        configuration = json.loads(runs.configuration)
        kind, run, varied = "Run", configuration, list[str]()
        if runs.axes is None:
            sections = self._sections_of_run(Result(runs.open()), run, runs)
        else:
            kind, run, varied = "Study", configuration_of(table), axes_of(table)
            sections = self._sections_of_study(runs, run)
        sections += [
            Section("Methods", [Text(show.methods(run, table.attrs, tuple(varied)))]),
            Section("Provenance", show.tables.origin(table.attrs, run)),
            Section("How to reproduce it", [*_reproduce(configuration, stem)]),
        ]
        date = table.attrs["date"].replace("T", " ").replace("+00:00", " UTC")
        with atomic_write(path) as part:
            text = show.page(
                table.attrs["title"] or stem.name, sections, f"{kind} of pellicle, {date}"
            )
            part.write_text(text, encoding="utf-8")
        return (path,)

    def _sections_of_run(
        self, result: Result, configuration: dict[str, Any], runs: Runs
    ) -> list[Section]:
        data = result.dataset
        maps, mapped_steps = self._maps_of_steps(result)
        step_shown = show.default_step(data) % data.sizes["step"]
        first = sentence_of_step(data, step_shown)
        label = label_of_step(data, step_shown)
        section = cross_section(data.isel(step=step_shown))
        setup = picture(section, show.sentences.caption_of_setup(configuration, label))
        aim = aim_of_path(data, result.path_summary)
        opening, rest = (aim, first) if aim else (first, range_of_path(data))
        in_short = [Text(opening, lead=True), *([Text(rest)] if rest else [])]
        of_steps, off = show.tables.all_steps(data), np.zeros(1, dtype=bool)
        if not has_load(data):
            off = data["contact_area"].values == 0
        if off.any() and not off.all():
            apart, *_ = show.tables.all_steps(data.isel(step=off))
            apart = replace(apart, caption="Results of the steps out of contact.", folded=True)
            of_steps = [*show.tables.all_steps(data.isel(step=~off))[:-1], apart, of_steps[-1]]
        numbers = [*show.tables.path(data), *of_steps, *show.tables.oscillations(data)]
        return [
            Section("In short", [*in_short, Notice(*show.sentences.status_of_run(result))]),
            Section("Maps", [maps]),
            Section("Curves", curves_of_run(result, mapped_steps, maps.begin)),
            Section("Outputs", [*curves_of_outputs(runs, configuration, mapped_steps)]),
            Section("Numbers", numbers),
            Section("Set-up", [setup, show.tables.inputs_of_run(configuration)]),
        ]

    def _sections_of_study(self, runs: Runs, first_run: dict[str, Any]) -> list[Section]:
        table = runs.table
        rows, names_of_runs = list(runs_of(table)), show.sentences.run_names(table)
        frames, setups = dict[int, Frame](), list[Picture]()
        solved = [index for index, row in enumerate(rows) if progress_of(row)[0]]
        mapped_runs, mapped, frame_of = self._mapped(table, len(solved))
        for index in (solved[number] for number in mapped_runs):
            try:
                run = runs.open(rows[index]["run"].item())
            except StorageError:
                continue
            step, label = run.isel(step=show.default_step(run)), names_of_runs[index]
            if WALL_PRESSURE not in step:
                step = step.assign({WALL_PRESSURE: step["pressure"]})
            frames[index] = frame_of(label, step)
            if not setups:
                caption = show.sentences.caption_of_setup(first_run, label)
                setups.append(picture(cross_section(step), caption))
        sentence = sentence_of_study(table, len(rows))
        opening = [Text(sentence, lead=True)] if sentence else []
        caption = caption_of_runs(table, len(frames))
        maps = Maps(caption, "run", mapped, list(frames.values()))
        numbers = [show.tables.runs(table, mapped=list(frames)), *show.tables.paths_of_runs(table)]
        return [
            Section("In short", [*opening, Notice(*show.sentences.status_of_study(table))]),
            Section("Maps", [maps] if frames else []),
            Section("Curves", [*curves_of_study(runs)]),
            Section("Outputs", [*curves_of_outputs(runs, first_run)]),
            Section("Numbers", numbers),
            Section("Set-up", [*setups, show.tables.inputs_of_run(first_run, table)]),
        ]

    def _maps_of_steps(self, result: Result) -> tuple[Maps, list[int]]:
        """Return the maps of load steps, and the indices of the steps."""
        data, steps, frames = result.dataset, result.dataset.sizes["step"], []
        indices, mapped, frame_of = self._mapped(data, steps)
        for index in indices:
            step = data.isel(step=index)
            label = f"{index + 1}: {label_of_step(data, index)}"
            label += "" if step["converged"].item() else ", NOT CONVERGED"
            note = sentence_of_step(data, index)
            frames.append(replace(frame_of(label, step), note=note))
        begin = int(np.searchsorted(indices, show.default_step(data) % steps, side="right")) - 1
        names = [field.name for field in mapped]
        caption = caption_of_steps(data, names, len(indices))
        return Maps(caption, "load step", mapped, frames, max(begin, 0)), indices

    def _mapped(
        self, data: Dataset, count: int
    ) -> tuple[list[int], tuple[show.Field, ...], Callable[[str, Dataset], Frame]]:
        """Return which of ``count`` steps or runs are mapped, the fields, and what maps a step.

        All are, or evenly spaced ones up to the last.
        """
        number = min(count, self.frames)
        fields = _STICKING if has_interaction(data) else _FIELDS
        fields = _UNDER_LOAD if has_load(data) else fields
        points = show.side(self.points, number * len(fields))
        signed = any(field.centred for field in fields.values())
        empty = [index for index, field in enumerate(fields.values()) if signed and field.blank]

        def frame_of(label: str, step: Dataset) -> Frame:
            shown = show.without_round_off(step)
            values = [shown[name].values for name in fields]
            return show.frame(label, Result(step).grid, values, points, empty)

        indices = [(count * (index + 1) + number - 1) // number - 1 for index in range(number)]
        return indices, tuple(fields.values()), frame_of


def _reproduce(configuration: dict[str, Any], stem: Path) -> Iterator[Code]:
    name, folder = f"{stem.name}.toml", stem.parent.resolve().name or stem.name
    with_units = "with the units that were given; numbers without one are"
    units = with_units if "study" in configuration else ""
    yield Code(tomli_w.dumps(configuration), f"The whole configuration, {units} in SI.", name)
    yield Code(
        f"pellicle run {shlex.quote(name)} -o {shlex.quote(folder)}",
        "With that file in the current folder, and the files that it names at their paths; their "
        "content is compared with its hash where the configuration has one:",
    )
