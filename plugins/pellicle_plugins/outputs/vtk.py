"""The displaced surface in files that ParaView opens."""

from __future__ import annotations

import glob
import math
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Output, Runs
from pellicle.files import storage_errors
from pellicle.results.path import has_times
from pellicle.variables import FIELDS, WALL_PRESSURE

from .vtk_file import array, element, rows_of, writer

if TYPE_CHECKING:
    import xarray as xr


class Vtk(Output):
    """Displaced surface with pressure, gap and contact, for ParaView: a file each step, and a list.

    The .vts files are structured grids of the cell centres. The surface lies at z = −displacement,
    so the solid is below it, and all fields are point data, with the wall pressure where there is
    an interaction; the numbers of the step are field data.
    The .pvd file, which lists the steps in order, opens them all; where steps have times, these are
    the time of ParaView.
    """

    type: Literal["vtk"] = "vtk"
    examples = ({},)

    scope: ClassVar[Literal["run"]] = "run"
    shares_stem: ClassVar[bool] = True

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the list and of the steps."""
        return ".pvd", "-*.vts"

    def step(self, record: xr.Dataset, stem: Path) -> None:
        """Write the file of the step; the first one removes those of an earlier run."""
        number = record["step"].item()
        if number == 1:
            # ParaView opens files of successive numbers as one series.
            for old in stem.parent.glob(f"{glob.escape(stem.name)}-*.vts"):
                if re.fullmatch(r"-\d{4,}\.vts", old.name.removeprefix(stem.name)):
                    with storage_errors(old):
                        old.unlink()
        _write_step(record, _file(stem, number))

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the list of the steps; return all files."""
        table, path = runs.table, Path(f"{stem}.pvd")
        files = [_file(stem, number) for number in table["step"].values.tolist()]
        times = table["time"].values if has_times(table) else table["step"].values
        with writer(path, "Collection") as xml:
            for time, file in zip(_growing(times.tolist()), files, strict=True):
                with element(xml, "DataSet", timestep=repr(time), file=file.name):
                    pass
        return (*files, path)


def _file(stem: Path, number: int) -> Path:
    return Path(f"{stem}-{number:04d}.vts")


def _write_step(step: xr.Dataset, path: Path) -> None:
    """Write the structured grid of one step, a block of rows at a time."""
    data = step.isel(step=0)
    x, y = data["x"].values, data["y"].values
    names = [name for name in (*FIELDS, WALL_PRESSURE) if name in data]
    fields = {name: data[name].transpose("y", "x").values for name in names}
    numbers = {
        str(name): np.atleast_1d(variable.values)
        for name, variable in data.data_vars.items()
        if variable.ndim == 0 and variable.dtype.kind in "fib"
    }

    def points(rows: slice) -> Array:
        return np.stack(
            np.broadcast_arrays(x, y[rows, None], -fields["displacement"][rows]), axis=-1
        )

    extent = f"0 {x.size - 1} 0 {y.size - 1} 0 0"
    with writer(path, "StructuredGrid", WholeExtent=extent) as xml:
        with element(xml, "FieldData"):
            for name, number in numbers.items():
                array(xml, name, number.dtype, [number.tobytes()], NumberOfTuples="1")
        with element(xml, "Piece", Extent=extent):
            with element(xml, "PointData", Scalars="pressure"):
                for name, field in fields.items():
                    blocks = (field[rows].tobytes() for rows in rows_of(y.size, 8 * x.size))
                    array(xml, name, field.dtype, blocks)
            with element(xml, "Points"):
                blocks = (points(rows).tobytes() for rows in rows_of(y.size, 24 * x.size))
                array(xml, "Points", np.dtype(float), blocks, NumberOfComponents="3")


def _growing(times: Iterable[float]) -> Iterator[float]:
    """Yield the times, those that do not grow raised to the next number.

    ParaView shows the files of one time together, so of a jump it would show both ends at once.
    """
    last = -math.inf
    for time in times:
        last = time if time > last else math.nextafter(last, math.inf)
        yield last
