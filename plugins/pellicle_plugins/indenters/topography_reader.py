"""Read scans of profilometers and scanning probe microscopes, in text or with SurfaceTopography."""

from __future__ import annotations

import hashlib
import warnings
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any, BinaryIO

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError

from .contents import contents, unit_of_image
from .file_checks import HDF5, datasets, require_file, require_memory, require_unpacked
from .scan import Channel, Scan, channel_of, edge_lengths, height_scale, known_edges
from .text_scan import text_channel
from .text_table import FORMAT_MARKS, read_tables, text_in

_BEYOND = 1e9
"""Height [m] that no surface has; files mark missing points with numbers of this size and more."""
_ARRAYS = 9
"""Peak memory while a scan is read, in arrays of its points; 8 were measured at 2000² points."""
_UNKNOWN = (
    "is damaged or in an unknown format; give a file that SurfaceTopography reads (gwy, opd, sdf, "
    "sur, x3p, …), text with a row of numbers, separated by blanks, commas or semicolons, on each "
    "line, or an array as type = 'heights'"
)


def read_scan(
    path: Path, channel: str | None, unit: float | None, size: tuple[float, float] | None
) -> Scan:
    """Return the surface in a file, or in the ``channel`` of that name.

    ``unit`` [m] and ``size`` [m] are given where the file does not state them.
    """
    require_file(path)
    stat = path.stat()
    return _read(path.absolute(), (stat.st_mtime_ns, stat.st_size), channel, unit, size)


# The runs of a study may use many parts of one large scan.
@lru_cache(maxsize=1)
def _read(
    path: Path,
    _version: tuple[int, int],
    name: str | None,
    unit: float | None,
    size: tuple[float, float] | None,
) -> Scan:
    """Return the scan as `read_scan` does; a file that has changed is read again."""
    try:
        # Readers give warnings that the user cannot act on, and raise anything for damaged files.
        with path.open("rb") as file, warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            warnings.simplefilter("error", np.exceptions.ComplexWarning)
            digest = hashlib.file_digest(file, "sha256").hexdigest()
            channel = channel_of(_channels(file, path), name, path)
            scale = height_scale(channel, unit, path)
            edges = edge_lengths(channel, size, scale, path)
            heights = channel.read() * scale
            heights[~(np.abs(heights) < _BEYOND)] = np.nan
    except ConfigError:
        raise
    except PermissionError as error:
        raise ConfigError(f"{path}: {error.strerror}; give the file of a scan", "path") from None
    except Exception as error:
        reason = (str(error).splitlines() or [""])[0][:200] or type(error).__name__
        raise ConfigError(
            f"{path} is damaged or incomplete ({reason}); export it again", "path"
        ) from None
    heights.setflags(write=False)
    return Scan(heights, edges, digest, scale, channel.missing)


def _channels(file: BinaryIO, path: Path) -> list[Channel]:
    """Return the data sets of a text or a file in a format of the library, first the default."""
    file.seek(0)
    head = file.read(512)
    file.seek(0)
    text = ""
    if head.startswith((BOM_UTF16_LE, BOM_UTF16_BE)) or b"\0" not in head:
        with suppress(ValueError):
            text = text_in(path)
    if not text.startswith(FORMAT_MARKS) and (tables := read_tables(text, path)):
        return [text_channel(name, table, path) for name, table in tables.items()]
    require_unpacked(path)
    if head.startswith(HDF5):
        with datasets(path):
            pass
    io = library(path).IO
    with suppress(io.CannotDetectFileFormat):
        reader = io.open_topography(file)
        # Any file of 2n² bytes passes as hgt, n² integers without a header.
        if reader.format() != "hgt" or path.suffix.lower() == ".hgt":
            if not reader.channels:
                content = contents(path, getattr(reader, "_metadata", {}))
                content = content or f"is of the format {reader.format()} and holds no heights"
                raise ConfigError(f"{path} {content}", "path")
            if reader.format() == "nc":
                _require_whole(reader, path)
            channels = (reader.default_channel, *reader.channels)
            return [_library_channel(channel, reader, path) for channel in channels]
    raise ConfigError(f"{path} {contents(path, {}) or _UNKNOWN}", "path")


def _library_channel(channel: Any, reader: Any, path: Path) -> Channel:
    def read() -> Array:
        nx, ny = channel.nb_grid_pts
        require_memory(8.0 * _ARRAYS * nx * ny, f"{path} with its {nx} × {ny} points")
        # The heights do not depend on the size, but the reader requires one.
        dummy = None if channel.physical_sizes is not None else (1.0, 1.0)
        raw = channel.topography(physical_sizes=dummy).heights()
        return np.ma.filled(np.ma.asarray(raw, dtype=np.float64), np.nan)

    is_height = channel.is_height_channel
    unit = channel.unit if is_height else channel.data_unit
    missing = "missing"
    if reader.format() == "gwy":
        missing = "marked by the mask of the file, or missing" if reader._masks else missing
        # To the library A is the ångström, to Gwyddion the ampere.
        if unit_of_image(reader._metadata, f"/{channel.tags['index']}/data") == "A":
            is_height, unit = False, "A"
    edges = known_edges([(float(edge), None) for edge in channel.physical_sizes or ()])
    return Channel(channel.name, unit, is_height, channel.dim == 2, edges, read, missing)


def _require_whole(reader: Any, path: Path) -> None:
    """Refuse a part that was cut from a NetCDF map and still states the size of the whole."""
    is_whole = reader._heights_var.dimensions in (("x", "y"), ("x",), ("n",))
    for variable in (reader._x_var, reader._y_var):
        if length := getattr(variable, "length", None):
            steps = np.diff(np.ma.filled(variable[...], np.nan))
            # A length may lack the last pitch.
            pitches = [float(length) / n for n in (steps.size + 1, max(1, steps.size))]
            is_whole &= any(np.allclose(steps, pitch, rtol=1e-3, atol=0) for pitch in pitches)
    if not is_whole:
        raise ConfigError(
            f"{path} is a part of a map, or turned: its coordinates x, y are not those of the size "
            "that it states; transpose heights to x, y, and set the attribute length of x and y to "
            "their pitch times their number",
            "path",
        )


def library(path: Path) -> ModuleType:
    """Return the package SurfaceTopography, which takes seconds to import, to read a file."""
    try:
        with warnings.catch_warnings():
            # It warns that MPI is missing, which pellicle does not use.
            warnings.simplefilter("ignore", ImportWarning)
            import SurfaceTopography.IO
    except ImportError as error:
        raise ConfigError(
            f"{path} needs SurfaceTopography, which is not installed ({error}); "
            "pip install 'pellicle[topography]'",
            "type",
        ) from None
    return SurfaceTopography  # type: ignore[no-any-return]
