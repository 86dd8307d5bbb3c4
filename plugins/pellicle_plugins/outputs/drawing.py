"""What the outputs that draw a table of runs have in common."""

from __future__ import annotations

import csv
import json
import re
from abc import abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from pellicle import storage
from pellicle.columns import Runs, names
from pellicle.components import Output, Place
from pellicle.errors import ConfigError, StorageError
from pellicle.expression import evaluate
from pellicle.model import nearest
from pellicle.operators import Array
from pellicle.plotting import axis_unit
from pellicle.result import Result

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_PLACEHOLDER = re.compile(r"\{([^{}]+)\}")


def _several(value: object) -> object:
    return (value,) if isinstance(value, str) else value


Texts = Annotated[
    tuple[str, ...], BeforeValidator(_several, json_schema_input_type=str | tuple[str, ...])
]
"""One text, or a list of them."""


class Drawing(Output):
    """Draws the runs of a study, or the steps of one run."""

    name: Annotated[
        str, Field(pattern=r"^[\w-]*$", description="ending of the file names; its type if absent")
    ] = ""
    formats: Annotated[
        tuple[Literal["png", "svg", "pdf"], ...],
        Field(min_length=1, description="file formats to write: png, svg, pdf"),
    ] = ("png",)
    title: Annotated[str, Field(description="title of the figure")] = ""

    @abstractmethod
    def draw(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the files, whose names begin with ``stem``, and return them."""

    def open(self, place: Place) -> None:
        """Find out before computing whether the files can be written."""
        storage.check_writable(self._stem(place))

    def close(self, place: Place, result: Result) -> tuple[Path, ...]:
        """Draw the steps of a run and return the files."""
        return self.draw(Runs.of_result(result), self._stem(place))

    def study(self, place: Place, table: xr.Dataset) -> tuple[Path, ...]:
        """Draw the runs of a study and return the files."""
        return self.draw(Runs.of_study(table, place.directory), self._stem(place))

    def _stem(self, place: Place) -> Path:
        return place.file(f"-{self.name or self.type}")  # type: ignore[attr-defined]


class FieldDrawing(Drawing):
    """Draws the fields of one step for each value of an axis.

    Of the other axes of a study the first value is drawn, and of the steps the last.
    """

    by: Annotated[
        str | None,
        Field(description="axis of the study, or step: each value has its own curve or panel"),
    ] = None
    label: Annotated[
        str | None,
        Field(
            description="name of a curve or a panel; {expression} in it is replaced by its value"
        ),
    ] = None

    def steps(self, runs: Runs) -> Iterator[tuple[str, xr.Dataset]]:
        """Yield the name of each curve or panel and the fields that it shows, if they are there."""
        one_axis(runs.table.sizes, self.by, "by")
        for at in along(runs.table, self.by):
            picked = pick(runs.table, at)
            step = step_of(runs, picked)
            if step is not None:
                yield label(self.label, picked, self.by), step


def one_axis(dims: Iterable[object], chosen: str | None, field: str) -> None:
    """Refuse a ``chosen`` dimension that is not among ``dims``."""
    if chosen is not None and chosen not in dims:
        known = nearest(chosen, map(str, dims))
        raise ConfigError(f"{chosen!r} is no axis of the table; {known}", field)


def along(table: xr.Dataset, dim: str | None) -> list[dict[str, int]]:
    """Return the places along a dimension; one that is everywhere if there is none."""
    return [{dim: index} for index in range(table.sizes[dim])] if dim else [{}]


def pick(table: xr.Dataset, at: dict[str, int]) -> xr.Dataset:
    """Return one point of a table: of the other axes the first value, of the steps the last."""
    first = {str(dim): -1 if dim == "step" else 0 for dim in table.sizes}
    return table.isel({**first, **at})


def step_of(runs: Runs, picked: xr.Dataset) -> xr.Dataset | None:
    """Return the fields of the step that a point of the table stands for, if they are there."""
    try:
        run = runs.open(str(picked["run"].item()))
    except StorageError:
        return None
    step = int(picked["step"].item())
    return run.isel(step=step) if step < run.sizes["step"] else None


def label(template: str | None, data: xr.Dataset, dim: str | None) -> str:
    """Return the name of a curve or a panel.

    ``{…}`` in the template is an expression, of which the mean over ``data`` is written; without
    a template it is the value of the dimension ``dim``, and without that, those of all axes of the
    study at which ``data`` is.
    """
    if template is not None:
        known = names(data)
        return _PLACEHOLDER.sub(
            lambda found: f"{np.nanmean(np.asarray(evaluate(found[1], known))):.3g}", template
        )
    axes = [dim] if dim else json.loads(data.attrs.get("axes", "[]"))
    return ", ".join(_at(data[axis]) for axis in axes if data[axis].ndim == 0)


def _at(value: xr.DataArray) -> str:
    unit = value.attrs.get("units", "1")
    if value.dtype.kind not in "if" or unit in ("", "1"):
        return f"{value.name} = {value.item()}"
    factor, name = axis_unit(value.values, unit)
    return f"{value.name} = {value.item() * factor:.4g} {name}"


def scaled(text: str, values: xr.DataArray, given: str | None) -> tuple[float, str]:
    """Return the factor and the label of an axis that shows the expression ``text``.

    A bare variable is brought to a unit with a prefix, unless the label is given.
    """
    if given is not None:
        return 1.0, given
    unit = values.attrs.get("units", "1")
    if unit in ("", "1"):
        return 1.0, text
    factor, name = axis_unit(values.values, unit)
    return factor, f"{text} [{name}]"


def set_scales(axes: Axes, log: Sequence[str]) -> None:
    """Make axes logarithmic, or begin at zero where nothing is below."""
    for which in ("x", "y"):
        low, _ = getattr(axes, f"get_{which}lim")()
        if which in log:
            getattr(axes, f"set_{which}scale")("log")
        elif low < 0 and getattr(axes.dataLim, f"{which}0") >= 0:
            getattr(axes, f"set_{which}lim")(**{"left" if which == "x" else "bottom": 0.0})
    axes.grid(alpha=0.3)


def write_csv(path: Path, rows: Sequence[dict[str, object]], heads: Sequence[str] = ()) -> Path:
    """Write the numbers that were drawn; ``heads`` are there even if no row is."""
    heads = list(dict.fromkeys([*heads, *(head for row in rows for head in row)]))
    with storage.reported(path), path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, heads)
        writer.writeheader()
        writer.writerows(rows)
    return path


def finite(*columns: Array) -> list[Array]:
    """Return the columns without the rows that have a NaN or an infinite value."""
    good = np.all([np.isfinite(column) for column in columns], axis=0)
    return [column[good] for column in columns]
