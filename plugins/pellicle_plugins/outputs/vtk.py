"""The displaced surface in files that ParaView opens."""

from __future__ import annotations

import base64
import glob
import re
import struct
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar, Literal
from xml.sax.saxutils import XMLGenerator
from xml.sax.xmlreader import AttributesImpl

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Dataset
from pellicle.components import Output, Runs
from pellicle.files import atomic_write, storage_errors
from pellicle.results import has_times
from pellicle.variables import FIELDS, WALL_PRESSURE

_TYPES = {"f8": "Float64", "i8": "Int64", "b1": "UInt8"}
_LETTERS = 3 << 20
"""Bytes that are written in base64 at once; three are four letters."""


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
    suffixes: ClassVar[tuple[str, ...]] = (".pvd", "-*.vts")

    def step(self, record: Dataset, stem: Path) -> None:
        """Write the file of the step; the first one removes those of an earlier run."""
        number = record["step"].item()
        if number == 1:
            # ParaView opens files of successive numbers as one series.
            for old in stem.parent.glob(f"{glob.escape(stem.name)}-*.vts"):
                if re.fullmatch(r"-\d{4,}\.vts", old.name.removeprefix(stem.name)):
                    with storage_errors(old):
                        old.unlink()
        _write_step(record, Path(f"{stem}-{number:04d}.vts"))

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the list of the steps; return all files."""
        path, table, last = Path(f"{stem}.pvd"), runs.table, -np.inf
        files = [Path(f"{stem}-{number:04d}.vts") for number in table["step"].values.tolist()]
        times = table["time" if has_times(table) else "step"].values.tolist()
        with _writer(path, "Collection") as xml:
            for time, file in zip(times, files, strict=True):
                # ParaView shows the files of one time, such as both ends of a jump, together.
                last = max(time, float(np.nextafter(last, np.inf)))
                with _element(xml, "DataSet", timestep=repr(last), file=file.name):
                    pass
        return (*files, path)


def _write_step(step: Dataset, path: Path) -> None:
    data = step.isel(step=0)
    x, y = data["x"].values, data["y"].values
    extent = f"0 {x.size - 1} 0 {y.size - 1} 0 0"
    with _writer(path, "StructuredGrid", WholeExtent=extent) as xml:
        with _element(xml, "FieldData"):
            for name, variable in data.data_vars.items():
                if variable.ndim == 0 and variable.dtype.kind in "fib":
                    _array(xml, str(name), np.atleast_1d(variable.values), NumberOfTuples="1")
        with _element(xml, "Piece", Extent=extent):
            with _element(xml, "PointData", Scalars="pressure"):
                for name in (*FIELDS, WALL_PRESSURE):
                    if name in data:
                        _array(xml, name, data[name].transpose("y", "x").values)
            with _element(xml, "Points"):
                surface = -data["displacement"].transpose("y", "x").values
                points = np.stack(np.broadcast_arrays(x, y[:, None], surface), axis=-1)
                _array(xml, "Points", points, NumberOfComponents="3")


@contextmanager
def _writer(path: Path, kind: str, **attributes: str) -> Iterator[XMLGenerator]:
    """Yield a writer of the elements inside those of a VTK file of a ``kind``."""
    outer = {
        "type": kind,
        "version": "1.0",
        "byte_order": "LittleEndian" if sys.byteorder == "little" else "BigEndian",
        "header_type": "UInt64",
        "compressor": "vtkZLibDataCompressor",
    }
    with atomic_write(path) as part, part.open("wb") as file:
        xml = XMLGenerator(file, "utf-8", short_empty_elements=True)
        xml.startDocument()
        with _element(xml, "VTKFile", **outer), _element(xml, kind, **attributes):
            yield xml
        xml.endDocument()


@contextmanager
def _element(xml: XMLGenerator, name: str, **attributes: str) -> Iterator[None]:
    """Write an element; its content is written inside the context."""
    xml.startElement(name, AttributesImpl(attributes))
    yield
    xml.endElement(name)


def _array(xml: XMLGenerator, name: str, values: ArrayLike, **attributes: str) -> None:
    """Write numbers in base64, compressed.

    The head is the number of blocks, 1, its size, that of a smaller last one, 0, and its compressed
    size.
    """
    data = np.ascontiguousarray(values)
    packed = zlib.compress(data.data, 1)
    head = base64.b64encode(struct.pack("=4Q", 1, data.nbytes, 0, len(packed)))
    kind = _TYPES[data.dtype.str[1:]]
    with _element(xml, "DataArray", **attributes, type=kind, Name=name, format="binary"):
        xml.characters(head.decode("ascii"))
        for start in range(0, len(packed), _LETTERS):
            xml.characters(base64.b64encode(packed[start : start + _LETTERS]).decode("ascii"))
