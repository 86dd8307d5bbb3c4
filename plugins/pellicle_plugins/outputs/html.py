"""A self-contained web page of a run or a study."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
import tomli_w
from pydantic import Field

from pellicle import Grid, hookimpl
from pellicle.components import Output, Runs
from pellicle.config.describe import Input, inputs
from pellicle.errors import StorageError
from pellicle.files import atomic_write
from pellicle.report.fields import (
    DIVERGING,
    default_step,
    draws_contact,
    profile,
    without_round_off,
)
from pellicle.report.page import (
    Cell,
    Code,
    Column,
    Frame,
    Maps,
    Notice,
    Picture,
    Section,
    Table,
    Text,
    frame,
    page,
    side,
)
from pellicle.report.page import Field as MapField
from pellicle.report.plotting import TIME, drawings, study_curves, study_figures
from pellicle.report.saving import svg
from pellicle.results import storage
from pellicle.results.derived import FIRST_RUN
from pellicle.results.path import has_interaction, label_of_step, prescribed_variable
from pellicle.results.result import Result, first_message
from pellicle.results.shape import means_something
from pellicle.results.status import Status
from pellicle.results.variables import FIELDS as RESULT_FIELDS
from pellicle.results.variables import VARIABLES, WALL_PRESSURE, names_of
from pellicle.results.wording import Wording, wording, wording_of
from pellicle.studies.summary import (
    caveats,
    failures,
    progress_of,
    reasons,
    run_names,
    runs_of,
    short_files,
)
from pellicle.units import DIGITS, readable

from .answer import (
    answer_of_path,
    answer_of_step,
    answer_of_study,
    methods,
)
from .setup_drawing import description, setup_drawing

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

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
_PROFILES = 16
"""Largest number of load steps whose profile is on the page."""
_CURVES = {
    "profile": "Pressure and gap along x through the centre, at {step}.",
    "force_depth": "Force against depth over the load steps.",
    "area_force": "Contact area, of the cells and corrected, against force over the load steps.",
    TIME: "Force, depth and contact area over time.",
}


class Html(Output):
    """Web page of a run or a study: status, numbers, zoomable maps, figures, inputs, provenance.

    It is one file that loads nothing, so it can be kept, sent and viewed without a network. For a
    study it shows the last step of each run.
    """

    type: Literal["html"] = "html"
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
        if runs.axes is None:
            data, run = runs.open(), configuration
            result = Result(data)
            grid = Grid(**run["grid"])
            maps, chosen = self._maps_of_steps(result, grid)
            sections = [
                Section("In short", [*_answer(result, grid), _status(result), _setup(run)]),
                Section("Maps", [maps]),
                Section("Curves", _pictures_of(result, chosen)),
                Section("Numbers", [*_steps(data), *_path(result), *_oscillations(result)]),
                Section("Inputs", [_inputs(list(inputs(run)))]),
            ]
            varied: tuple[str, ...] = ()
        else:
            run = json.loads(table.attrs[FIRST_RUN])
            rows = list(runs_of(table))
            frames = dict(self._frames_of_runs(table, rows, stem.parent / "runs"))
            varied = tuple(str(name) for name in table.coords if name != "step")
            answer = answer_of_study(table, len(rows))
            lead = [Text(answer, lead=True)] if answer else []
            sections = [
                Section(
                    "In short", [*lead, _status_of_study(table, len(rows)), _setup(run, varied)]
                ),
                Section("Maps", _maps_of_runs(table, list(frames.values()), len(rows))),
                Section("Curves", _pictures_of_study(table)),
                Section("Numbers", [_runs(table, rows, list(frames)), *_paths(table, rows)]),
                Section("Inputs", [_inputs(_varied(table, list(inputs(run))))]),
            ]
        sections += [
            Section("Methods", [Text(methods(run, table.attrs["versions"], varied))]),
            Section("Provenance", [*_origin(table.attrs, run)]),
            Section("How to reproduce it", [*_reproduce(configuration, stem)]),
        ]
        date = table.attrs["date"].replace("T", " ").replace("+00:00", " UTC")
        kind = "Run" if runs.axes is None else "Study"
        with atomic_write(path) as part:
            text = page(table.attrs["title"] or stem.name, sections, f"{kind} of pellicle, {date}")
            part.write_text(text, encoding="utf-8")
        return (path,)

    def _maps_of_steps(self, result: Result, grid: Grid) -> tuple[Maps, list[int]]:
        """Return the maps of load steps, and the indices of the steps."""
        data = result.dataset
        steps = data.sizes["step"]
        chosen = self._chosen(steps)
        mapped = _mapped(data)
        points = side(self.points, len(chosen) * len(mapped))
        frames = []
        for index in chosen:
            step = without_round_off(data.isel(step=index))
            label = f"{index + 1}: {label_of_step(data, index, result.configuration)}"
            label += "" if step["converged"].item() else ", NOT CONVERGED"
            note = answer_of_step(data, index, grid.boundary, result.configuration)
            frames.append(replace(_frame(label, grid, step, mapped, points), note=note))
        step_shown = default_step(data) % steps
        begin = int(np.searchsorted(chosen, step_shown, side="right")) - 1
        *first, last = [f"{field.name}" for field in mapped.values()]
        names = f"{', '.join(first)} and {last}".capitalize()
        words = wording(data[prescribed_variable(data, result.configuration)]).words
        # Over the range of the last step the first ones would have one colour.
        colours = ", each in colours over its own range" if len(chosen) > 1 else ""
        shown_steps = _share_in_words(len(chosen), steps, "load step")
        caption = f"{names} at prescribed {words}, in {shown_steps}{colours}."
        maps = Maps(
            caption,
            "load step",
            tuple(mapped.values()),
            frames,
            begin=max(begin, 0),
            shared=False,
        )
        return maps, chosen

    def _frames_of_runs(
        self, table: xr.Dataset, rows: list[xr.Dataset], folder: Path
    ) -> Iterator[tuple[int, Frame]]:
        """Yield the maps of a step of runs, by their index among all."""
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
            grid = Grid(**json.loads(attributes["configuration"])["grid"])
            step = xr.Dataset(
                {name: (("x", "y"), field) for name, field in zip(names, fields, strict=True)},
                attrs=attributes,
            ).assign(depth=row["depth"][step_shown])
            if not sticks:
                step = step.assign({WALL_PRESSURE: step["pressure"]})
            yield index, _frame(names_of_runs[index], grid, without_round_off(step), mapped, points)

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


def _maps_of_runs(table: xr.Dataset, frames: list[Frame], count: int) -> list[Maps]:
    mapped = _mapped(table)
    which = "The last step in contact" if draws_contact(table) else "The last step"
    of_runs = _share_in_words(len(frames), count, "run")
    caption = f"{which} of {of_runs}, each in colours over its own range."
    maps = Maps(caption, "run", tuple(mapped.values()), frames, shared=False)
    return [maps] if frames else []


def _share_in_words(number: int, count: int, noun: str) -> str:
    """Return how many are shown in words: "each run", "3 of 8 runs"."""
    return f"each {noun}" if number == count else f"{number} of {count} {noun}s"


def _answer(result: Result, grid: Grid) -> list[Text]:
    """Return the answer of a run in a sentence or two."""
    data = result.dataset
    step_shown = default_step(data) % data.sizes["step"]
    first = answer_of_step(data, step_shown, grid.boundary, result.configuration)
    rest = answer_of_path(data, result.path_summary)
    return [Text(first, lead=True), *([Text(rest)] if rest else [])]


def _setup(configuration: dict[str, Any], varied: tuple[str, ...] = ()) -> Picture:
    return Picture(
        setup_drawing(configuration, varied), "Set-up, not to scale.", description(configuration)
    )


def _status(result: Result) -> Notice:
    total = result.planned_steps
    done, failed = result.dataset.sizes["step"], result.failures()
    sentences = []
    if done < total:
        sentences.append(f"The run ended early: {done} of {total} load steps are finished.")
    if failed:
        sentences.append(
            f"{len(failed)} of {done} load steps did not converge: do not rely on them."
        )
    else:
        steps = "The load step" if done == 1 else f"All {done} load steps"
        sentences.append(f"{steps} converged.")
    if coarse := result.coarse():
        sentences.append(f"In {len(coarse)} of {done} the cells are too coarse for the contact.")
    details = [f"Step {step}: {message}" for step, message in (*failed, *coarse)]
    if steep := result.steep():
        sentences.append(f"In {len(steep)} of {done} slopes in contact are beyond the theory.")
        details.append(f"S{first_message(steep)[1:]}")
    if cramped := result.cramped():
        sentences.append(f"In {len(cramped)} of {done} the domain is small for this solid.")
        details.append(f"S{first_message(cramped)[1:]}")
    for subject, message in result.beyond_theory().items():
        sentences.append(f"At the largest contact {subject}.")
        details.append(f"S{message[1:]}")
    return Notice(" ".join(sentences), not details and done == total, details)


def _status_of_study(table: xr.Dataset, count: int) -> Notice:
    failed, warnings = failures(table), [*caveats(table)]
    if not failed:
        return Notice(f"Every step of all {count} runs converged.", not warnings, warnings)
    return Notice(f"{failed[0].upper()}{failed[1:]}.", False, [*reasons(table), *warnings])


def _column(variable: xr.DataArray) -> tuple[Column, Wording]:
    """Return the head of a variable's column, and how its values are shown."""
    shown = wording(variable)
    is_text = variable.dtype.kind not in "if"
    meaning = variable.attrs.get("long_name", "")
    return Column(shown.words, shown.scale.unit, meaning, is_text), shown


def _path(result: Result) -> list[Table]:
    """Return the numbers of the whole path, where there is an interaction."""
    rows: list[list[str | Cell]] = [
        [declared.words, readable(value, declared.unit, DIGITS), declared.meaning]
        for name, value in result.path_summary.items()
        if name in names_of("path")
        for declared in (VARIABLES[name],)
    ]
    columns = [Column(head, words=True) for head in ("path", "value", "meaning")]
    caption = "Events on the path, to a step, and its work."
    return [Table(caption, columns, rows)] if rows else []


def _oscillations(result: Result) -> list[Table]:
    """Return the numbers of each oscillation, where a leg oscillates."""
    oscillations, columns, cells = result.oscillations, [], []
    for name in names_of("oscillation"):
        values = [getattr(oscillation, name) for oscillation in oscillations]
        shown = wording_of(name, values)
        columns.append(Column(shown.words, shown.scale.unit, VARIABLES[name].meaning))
        cells.append([shown.number(value) for value in values])
    rows: list[list[str | Cell]] = [list(row) for row in zip(*cells, strict=True)]
    caption = "Response over the last whole cycle of each oscillation."
    return [Table(caption, columns, rows)] if rows else []


def _paths(table: xr.Dataset, runs: list[xr.Dataset]) -> list[Table]:
    """Return the numbers of the path of each run, where there is an interaction or oscillation."""
    names = [
        str(name)
        for name, variable in table.data_vars.items()
        if "step" not in variable.dims and variable.dtype.kind == "f"
    ]
    if not names:
        return []
    axes = [str(name) for name in table.coords if name != "step"]
    columns = [(name, *_column(table[name])) for name in (*axes, *names)]
    rows: list[list[str | Cell]] = [
        [str(number), *(shown.number(run[name].item()) for name, _, shown in columns)]
        for number, run in enumerate(runs, start=1)
    ]
    heads = [Column("run"), *(column for _, column, _ in columns)]
    caption = "The path of each run: events, to a step, and work; the last oscillation."
    return [Table(caption, heads, rows)]


def _numbers(data: xr.Dataset) -> list[str]:
    return [
        str(name)
        for name, variable in data.data_vars.items()
        if "step" in variable.dims and variable.dtype.kind in "if" and "x" not in variable.dims
    ]


def _is_shown(data: xr.Dataset, name: str) -> bool:
    """Return whether a variable describes the contact, and has finite values.

    Without a finite force the variables of a step stay in the table.
    """
    if not means_something(data, name):
        return False
    missing = not np.isfinite(data[name].values.astype(float)).any()
    return not missing or not np.isfinite(data["force"].values).any()


def _is_effort(name: str) -> bool:
    # Prescriptions add residuals of their own.
    return name in names_of("effort") or name.startswith("residual_")


def _steps(data: xr.Dataset) -> list[Table]:
    """Return the numbers of each load step: the result, the shape of the contact, the effort."""
    effort = [n for n in _numbers(data) if _is_effort(n)]
    shape = [n for n in _numbers(data) if n in names_of("contact") and _is_shown(data, n)]
    measures = [
        n for n in _numbers(data) if n not in (*effort, *names_of("contact")) and _is_shown(data, n)
    ]
    tables = {
        "Results of each load step.": measures,
        "Shape of the contact in each load step.": shape,
        "Residuals and effort of each load step.": effort,
    }
    # Files of earlier versions lack the shape.
    return [_table_of_steps(data, names, caption) for caption, names in tables.items() if names]


def _table_of_steps(data: xr.Dataset, names: list[str], caption: str) -> Table:
    columns, texts = [Column("step")], [list(map(str, data["step"].values))]
    for name in names:
        column, shown = _column(data[name])
        columns.append(column)
        if name.startswith("residual_"):
            shown = replace(shown, digits=2)
        texts.append([shown.number(value) for value in data[name].values.tolist()])
    rows = [
        [*cells, _verdict(Status[code].verdict)]
        for *cells, code in zip(*texts, data["status_code"].values, strict=True)
    ]
    return Table(caption, [*columns, Column("status", words=True)], rows)


def _verdict(word: str) -> Cell:
    return Cell(word, bad=word != "converged")


def _runs(table: xr.Dataset, runs: list[xr.Dataset], mapped: list[int]) -> Table:
    """Return a row for each run: its values on the axes, and the numbers of its last step.

    ``mapped`` has the indices of the runs that are mapped, in the order of their maps.
    """
    axes = [str(name) for name in table.coords if name != "step"]
    names = [n for n in _numbers(table) if not _is_effort(n) and _is_shown(table, n)]
    varied = [_column(table[name]) for name in axes]
    numbers = [_column(table[name]) for name in names]
    rows: list[list[str | Cell]] = []
    for index, (row, file) in enumerate(zip(runs, short_files(table), strict=True)):
        done, total, word = progress_of(row)
        point = [
            shown.number(row[name].item()) for name, (_, shown) in zip(axes, varied, strict=True)
        ]
        last = [
            shown.number(row[name].values[done - 1].item()) if done else ""
            for name, (_, shown) in zip(names, numbers, strict=True)
        ]
        frame_of_run = mapped.index(index) if index in mapped else None
        run = Cell(str(index + 1), frame=frame_of_run)
        rows.append([run, *point, f"{done}/{total}", *last, _verdict(word), file])
    columns = [
        Column("run", meaning="number of the run, the last axis varying fastest"),
        *(column for column, _ in varied),
        Column("steps", meaning="finished load steps, of those planned"),
        *(column for column, _ in numbers),
        Column("status", words=True),
        Column("file", meaning="beginning of the name of its file in the folder runs", words=True),
    ]
    caption = "The last load step of each run; a click on a run shows its map."
    return Table(caption, columns, rows)


def _pictures_of(result: Result, chosen: list[int]) -> list[Picture]:
    """Return the curves of a run, with marks at the ``chosen`` steps, which are mapped."""
    fills = {name: fill for name, fill in drawings(result).items() if name in _CURVES}
    several = result.dataset.sizes["step"] > 1
    marks = partial(_marks, data=result.dataset, chosen=chosen)
    return [
        _profiles(result, chosen) if name == "profile" else _picture(fill, _CURVES[name], marks)
        for name, fill in fills.items()
        if several or name == "profile"
    ]


def _profiles(result: Result, chosen: list[int]) -> Picture:
    """Return the profile of a step, and those that take its place while another is mapped.

    Where many steps are mapped, some have the profile of the nearest one, as the caption says.
    """
    count = -(-len(chosen) // _PROFILES)

    def picture(index: int) -> Picture:
        label = label_of_step(result.dataset, index, result.configuration)
        caption = _CURVES["profile"].format(step=label)
        return _picture(lambda figure: profile(result, figure.add_subplot(), index), caption)

    # The last step is drawn, and every `count`-th before it.
    drawn = {index: picture(index) for index in chosen[::-1][::count]}
    frames = [drawn[min(drawn, key=lambda drawn_step: abs(drawn_step - index))] for index in chosen]
    shown = default_step(result.dataset) % result.dataset.sizes["step"]
    first = drawn[min(drawn, key=lambda drawn_step: abs(drawn_step - shown))]
    return replace(first, by_frame=frames if len(drawn) > 1 else ())


def _pictures_of_study(table: xr.Dataset) -> list[Picture]:
    def fill(variable: str, figure: Figure) -> None:
        study_curves(table, figure.add_subplot(), variable)

    return [
        _picture(partial(fill, name), f"{wording(table[name]).words.capitalize()} over the study.")
        for name in study_figures(table)
    ]


_Marks = list[list[tuple[float, float]]]


def _picture(
    fill: Callable[[Figure], None],
    caption: str,
    marked: Callable[[Figure], _Marks] | None = None,
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
    numbers = (data[name] for name in _numbers(data))
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


def _inputs(fields: list[Input]) -> Table:
    columns = [Column(head, words=True) for head in ("of", "input", "value", "meaning")]
    rows = [
        [i.part, "type" if i.words == i.part else i.words, _shortened(i.value), i.meaning]
        for i in fields
        if i.name != "title" and not i.name.startswith("outputs.")
    ]
    return Table("All inputs that determine the result, defaults included.", columns, rows)


def _shortened(text: str) -> str:
    """Return a text with the first eight digits of hashes."""
    return re.sub(r"\b([0-9a-f]{8})[0-9a-f]{24,}\b", r"\1…", text)


def _varied(table: xr.Dataset, fields: list[Input]) -> list[Input]:
    """Return the inputs of a study: its axes, and the inputs of its first run that do not vary."""
    axes = [
        Input(
            str(name),
            "study",
            shown.words,
            shown.listing(axis.values.tolist()),
            f"varied, {axis.size} values",
        )
        for name, axis in table.coords.items()
        if name != "step"
        for shown in (wording(axis),)
    ]
    names = tuple(f"{axis.name}." for axis in axes)
    fixed = [field for field in fields if not f"{field.name}.".startswith(names)]
    return [*axes, *fixed]


def _origin(attributes: dict[str, str], configuration: dict[str, Any]) -> Iterator[Table]:
    facts = [
        ("versions", attributes["versions"]),
        ("date", attributes["date"]),
        ("identity", _shortened(attributes.get("identity", ""))),
    ]
    heads = [Column("what", words=True), Column("value", words=True)]
    yield Table("Versions, date and identity.", heads, [list(fact) for fact in facts if fact[1]])
    rows = [
        [i.words, i.value, i.origin.distribution, i.origin.version, i.origin.entry_point]
        for i in inputs(configuration)
        if i.origin
    ]
    names = ("used as", "type", "package", "version", "entry point")
    yield Table("Origin of the components.", [Column(n, words=True) for n in names], rows)


def _reproduce(configuration: dict[str, Any], stem: Path) -> Iterator[Code]:
    name, folder = f"{stem.name}.toml", stem.parent.resolve().name or stem.name
    units = (
        "with the units that were given; numbers without one are"
        if "study" in configuration
        else ""
    )
    yield Code(tomli_w.dumps(configuration), f"The whole configuration, {units} in SI.", name)
    yield Code(
        f"pellicle run {shlex.quote(name)} -o {shlex.quote(folder)}",
        "With that file in the current folder, and the files that it names at their paths; their "
        "content is compared with its hash where the configuration has one:",
    )


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the page."""
    register(Html)
