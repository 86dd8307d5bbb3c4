"""One web page for a run or a study, with all that it needs inside."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tomli_w
from pydantic import Field

from pellicle import Grid, hookimpl
from pellicle.components import Output, Place
from pellicle.config.describe import Input, inputs
from pellicle.errors import StorageError
from pellicle.files import atomic_write
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
    frame,
    page,
    side,
)
from pellicle.report.page import Field as Shown
from pellicle.report.plotting import (
    FIGURES,
    STUDY_FIGURES,
    study_curves,
    svg,
    without_round_off,
)
from pellicle.results import storage
from pellicle.results.derived import FIRST_RUN
from pellicle.results.result import Result
from pellicle.results.status import Status
from pellicle.results.variables import FIELDS as RESULT_FIELDS
from pellicle.results.variables import names_of
from pellicle.studies.summary import coarse, each_run, failures, reasons, standing
from pellicle.units import axis_unit, readable

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

FIELDS = {
    "pressure": Shown("contact pressure", "Pa", blank=True),
    "gap": Shown("gap", "m", "Blues", power=0.5),
}
"""What is mapped, by the name of its variable."""
_CURVES = {
    "profile": "Pressure and gap of the last step along x through the centre.",
    "force_depth": "Force against depth over the load steps.",
    "area_force": "Contact area, as counted and as corrected, against force over the load steps.",
}


class Html(Output):
    """Web page of a run or a study: status, numbers, zoomable maps, figures, inputs, provenance.

    It is one file and loads nothing, so it can be kept, sent and viewed without a network. Of a
    study it shows the last step of each run.
    """

    type: Literal["html"] = "html"
    points: Annotated[
        int,
        Field(
            ge=8,
            le=4096,
            description="pixels a side that a map has at most; of more cells, and where there are "
            "many maps, a pixel is the mean over a block, and the page says so",
        ),
    ] = 512
    frames: Annotated[
        int,
        Field(
            ge=1,
            description="load steps of a run, or runs of a study, that are mapped at most; of "
            "more, evenly chosen ones, the last among them",
        ),
    ] = 64

    def endings(self) -> tuple[str, ...]:
        """Return that of the page."""
        return (".html",)

    def close(self, place: Place, result: Result) -> tuple[Path, ...]:
        """Write the page of a run."""
        data = result.dataset
        said = json.loads(place.configuration)
        sections = [
            Section("Status", [_status(result)]),
            Section("Results", _steps(data)),
            Section("Maps", [self._maps_of_steps(data, Grid(**said["grid"]))]),
            Section("Curves", _pictures_of(result)),
            Section("Inputs", [_inputs(list(inputs(said)))]),
            Section("Provenance", [*_origin(data.attrs, said)]),
            Section("How to reproduce it", [*_reproduce(place)]),
        ]
        return _write(place, data.attrs, "Run", sections)

    def study(self, place: Place, table: xr.Dataset) -> tuple[Path, ...]:
        """Write the page of a study."""
        said = json.loads(table.attrs[FIRST_RUN])
        runs = list(each_run(table))
        mapped = dict(self._frames_of_runs(runs, place.directory / "runs"))
        shown = {index: number for number, index in enumerate(mapped)}
        maps = (
            Maps(
                f"The last step of {_some(len(mapped), len(runs), 'run')}, each in colours over "
                "its own range.",
                "run",
                tuple(FIELDS.values()),
                tuple(mapped.values()),
                shared=False,
            ),
        )
        sections = [
            Section("Status", [_status_of_study(table, len(runs))]),
            Section("Runs", [_runs(table, runs, shown)]),
            Section("Maps", maps if mapped else ()),
            Section("Curves", _pictures_of_study(table)),
            Section("Inputs", [_inputs(_varied(table, list(inputs(said))))]),
            Section("Provenance", [*_origin(table.attrs, said)]),
            Section("How to reproduce it", [*_reproduce(place)]),
        ]
        return _write(place, table.attrs, "Study", sections)

    def _maps_of_steps(self, data: xr.Dataset, grid: Grid) -> Maps:
        steps = data.sizes["step"]
        chosen = self._chosen(steps)
        factor, unit = axis_unit(data["depth"].values, "m")
        points = side(self.points, len(chosen) * len(FIELDS))
        made = []
        for index in chosen:
            step = without_round_off(data.isel(step=index))
            label = f"{index + 1}: depth {step['depth'].item() * factor:.4g} {unit}"
            label += "" if step["converged"].item() else ", NOT CONVERGED"
            made.append(frame(label, grid, [step[name].values for name in FIELDS], points))
        caption = f"Contact pressure and gap in {_some(len(chosen), steps, 'load step')}."
        return Maps(caption, "load step", tuple(FIELDS.values()), made, begin=len(made) - 1)

    def _frames_of_runs(self, runs: list[xr.Dataset], folder: Path) -> Iterator[tuple[int, Frame]]:
        """Yield the maps of the last step of runs, by their place among all."""
        import xarray as xr

        there = [index for index, row in enumerate(runs) if standing(row)[0]]
        chosen = self._chosen(len(there))
        points = side(self.points, len(chosen) * len(FIELDS))
        for index in (there[number] for number in chosen):
            row = runs[index]
            path = folder / f"{row['run'].item()}.h5"
            last = standing(row)[0] - 1
            try:
                attributes, fields = storage.fields(path, RESULT_FIELDS, last)
            except StorageError:
                continue
            grid = Grid(**json.loads(attributes["configuration"])["grid"])
            step = xr.Dataset(
                {
                    name: (("x", "y"), field)
                    for name, field in zip(RESULT_FIELDS, fields, strict=True)
                },
                attrs=attributes,
            ).assign(depth=row["depth"][last])
            drawn = without_round_off(step)
            yield index, frame(_named(row), grid, [drawn[name].values for name in FIELDS], points)

    def _chosen(self, count: int) -> list[int]:
        """Return which of so many are mapped: all, or evenly spaced ones up to the last."""
        many = min(count, self.frames)
        return [(count * (number + 1) + many - 1) // many - 1 for number in range(many)]


def _some(shown: int, there: int, what: str) -> str:
    if shown == there:
        return f"each {what}"
    return f"{shown} of {there} {what}s"


def _write(
    place: Place, attributes: dict[str, str], what: str, sections: list[Section]
) -> tuple[Path, ...]:
    path = place.file(".html")
    made = page(
        attributes["title"] or place.name,
        sections,
        f"{what} of pellicle, {attributes['date'].replace('T', ' ').replace('+00:00', ' UTC')}",
    )
    with atomic_write(path) as part:
        part.write_text(made, encoding="utf-8")
    return (path,)


def _status(result: Result) -> Notice:
    wanted = result.planned_steps
    done, failed = result.dataset.sizes["step"], result.failures()
    said = []
    if done < wanted:
        said.append(f"The run ended early: {done} of {wanted} load steps are there.")
    if failed:
        said.append(f"{len(failed)} of {done} load steps did not converge: do not rely on them.")
    else:
        steps = "The load step" if done == 1 else f"All {done} load steps"
        said.append(f"{steps} converged.")
    if coarse := result.coarse():
        said.append(f"In {len(coarse)} of {done} the cells are too coarse for the contact.")
    details = [f"Step {step}: {message}" for step, message in (*failed, *coarse)]
    return Notice(" ".join(said), not details and done == wanted, details)


def _status_of_study(table: xr.Dataset, count: int) -> Notice:
    bad = failures(table)
    doubts = [*coarse(table)]
    if not bad:
        return Notice(f"Every step of all {count} runs converged.", not doubts, doubts)
    said = f"Not all is well: {bad}."
    return Notice(said, False, [*reasons(table), *doubts])


def _column(name: str, variable: xr.DataArray) -> tuple[Column, float]:
    """Return the head of a variable's column, and the factor to its unit."""
    unit = variable.attrs.get("units", "1")
    factor, unit = axis_unit(variable.values, unit)
    words = variable.dtype.kind not in "if"
    said = name if "." in name else name.replace("_", " ")
    return Column(said, unit, variable.attrs.get("long_name", ""), words), factor


def _numbers(data: xr.Dataset) -> list[str]:
    return [
        str(name)
        for name, variable in data.data_vars.items()
        if "step" in variable.dims and variable.dtype.kind in "if" and "x" not in variable.dims
    ]


def _is_effort(name: str) -> bool:
    # Prescriptions add residuals of their own.
    return name in names_of("effort") or name.startswith("residual_")


def _steps(data: xr.Dataset) -> list[Table]:
    """Return the numbers of each load step: what was found, of what shape, and at what effort."""
    effort = [n for n in _numbers(data) if _is_effort(n)]
    shape = [n for n in _numbers(data) if n in names_of("contact")]
    found = [n for n in _numbers(data) if n not in (*effort, *shape)]
    tables = {
        "What was found in each load step.": found,
        "Of what shape the contact is.": shape,
        "How exactly each load step was solved, and at what effort.": effort,
    }
    # Files of earlier versions do not say the shape.
    return [_table_of_steps(data, names, said) for said, names in tables.items() if names]


def _table_of_steps(data: xr.Dataset, names: list[str], caption: str) -> Table:
    columns, texts = [Column("step")], [list(map(str, data["step"].values))]
    for name in names:
        column, factor = _column(name, data[name])
        columns.append(column)
        style = ".1e" if name.startswith("residual_") else ".6g"
        texts.append([_said(value, factor, style) for value in data[name].values.tolist()])
    rows = [
        [*cells, _verdict(Status[code].verdict)]
        for *cells, code in zip(*texts, data["status_code"].values, strict=True)
    ]
    return Table(caption, [*columns, Column("status", words=True)], rows)


def _said(value: Any, factor: float, style: str = ".6g") -> str:
    """Return a number in its unit; what counts something, or is a text, as it is."""
    return (
        format(value * factor, style if value else "g") if isinstance(value, float) else str(value)
    )


def _verdict(word: str) -> Cell:
    return Cell(word, bad=word != "converged")


def _runs(table: xr.Dataset, runs: list[xr.Dataset], shown: dict[int, int]) -> Table:
    """Return a row for each run: what is varied, and the numbers of its last step."""
    axes = [str(name) for name in table.coords if name != "step"]
    varied = [_column(name, table[name]) for name in axes]
    found = [n for n in _numbers(table) if not _is_effort(n)]
    numbers = [_column(name, table[name]) for name in found]
    rows: list[list[str | Cell]] = []
    for index, row in enumerate(runs):
        done, wanted, word = standing(row)
        given = [
            _said(row[name].item(), factor) for name, (_, factor) in zip(axes, varied, strict=True)
        ]
        last = [
            _said(row[name].values[done - 1].item(), factor) if done else ""
            for name, (_, factor) in zip(found, numbers, strict=True)
        ]
        name = Cell(str(row["run"].item()), frame=shown.get(index))
        rows.append([name, *given, f"{done}/{wanted}", *last, _verdict(word)])
    columns = [
        Column("run", meaning="name of its file in the folder runs", words=True),
        *(column for column, _ in varied),
        Column("steps", meaning="load steps that are there, of those that there should be"),
        *(column for column, _ in numbers),
        Column("status", words=True),
    ]
    caption = "The last load step of each run; a click on a run shows its map."
    return Table(caption, columns, rows)


def _named(row: xr.Dataset) -> str:
    """Return what tells a run from the others."""
    return ", ".join(
        f"{name} = {readable(value.item(), value.attrs.get('units', '1'))}"
        for name, value in row.coords.items()
        if name != "step"
    )


def _pictures_of(result: Result) -> list[Picture]:
    names = [name for name in _CURVES if name == "profile" or result.dataset.sizes["step"] > 1]
    return [_picture(partial(FIGURES[name], result), _CURVES[name]) for name in names]


def _pictures_of_study(table: xr.Dataset) -> list[Picture]:
    names = STUDY_FIGURES if "force" in table else ()
    return [
        _picture(
            partial(study_curves, table, variable=name),
            f"{name.replace('_', ' ').capitalize()} over the study.",
        )
        for name in names
    ]


def _picture(draw: Callable[[Axes], None], caption: str) -> Picture:
    def fill(figure: Any) -> None:
        axes = figure.add_subplot()
        draw(axes)
        # The page has a title, and a title may be longer than a figure is wide.
        axes.set_title("")

    return Picture(svg(fill), caption, caption)


def _inputs(found: list[Input]) -> Table:
    columns = [Column(head, words=True) for head in ("field", "value", "meaning")]
    rows = [
        [i.name, i.value, i.meaning]
        for i in found
        if i.name != "title" and not i.name.startswith("outputs.")
    ]
    return Table("All that decides the result, defaults included.", columns, rows)


def _varied(table: xr.Dataset, found: list[Input]) -> list[Input]:
    """Return the inputs of a study: those of its first run, but for those that vary."""
    axes = [
        Input(
            str(name),
            readable(axis.values.tolist(), axis.attrs.get("units", "1")),
            f"varied, {axis.size} values",
        )
        for name, axis in table.coords.items()
        if name != "step"
    ]
    taken = [axis.name for axis in axes]
    fixed = [i for i in found if not any(f"{i.name}.".startswith(f"{name}.") for name in taken)]
    return [*axes, *fixed]


def _origin(attributes: dict[str, str], configuration: dict[str, Any]) -> Iterator[Table]:
    facts = [
        ("versions", attributes["versions"]),
        ("date", attributes["date"]),
        ("identity", attributes.get("identity", "")),
    ]
    heads = [Column("what", words=True), Column("value", words=True)]
    yield Table("What it was computed with.", heads, [list(fact) for fact in facts if fact[1]])
    rows = [
        [i.name, i.value, i.origin.distribution, i.origin.version, i.origin.entry_point]
        for i in inputs(configuration)
        if i.origin
    ]
    names = ("used as", "type", "package", "version", "entry point")
    yield Table("Where the components come from.", [Column(n, words=True) for n in names], rows)


def _reproduce(place: Place) -> Iterator[Code]:
    name, folder = f"{place.name}.toml", place.directory.resolve().name or place.name
    yield Code(tomli_w.dumps(json.loads(place.configuration)), "All that was asked, in SI.", name)
    yield Code(
        f"pellicle run {shlex.quote(name)} -o {shlex.quote(folder)}",
        "With that file in the current folder, and files that it names where their paths say; what "
        "they hold is compared with its hash where there is one:",
    )


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the page."""
    register(Html)
