"""The displaced surface in files that ParaView opens."""

from __future__ import annotations

import base64
import math
import struct
import sys
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal
from xml.sax.saxutils import XMLGenerator
from xml.sax.xmlreader import AttributesImpl

import numpy as np

from pellicle import hookimpl
from pellicle.arrays import Array
from pellicle.components import Output, Runs
from pellicle.files import atomic_write
from pellicle.results.path import has_times
from pellicle.results.variables import FIELDS, WALL_PRESSURE

if TYPE_CHECKING:
    import xarray as xr

_TYPES = {"f8": "Float64", "i8": "Int64", "b1": "UInt8"}


class Vtk(Output):
    """Displaced surface with pressure, gap and contact, for ParaView: a file each step, and a list.

    The .vts files are structured grids of the cell centres. The surface lies at z = −displacement,
    so the solid is below it, and all fields are point data, with the wall pressure where there is
    an interaction; the numbers of the step are field data.
    The .pvd file, which lists the steps in order, opens them all; where steps have times, these are
    the time of ParaView.
    """

    type: Literal["vtk"] = "vtk"

    scope: ClassVar[Literal["run"]] = "run"
    shares_stem: ClassVar[bool] = True

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the list and of the steps."""
        return ".pvd", "-*.vts"

    def step(self, record: xr.Dataset, stem: Path) -> None:
        """Write the file of the step."""
        _write_step(record, _file(stem, record["step"].item()))

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the list of the steps; return all files."""
        table, path = runs.table, Path(f"{stem}.pvd")
        files = [_file(stem, number) for number in table["step"].values.tolist()]
        times = table["time"].values if has_times(table) else table["step"].values
        _write_list(zip(_growing(times.tolist()), files, strict=True), path)
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
    with _writer(path) as xml, _file_of(xml, "StructuredGrid", WholeExtent=extent):
        with _element(xml, "FieldData"):
            for name, number in numbers.items():
                _array(xml, name, number.dtype, [_encoded(number.tobytes())], NumberOfTuples="1")
        with _element(xml, "Piece", Extent=extent):
            with _element(xml, "PointData", Scalars="pressure"):
                for name, field in fields.items():
                    blocks = (field[rows].tobytes() for rows in _rows(y.size, 8 * x.size))
                    _array(xml, name, field.dtype, _base64(blocks))
            with _element(xml, "Points"):
                blocks = (points(rows).tobytes() for rows in _rows(y.size, 24 * x.size))
                _array(xml, "Points", np.dtype(float), _base64(blocks), NumberOfComponents="3")


def _growing(times: Iterable[float]) -> Iterator[float]:
    """Yield the times, those that do not grow raised to the next number.

    ParaView shows the files of one time together, so of a jump it would show both ends at once.
    """
    last = -math.inf
    for time in times:
        last = time if time > last else math.nextafter(last, math.inf)
        yield last


def _write_list(steps: Iterable[tuple[float, Path]], path: Path) -> None:
    """Write the list of the files of the steps, each with its time."""
    with _writer(path) as xml, _file_of(xml, "Collection"):
        for time, file in steps:
            with _element(xml, "DataSet", timestep=repr(time), file=file.name):
                pass


@contextmanager
def _writer(path: Path) -> Iterator[XMLGenerator]:
    """Yield a writer of the elements of a file."""
    with atomic_write(path) as part, part.open("wb") as file:
        xml = XMLGenerator(file, "utf-8", short_empty_elements=True)
        xml.startDocument()
        yield xml
        xml.endDocument()


@contextmanager
def _element(xml: XMLGenerator, name: str, **attributes: str) -> Iterator[None]:
    xml.startElement(name, AttributesImpl(attributes))
    yield
    xml.endElement(name)


@contextmanager
def _file_of(xml: XMLGenerator, kind: str, **attributes: str) -> Iterator[None]:
    """Write the outer elements of a VTK file around the elements inside."""
    with (
        _element(
            xml,
            "VTKFile",
            type=kind,
            version="1.0",
            byte_order="LittleEndian" if sys.byteorder == "little" else "BigEndian",
            header_type="UInt64",
            compressor="vtkZLibDataCompressor",
        ),
        _element(xml, kind, **attributes),
    ):
        yield


def _array(
    xml: XMLGenerator, name: str, dtype: np.dtype[Any], text: Iterable[str], **attributes: str
) -> None:
    kind = _TYPES[dtype.str[1:]]
    with _element(xml, "DataArray", **attributes, type=kind, Name=name, format="binary"):
        for part in text:
            xml.characters(part)


_BLOCK = 1 << 22


def _rows(number: int, size: int) -> list[slice]:
    """Return slices of rows of ``size`` bytes that make blocks of about 4 MB."""
    many = max(1, _BLOCK // size)
    return [slice(start, start + many) for start in range(0, number, many)]


def _encoded(data: bytes) -> str:
    blocks = (data[start : start + _BLOCK] for start in range(0, len(data), _BLOCK))
    return "".join(_base64(blocks))


def _base64(blocks: Iterable[bytes]) -> Iterator[str]:
    """Yield blocks of bytes, all of one size but the last, in base64, each compressed.

    The header holds the number of blocks, their size, that of the last block if it is smaller, else
    0, and the compressed size of each block.
    """
    packed, sizes = [], []
    for block in blocks:
        packed.append(zlib.compress(block, 1))
        sizes.append(len(block))
    head = [len(packed), sizes[0], sizes[-1] % sizes[0], *map(len, packed)]
    yield base64.b64encode(struct.pack(f"={len(head)}Q", *head)).decode("ascii")
    rest = b""
    for block in packed:
        # Three bytes make four letters.
        data = rest + block
        whole = len(data) - len(data) % 3
        yield base64.b64encode(data[:whole]).decode("ascii")
        rest = data[whole:]
    yield base64.b64encode(rest).decode("ascii")


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the files for ParaView."""
    register(Vtk)
