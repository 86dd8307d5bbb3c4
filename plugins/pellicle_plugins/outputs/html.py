"""A self-contained web page of a run or a study."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
import tomli_w
from pydantic import Field

from pellicle import Grid, Run, registry
from pellicle.components import Output, Runs
from pellicle.config.describe import inputs
from pellicle.errors import StorageError
from pellicle.files import atomic_write
from pellicle.results import storage
from pellicle.results.derived import FIRST_RUN
from pellicle.results.path import has_interaction, label_of_step, prescribed_variable
from pellicle.results.result import Result, first_message
from pellicle.results.wording import wording
from pellicle.show.drawing import DIVERGING
from pellicle.show.fields import default_step, without_round_off
from pellicle.show.html import Code, Notice, Picture, Section, Text, page
from pellicle.show.maps import Field as MapField
from pellicle.show.maps import Frame, Maps, frame, side
from pellicle.studies.summary import caveats, failures, progress_of, reasons, run_names, runs_of
from pellicle.variables import FIELDS as RESULT_FIELDS
from pellicle.variables import WALL_PRESSURE

from .html_curves import curves_of_outputs, curves_of_run, curves_of_study, picture
from .html_tables import (
    input_table,
    inputs_of_study,
    origin_tables,
    oscillation_tables,
    path_tables,
    run_table,
    step_tables,
    study_path_tables,
)
from .methods import methods
from .sentences import aim_of_path, range_of_path, sentence_of_step, sentence_of_study
from .step_figures import cross_section

if TYPE_CHECKING:
    import xarray as xr

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
    examples = ({"points": 8, "frames": 1},)
    shares_stem: ClassVar[bool] = True
    points: Annotated[
        int,
        Field(
            ge=8,
            le=4096,
            description="largest number of pixels along each side of a map; with more cells or "
            "many maps, a pixel is the mean over a block, as the page states",
        ),
    ] = 512
    frames: Annotated[
        int,
        Field(
            ge=1,
            description="largest number of load steps of a run, or runs of a study, that are "
            "mapped; of more, evenly spaced ones up to the last",
        ),
    ] = 64

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
            varied = tuple(str(name) for name in table.coords if name != "step")
            sections = self._sections_of_study(runs, run, varied, stem.parent / "runs")
        sections += [
            Section("Methods", [Text(methods(run, table.attrs, varied))]),
            Section("Provenance", [*origin_tables(table.attrs, run)]),
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
        """Return what the page of a run shows before methods and provenance."""
        data = result.dataset
        maps, chosen = self._maps_of_steps(result)
        step_shown = default_step(data) % data.sizes["step"]
        first, label = sentence_of_step(data, step_shown), label_of_step(data, step_shown)
        setup = _setup(data.isel(step=step_shown), configuration, label)
        aim = aim_of_path(data, result.path_summary)
        lead, rest = (aim, first) if aim else (first, range_of_path(data))
        sentences = [Text(lead, lead=True), *([Text(rest)] if rest else [])]
        tables, off = step_tables(data), data["contact_area"].values == 0
        if off.any() and not off.all():
            (apart, *_), (*of_contact, _) = (step_tables(data.isel(step=s)) for s in (off, ~off))
            apart = replace(apart, caption="Results of the steps out of contact.", folded=True)
            tables = [*of_contact, apart, tables[-1]]
        numbers = [*tables, *path_tables(result), *oscillation_tables(result)]
        return [
            Section("In short", [*sentences, _status(result)]),
            Section("Maps", [maps]),
            Section("Curves", curves_of_run(result, chosen, maps.begin)),
            Section("Outputs", [*curves_of_outputs(runs, _outputs(configuration), chosen)]),
            Section("Numbers", numbers),
            Section("Set-up", [setup, input_table(list(inputs(configuration, Run)))]),
        ]

    def _sections_of_study(
        self, runs: Runs, first_run: dict[str, Any], varied: tuple[str, ...], folder: Path
    ) -> list[Section]:
        """Return what the page of a study shows before methods and provenance.

        ``folder`` holds the files of its runs.
        """
        table = runs.table
        rows = list(runs_of(table))
        frames, setups = dict[int, Frame](), list[Picture]()
        mapped = _mapped(table)
        for index, step, label, points in self._steps_of_runs(table, rows, folder):
            frames[index] = _frame(
                label, Result(step).grid, without_round_off(step), mapped, points
            )
            if not setups:
                setups.append(_setup(step, first_run, label))
        sentence = sentence_of_study(table, len(rows))
        lead = [Text(sentence, lead=True)] if sentence else []
        failed, warnings = failures(table), [*caveats(table)]
        if failed:
            details = [*reasons(table), *warnings]
            status = Notice(f"{failed[0].upper()}{failed[1:]}.", False, details)
        else:
            converged = f"Every step of all {len(rows)} runs converged."
            status = Notice(converged, None if warnings else True, warnings)
        of_runs = _share_in_words(len(frames), len(rows), "run")
        caption = f"The last step in contact of {of_runs}, each in colours over its own range."
        maps = Maps(caption, "run", tuple(mapped.values()), list(frames.values()))
        of_study = inputs_of_study(table, list(inputs(first_run, Run)))
        numbers = [run_table(table, rows, list(frames)), *study_path_tables(table, rows)]
        return [
            Section("In short", [*lead, status]),
            Section("Maps", [maps] if frames else []),
            Section("Curves", [*curves_of_study(runs)]),
            Section("Outputs", [*curves_of_outputs(runs, _outputs(first_run))]),
            Section("Numbers", numbers),
            Section("Set-up", [*setups[:1], input_table(of_study)]),
        ]

    def _maps_of_steps(self, result: Result) -> tuple[Maps, list[int]]:
        """Return the maps of load steps, and the indices of the steps."""
        data, grid = result.dataset, result.grid
        steps = data.sizes["step"]
        chosen = self._chosen(steps)
        mapped = _mapped(data)
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
        *first, last = [f"{field.name}" for field in mapped.values()]
        names = f"{', '.join(first)} and {last}".capitalize()
        words = wording(data[prescribed_variable(data)]).words
        # Over the range of the last step the first ones would have one colour.
        colours = ", each in colours over its own range" if len(chosen) > 1 else ""
        shown_steps = _share_in_words(len(chosen), steps, "load step")
        caption = f"{names} at prescribed {words}, in {shown_steps}{colours}."
        return Maps(caption, "load step", tuple(mapped.values()), frames, max(begin, 0)), chosen

    def _steps_of_runs(
        self, table: xr.Dataset, rows: list[xr.Dataset], folder: Path
    ) -> Iterator[tuple[int, xr.Dataset, str, int]]:
        """Yield the mapped step of each run: index among all, fields, name, and pixels a side."""
        import xarray as xr

        mapped, names_of_runs = _mapped(table), run_names(table)
        solved = [index for index, row in enumerate(rows) if progress_of(row)[0]]
        chosen = self._chosen(len(solved))
        points = side(self.points, len(chosen) * len(mapped))
        for index in (solved[number] for number in chosen):
            row = rows[index].isel(step=slice(progress_of(rows[index])[0]))
            step_shown = default_step(row) % row.sizes["step"]
            sticks = has_interaction(row) and bool(np.isfinite(row["zone_area"].values[step_shown]))
            names = (*RESULT_FIELDS, *[WALL_PRESSURE] * sticks)
            try:
                # Read only the step that is drawn.
                attributes, fields = storage.fields(
                    folder / f"{row['run'].item()}.h5", names, step_shown
                )
            except StorageError:
                continue
            step = xr.Dataset(
                {name: (("x", "y"), field) for name, field in zip(names, fields, strict=True)},
                attrs=attributes,
            ).assign(depth=row["depth"][step_shown])
            if not sticks:
                step = step.assign({WALL_PRESSURE: step["pressure"]})
            x, y = Result(step).grid.coordinates()
            step = step.assign_coords(x=x[:, 0], y=y[0])
            yield index, step, names_of_runs[index], points

    def _chosen(self, count: int) -> list[int]:
        """Return the indices that are mapped: all, or evenly spaced ones up to the last."""
        number = min(count, self.frames)
        return [(count * (index + 1) + number - 1) // number - 1 for index in range(number)]


def _mapped(data: xr.Dataset) -> dict[str, MapField]:
    """Return the fields that are mapped, by variable."""
    return _STICKING if has_interaction(data) else FIELDS


def _frame(
    label: str, grid: Grid, step: xr.Dataset, mapped: dict[str, MapField], points: int
) -> Frame:
    signed = any(field.centred for field in mapped.values())
    empty = [index for index, field in enumerate(mapped.values()) if signed and field.blank]
    return frame(label, grid, [step[name].values for name in mapped], points, empty)


def _share_in_words(number: int, count: int, noun: str) -> str:
    """Return how many are shown in words: "each run", "3 of 8 runs"."""
    return f"each {noun}" if number == count else f"{number} of {count} {noun}s"


def _setup(step: xr.Dataset, configuration: dict[str, Any], label: str) -> Picture:
    """Return the indenter over the surface in a load step."""
    values = {i.name: i.value for i in inputs(configuration, Run)}
    caption = f"The {values['indenter']} on the {values['kernel']}, at {label}; heights stretched."
    return picture(cross_section(step), caption)


def _outputs(configuration: dict[str, Any]) -> list[Output]:
    """Return the outputs that a configuration names."""
    return [registry().make(Output, output) for output in configuration.get("outputs") or ()]


def _status(result: Result) -> Notice:
    total = result.planned_steps
    done, failed = result.dataset.sizes["step"], result.failures()
    sentences = []
    if done < total:
        sentences.append(f"The run ended early: {done} of {total} load steps are finished.")
    count = "The load step" if done == 1 else f"All {done} load steps"
    bad = f"{len(failed)} of {done} load steps did not converge: do not rely on them."
    sentences.append(bad if failed else f"{count} converged.")
    details = [f"Step {step}: {message}" for step, message in failed]
    for phrase, steps in result.caveats_by_phrase().items():
        sentences.append(f"In {len(steps)} of {done} {phrase}.")
        details.append(f"S{first_message(steps)[1:]}")
    for subject, message in result.beyond_theory().items():
        sentences.append(f"{subject[0].upper()}{subject[1:]}.")
        details.append(f"S{message[1:]}")
    is_good = None if details else True
    return Notice(" ".join(sentences), is_good if done == total and not failed else False, details)


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
