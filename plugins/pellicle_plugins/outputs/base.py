"""The base classes of outputs that draw a table of runs."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from pellicle.arrays import Dataset
from pellicle.components import Axis, Output, Runs
from pellicle.errors import ConfigError, StorageError
from pellicle.results import Result, StoredRuns, column_of, is_ordered, names
from pellicle.schema import evaluate, nearest
from pellicle.show import FigureStyle, in_words, without_round_off, write_charts
from pellicle.units import DIGITS, Quantity, readable

MOST_LEGS = 4
"""Largest number of legs of a path in time that are told apart."""
_PLACEHOLDER = re.compile(r"\{([^{}:]+)(?::(\.\d{1,2}[fg]))?\}")


Texts = Annotated[
    tuple[str, ...],
    BeforeValidator(
        lambda value: (value,) if isinstance(value, str) else value,
        json_schema_input_type=str | tuple[str, ...],
    ),
]
"""One text, or a list of them."""
Formats = Annotated[
    tuple[Literal["png", "svg", "pdf"], ...],
    Field(min_length=1, description="file formats to write: png, svg, pdf"),
]
StyleField = Annotated[
    FigureStyle, Field(description="for print: width, font_size, svg_text, file (a style file)")
]
Log = Annotated[tuple[Literal["x", "y"], ...], Field(description="axes that are logarithmic: x, y")]
XLabel = Annotated[str | None, Field(description="label of the horizontal axis")]
YLabel = Annotated[str | None, Field(description="label of the vertical axis")]
Reference = Annotated[
    Literal["axisymmetric"] | None,
    Field(description="draw the semi-analytic solution of the same expressions too"),
]


class Selection(dict[str, Any]):
    """Values of axes by name; of equal ones, as of equal outputs, the hashes are equal."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))


class TableFigure(Output):
    """A figure of the runs of a study, or of the steps of one run."""

    numbers: ClassVar[bool] = True
    """Whether the numbers drawn are written as CSV beside the figure."""

    name: str = Field(
        "", pattern=r"^[\w-]*$", description="suffix of the file names; the type if absent"
    )
    formats: Formats = ("png",)
    style: StyleField = FigureStyle()
    title: str = Field("", description="title of the figure")
    by: Texts = Field(
        (),
        description="axis of the study, or step, or several: each value has its own curve or panel",
    )
    where: Annotated[dict[str, Any], AfterValidator(Selection)] = Field(
        default_factory=Selection,
        description="values of other axes of the study for which it is drawn, such as "
        '{ "kernel.tension" = "10 mN/m" }',
    )
    label: str | None = Field(
        None,
        description="name of a curve or a panel; {expression} in it is replaced by its value, "
        "to three digits, or as in {expression:.2g}",
    )

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the figure and of its numbers."""
        return tuple(f".{kind}" for kind in (*self.formats, *["csv"] * self.numbers))

    def check(self, runs: Runs) -> None:
        """Refuse what cannot be shown."""
        list(self.charts(runs))

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure in each format, and its numbers; nothing if no step has numbers."""
        if "converged" not in runs.table:
            return ()
        return write_charts(self.charts(runs), stem, self.formats, self.style)

    def selected_runs(self, runs: Runs) -> Runs:
        """Return the runs that `where` leaves."""
        table = runs.table
        for name, entry in self.where.items():
            require_axes(filter(lambda axis: axis != "step", table.coords), [name], "where")
            axis, same = table[name], table[name].values == entry
            if axis.dtype.kind in "if":
                try:
                    value = Quantity(str(axis.attrs.get("units", "1")))(entry)
                except ValueError as error:
                    raise ConfigError(f"{name}: {error}", "where") from None
                same = np.isclose(axis.values, value, rtol=1e-9, atol=0.0)
            if not np.any(same):
                values = column_of(axis).listing
                raise ConfigError(f"{entry!r} is no value of {name}, which has {values}", "where")
            table = table.isel({axis.dims[0]: int(np.argmax(same))})
        return StoredRuns(table, runs.open, runs.configuration)

    def points_of_runs(self, runs: Runs) -> Iterator[tuple[Label, Dataset]]:
        """Yield the name of each curve or panel and the point of the table that it shows.

        Other axes are at their first value, steps at the last of the table.
        """
        table = self.selected_runs(runs).table
        require_axes(table.sizes, self.by, "by")
        first = {str(dim): -1 if dim == "step" else 0 for dim in table.sizes}
        for index in along(table, self.by):
            point = table.isel({**first, **index})
            yield label(self.label, point, self.by, table), point

    def is_ordered(self, runs: Runs) -> bool:
        """Return whether the curves belong to numbers to compare."""
        return len(self.by) == 1 and is_ordered(runs.table, self.by[0])

    def open_runs(self, runs: Runs) -> Iterator[tuple[Label, Dataset, Dataset]]:
        """Yield the name, the point of the table and the run of each, if there is its file."""
        for name, point in self.points_of_runs(runs):
            try:
                run = runs.open(str(point["run"].item()))
            except StorageError:
                continue
            yield name, point, run

    def steps(self, runs: Runs) -> Iterator[tuple[Label, Dataset]]:
        """Yield the name of each curve or panel and the last load step of its run, if finished."""
        for name, point, run in self.open_runs(runs):
            number = int(point["step"].item())
            if "step" not in self.by:
                number = min(number, Result(run).planned_steps)
            if number in run["step"]:
                yield name, without_round_off(run.sel(step=number))


def require_axes(known: Iterable[object], axes: Iterable[str], field: str) -> None:
    """Refuse an axis that is not among those of the table."""
    names = [*map(str, known)]
    for axis in axes:
        if axis not in names:
            suggestion = nearest(axis, names)
            raise ConfigError(f"{axis!r} is not an axis of the table; {suggestion}", field)


def along(table: Dataset, dims: Sequence[str]) -> list[dict[str, int]]:
    """Return the indices along dimensions, the last fastest; without any, that of the table."""
    ranges = [range(table.sizes[dim]) for dim in dims]
    return [dict(zip(dims, index, strict=True)) for index in product(*ranges)]


class Label(NamedTuple):
    """The name of a curve or a panel."""

    words: str
    """For the figure, such as "surface tension 30 mN/m"."""
    key: str
    """For the column ``curve`` of its numbers, such as "kernel.tension = 30 mN/m"."""


def label(template: str | None, data: Dataset, dims: Sequence[str], whole: Dataset) -> Label:
    """Return the name of a curve or a panel.

    ``{…}`` in the template is an expression, replaced by its mean over ``data``, the part of the
    table ``whole`` that is shown. Without a template the name has the values of ``dims``; without
    those, of all axes of the study for which ``data`` has only one. The words have values in one
    unit for all parts.
    """
    if template is not None:
        variables = names(data)

        def mean(match: re.Match[str]) -> str:
            values = np.asarray(evaluate(match[1], variables))
            known = values[~np.isnan(values)]
            return format(known.mean() if known.size else np.nan, match[2] or ".3g")

        text = _PLACEHOLDER.sub(mean, template)
        return Label(text, text)
    words, keys = [], []
    for axis in dims or json.loads(data.attrs.get("axes", "[]")):
        if data[axis].ndim == 0:
            value, unit = data[axis].item(), data[axis].attrs.get("units", "1")
            words.append(column_of(whole[axis]).text(value))
            keys.append(f"{axis} = {readable(value, unit, DIGITS) if unit != '1' else value}")
    return Label(", ".join(words), ", ".join(keys))


def axis_of(text: str, label: str | None, data: Dataset) -> Axis:
    """Return the axis that shows the expression ``text`` over ``data``.

    A bare variable has its unit, unless there is a ``label``; other expressions are in SI, since
    their unit is not known: xarray keeps that of one operand.
    """
    name = text.strip()
    if label is not None or name not in data.variables:
        return Axis(in_words(text, data) if label is None else label, as_given=True)
    return Axis(column_of(data[name]).words, str(data[name].attrs.get("units", "1")))
