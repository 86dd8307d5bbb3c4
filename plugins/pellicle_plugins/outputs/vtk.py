"""The displaced surface in files that ParaView opens."""

from __future__ import annotations

import base64
import struct
import sys
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal
from xml.etree import ElementTree as Xml

import numpy as np
from numpy.typing import NDArray

from pellicle import hookimpl, storage
from pellicle.columns import FIELDS
from pellicle.components import Output, Place
from pellicle.result import Result

if TYPE_CHECKING:
    import xarray as xr

_TYPES = {"f8": "Float64", "i8": "Int64", "b1": "UInt8"}


class Vtk(Output):
    """Displaced surface with pressure, gap and contact, for ParaView: a file each step, and a list.

    The .vts files are structured grids of the cell centres. The surface lies at z = −displacement,
    so the solid is below it, and all fields are point data; the numbers of the step are field data.
    The .pvd file lists the steps in order: open that.
    """

    type: Literal["vtk"] = "vtk"

    def endings(self) -> tuple[str, ...]:
        """Return those of the list and of the steps."""
        return ".pvd", "-*.vts"

    def step(self, place: Place, step: xr.Dataset) -> None:
        """Write the file of the step."""
        _write(_of_step(step), _file(place, step["step"].item()))

    def close(self, place: Place, result: Result) -> tuple[Path, ...]:
        """Write the list of the steps and name all files."""
        steps = result.dataset["step"].values.tolist()
        files = [_file(place, number) for number in steps]
        root, collection = _root("Collection")
        for number, path in zip(steps, files, strict=True):
            Xml.SubElement(collection, "DataSet", timestep=str(number), file=path.name)
        _write(root, place.file(".pvd"))
        return (*files, place.file(".pvd"))


def _file(place: Place, number: int) -> Path:
    return place.file(f"-{number:04d}.vts")


def _of_step(step: xr.Dataset) -> Xml.Element:
    """Return the structured grid of one step."""
    data = step.isel(step=0)
    surface = data[list(FIELDS)].transpose("y", "x")
    y, x = np.meshgrid(data["y"].values, data["x"].values, indexing="ij")
    points = np.stack([x, y, -surface["displacement"].values], axis=-1)
    ny, nx = x.shape
    extent = f"0 {nx - 1} 0 {ny - 1} 0 0"
    root, grid = _root("StructuredGrid", WholeExtent=extent)
    numbers = {
        str(name): np.atleast_1d(variable.values)
        for name, variable in data.data_vars.items()
        if variable.ndim == 0 and variable.dtype.kind in "fib"
    }
    _arrays(Xml.SubElement(grid, "FieldData"), numbers, NumberOfTuples="1")
    piece = Xml.SubElement(grid, "Piece", Extent=extent)
    fields = {str(name): variable.values.ravel() for name, variable in surface.items()}
    _arrays(Xml.SubElement(piece, "PointData", Scalars="pressure"), fields)
    _arrays(Xml.SubElement(piece, "Points"), {"Points": points.ravel()}, NumberOfComponents="3")
    return root


def _root(kind: str, **attributes: str) -> tuple[Xml.Element, Xml.Element]:
    """Return a VTK file and the element of its kind in it."""
    root = Xml.Element(
        "VTKFile",
        type=kind,
        version="1.0",
        byte_order="LittleEndian" if sys.byteorder == "little" else "BigEndian",
        header_type="UInt64",
        compressor="vtkZLibDataCompressor",
    )
    return root, Xml.SubElement(root, kind, attributes)


def _arrays(parent: Xml.Element, arrays: Mapping[str, NDArray[Any]], **said: str) -> None:
    for name, values in arrays.items():
        kind = _TYPES[values.dtype.str[1:]]
        array = Xml.SubElement(parent, "DataArray", said, type=kind, Name=name, format="binary")
        array.text = _encoded(values.tobytes())


_BLOCK = 1 << 22


def _encoded(data: bytes) -> str:
    """Return bytes in base64, compressed by blocks.

    Ahead stand the number of blocks, their size, that of the last if it is less, and the compressed
    size of each.
    """
    packed = [zlib.compress(block, 1) for block in _blocks(data)]
    sizes = [len(packed), _BLOCK, len(data) % _BLOCK, *map(len, packed)]
    head = struct.pack(f"={len(sizes)}Q", *sizes)
    return (base64.b64encode(head) + base64.b64encode(b"".join(packed))).decode("ascii")


def _blocks(data: bytes) -> Iterator[bytes]:
    for start in range(0, len(data), _BLOCK):
        yield data[start : start + _BLOCK]


def _write(root: Xml.Element, path: Path) -> None:
    with storage.aside(path) as part:
        Xml.ElementTree(root).write(part, encoding="utf-8", xml_declaration=True)


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the files for ParaView."""
    register(Vtk)
