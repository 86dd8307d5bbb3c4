"""Read files of profilometers and scanning probe microscopes with SurfaceTopography."""

from __future__ import annotations

import hashlib
import io as streams
import warnings
from codecs import BOM_UTF8
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from math import inf
from pathlib import Path
from types import ModuleType
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from pellicle import memory
from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.files import is_file
from pellicle.units import Quantity

from .text_numbers import separated_by_blanks, word_in_row

_ARRAYS = 9
"""Peak memory while a scan is read, in arrays of its points; 8 were measured at 2000² points."""
_TEXT_FACTOR = 12
"""Peak memory while text is parsed, over the length of the file; 11 were measured at 1000²."""
_POINTS_PER_BYTE = 1032
"""Largest ratio at which deflate, used by HDF5, zip and gzip, compresses equal bytes."""
_POSITION_TOLERANCE = 0.05
"""Allowed rounding of the positions of regular points, relative to their spacing."""
_SIZE_TOLERANCE = 0.02
"""Allowed relative difference between the size in the header and that of the coordinates."""


class Scan(NamedTuple):
    """A measured surface."""

    heights: Array
    """Heights [m] along x, then y; NaN where a point is missing."""
    size: tuple[float, float]
    """Edge lengths [m]."""
    digest: str
    """SHA-256 of the file."""


def read_scan(
    path: Path,
    channel: str | None = None,
    unit: float | None = None,
    size: tuple[float, float] | None = None,
) -> Scan:
    """Return the surface in a file.

    Parameters
    ----------
    path
        The file.
    channel
        Name of the data set; the default of the file format if None.
    unit
        Length that 1 in the file stands for [m], if the file does not state it.
    size
        Edge lengths [m], if the file does not state them.

    Raises
    ------
    ConfigError
        The extra is not installed, or the file cannot be used.
    """
    if not is_file(path):
        raise ConfigError(f"{path}: no such file; give the file of a scan", "path")
    stat = path.stat()
    if stat.st_size == 0:
        raise ConfigError(f"{path} is empty; give the file of a scan", "path")
    return _read(path.absolute(), stat.st_mtime_ns, stat.st_size, channel, unit, size)


# The runs of a study may use many parts of one large scan.
@lru_cache(maxsize=1)
def _read(
    path: Path,
    changed: int,
    length: int,
    channel: str | None,
    unit: float | None,
    size: tuple[float, float] | None,
) -> Scan:
    """Return the scan as `read_scan` does; a file that has changed is read again."""
    try:
        file = path.open("rb")
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}; give the file of a scan", "path") from None
    # Readers give warnings that the user cannot act on, and raise any exception for a damaged file.
    with file, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", np.exceptions.ComplexWarning)
        text = b"\0" not in file.read(512)
        require_memory(
            length * (_TEXT_FACTOR if text else 1),
            f"{path}, a file of {length / 1e9:.3g} GB,",
            "export a part of it",
            "path",
        )
        file.seek(0)
        digest = hashlib.file_digest(file, "sha256").hexdigest()
        file.seek(0)
        with _errors_of_readers(path):
            reader = library().IO.open_topography(_with_blanks(file) if text else file)
            if reader.format() == "hgt" and path.suffix.lower() != ".hgt":
                # Any file of 2n² bytes passes as this format of n² integers without a header.
                raise library().IO.CannotDetectFileFormat
            data = _channel(reader, path, channel)
            scale = _scale(data, path, unit)
            edges = _size(data, path, scale, size)
            if reader.format() == "asc":
                _require_all_rows(file, data.nb_grid_pts[0], path)
            heights = _heights(reader, data, edges, path)
        values = heights * scale
    values[~np.isfinite(values)] = np.nan
    values.setflags(write=False)
    return Scan(values, edges, digest)


@contextmanager
def _errors_of_readers(path: Path) -> Iterator[None]:
    """Raise ConfigError with the remedy for anything that a reader raises."""
    io = library().IO
    try:
        yield
    except ConfigError:
        raise
    except io.CannotDetectFileFormat:
        raise ConfigError(
            f"{path} is damaged or in an unknown format; give a file that SurfaceTopography "
            "reads (gwy, opd, sdf, sur, x3p, …), text with a row of numbers, separated by "
            "blanks, commas or semicolons, on each line, or an array as type = 'heights'",
            "path",
        ) from None
    except np.exceptions.ComplexWarning:
        raise ConfigError(f"{path} holds complex values; give real numbers", "path") from None
    except Exception as error:
        raise ConfigError(
            f"{path} is damaged or incomplete ({_reason(error)}); export it again", "path"
        ) from None


def _heights(reader: Any, data: Any, edges: tuple[float, float], path: Path) -> Array:
    """Return the heights of a channel in the unit of the file, NaN where there are none."""
    nx, ny = data.nb_grid_pts
    require_content(nx * ny, path)
    require_memory(
        8.0 * _ARRAYS * nx * ny,
        f"{path} with its {nx} × {ny} points",
        "export a part of it",
        "path",
    )
    # The heights do not depend on the size, but the reader requires one.
    dummy = None if data.physical_sizes is not None else (1.0, 1.0)
    raw = data.topography(physical_sizes=dummy).heights()
    heights = np.ma.filled(np.ma.asarray(raw, dtype=np.float64), np.nan)
    return _on_grid(heights, edges, path) if _is_coordinates(reader, data) else heights


def _with_blanks(file: BinaryIO) -> BinaryIO:
    """Return a text file with blanks between its numbers, as SurfaceTopography needs them.

    It takes lines with other separators, and one that begins with a byte order mark, for lines of a
    header, and skips them.
    """
    content = file.read()
    file.seek(0)
    # A header in text may precede binary data.
    if b"\0" in content or not any(mark in content for mark in (b",", b";", b"\t", BOM_UTF8)):
        return file
    return streams.BytesIO("\n".join(separated_by_blanks(_lines(content))).encode("latin-1"))


def _lines(content: bytes) -> list[str]:
    """Return the lines of a text; headers may hold any byte, and numbers are ASCII."""
    return content.removeprefix(BOM_UTF8).decode("latin-1").split("\n")


def _require_all_rows(file: BinaryIO, width: int, path: Path) -> None:
    """Refuse a text of which SurfaceTopography skips a row of ``width`` entries, one a word."""
    file.seek(0)
    if in_row := word_in_row(_lines(file.read()), width):
        number, word = in_row
        raise ConfigError(
            f"{path} has {word!r} among the numbers of line {number}; write nan for a missing "
            "point, or, between other separators than blanks, nothing",
            "path",
        )


def library() -> ModuleType:
    """Return the package SurfaceTopography, which takes seconds to import.

    Raises
    ------
    ConfigError
        The package is not installed.
    """
    try:
        with warnings.catch_warnings():
            # It warns that MPI is missing, which pellicle does not use.
            warnings.simplefilter("ignore", ImportWarning)
            import SurfaceTopography.IO
    except ImportError as error:
        raise ConfigError(
            f"needs SurfaceTopography, which is not installed ({error}); "
            "pip install 'pellicle[topography]'",
            "type",
        ) from None
    return SurfaceTopography  # type: ignore[no-any-return]


def _channel(reader: Any, path: Path, name: str | None) -> Any:
    """Return the named data set or the default; refuse all but heights on a regular grid."""
    channels = {channel.name: channel for channel in reader.channels}
    heights = ", ".join(repr(channel.name) for channel in reader.height_channels) or "none"
    if name is not None and name not in channels:
        raise ConfigError(
            f"{name!r} is not in {path}; its channels of heights are: {heights}", "channel"
        )
    channel = reader.default_channel if name is None else channels[name]
    if not channel.is_height_channel:
        raise ConfigError(
            f"{channel.name!r} of {path} is in {channel.data_unit}, not heights; its channels of "
            f"heights are: {heights}",
            "channel",
        )
    if channel.dim != 2:
        raise ConfigError(
            f"{path} is a profile along a line, and contact needs an area; give an areal scan, or, "
            "for line contact, the heights alone as type = 'heights' with grid.points = […, 1]",
            "path",
        )
    # A matrix of three columns without a size in the header is a list of irregular points.
    if channel.is_uniform is False or (
        _is_coordinates(reader, channel) and channel.physical_sizes is None
    ):
        raise _irregular(path)
    return channel


def _irregular(path: Path) -> ConfigError:
    return ConfigError(
        f"{path} has points at irregular distances; resample them to a regular grid first", "path"
    )


def _is_coordinates(reader: Any, channel: Any) -> bool:
    """Return whether a matrix of three columns is a list of points x, y, z."""
    return bool(reader.format() == "asc" and channel.nb_grid_pts[0] == 3)


def _on_grid(columns: Array, size: tuple[float, float], path: Path) -> Array:
    """Return the heights of points x, y, z, of shape (3, n), on their regular grid.

    Raises
    ------
    ConfigError
        The points are not on a regular grid, or its edges differ from ``size``, stated in the file.
    """
    *positions, heights = columns
    rows, extents = [], []
    for position in positions:
        if not np.isfinite(position).all() or np.ptp(position) == 0:
            raise _irregular(path)
        gaps = np.diff(np.sort(position))
        pitch = np.ptp(position) / np.count_nonzero(gaps > gaps.max() / 2)
        index = (position - position.min()) / pitch
        if (np.abs(index - np.rint(index)) > _POSITION_TOLERANCE).any():
            raise _irregular(path)
        rows.append(np.rint(index).astype(int))
        extents.append(np.ptp(position) + pitch)
    shape = rows[0].max() + 1, rows[1].max() + 1
    cell = rows[0] * shape[1] + rows[1]
    if heights.size != shape[0] * shape[1] or (np.bincount(cell) != 1).any():
        raise _irregular(path)
    # Coordinates and size may have different units; the size may lack the last pitch.
    ratios = [
        {edge / extent, edge / (extent * (n - 1) / n)}
        for edge, extent, n in zip(size, extents, shape, strict=True)
    ]
    if all(abs(x / y - 1) > _SIZE_TOLERANCE for x in ratios[0] for y in ratios[1]):
        raise ConfigError(
            f"{path} states a size of {size[0]:g} × {size[1]:g} m, and its coordinates are as "
            f"{extents[0]:g} to {extents[1]:g}; correct its header",
            "path",
        )
    grid = np.empty(heights.size)
    grid[cell] = heights
    return grid.reshape(shape)


def _scale(channel: Any, path: Path, unit: float | None) -> float:
    """Return the length that 1 in the file stands for [m]."""
    if channel.unit is None:
        if unit is None:
            raise ConfigError(
                f"is missing, and {path} does not state the unit of its heights; give the "
                "length that 1 stands for: '1 um'",
                "unit",
            )
        return unit
    if unit is not None:
        raise ConfigError(f"{path} states its own unit, {channel.unit}; leave this out", "unit")
    try:
        return Quantity("m")(f"1 {channel.unit}")
    except ValueError as error:
        raise ConfigError(f"{path} is in a unit that is not a length: {error}", "path") from None


def _size(
    channel: Any, path: Path, scale: float, size: tuple[float, float] | None
) -> tuple[float, float]:
    stated = channel.physical_sizes
    # Programs that do not know the size write 0.
    if stated is None or not all(0 < edge < inf for edge in stated):
        if size is None:
            raise ConfigError(
                f"is missing, and {path} does not state it; give the edge lengths of the scan, "
                "such as ['80 um', '60 um']",
                "size",
            )
        return size
    x, y = (
        float(edge) * in_metres
        for edge, in_metres in zip(stated, _scales_of_edges(channel, path, scale), strict=True)
    )
    if size is not None:
        raise ConfigError(f"{path} states its own size, {x:g} × {y:g} m; leave this out", "size")
    return x, y


def _scales_of_edges(channel: Any, path: Path, scale: float) -> tuple[float, float]:
    """Return the lengths that 1 in the size stands for along x and y [m].

    SurfaceTopography converts the size to the unit of the heights, but if a header states a unit of
    the size alone, it leaves both as they are.
    """
    header = channel.info.get("raw_metadata", {}) if channel.unit is None else {}
    along_x = header.get("xunit")
    along_y = header.get("yunit") or along_x
    return _scale_of_edge(along_x, path, scale), _scale_of_edge(along_y, path, scale)


def _scale_of_edge(unit: str | None, path: Path, scale: float) -> float:
    if not unit:
        return scale
    try:
        return Quantity("m")(f"1 {unit}")
    except ValueError:
        raise ConfigError(
            f"{path} states its size in {unit!r}, which is not a unit of length; in its header, "
            "write decimals with a point and units such as um",
            "path",
        ) from None


def require_content(points: int, path: Path) -> None:
    """Check that the bytes of a file can hold the points of its header, compressed or not.

    Raises
    ------
    ConfigError
        They cannot; the error names the field ``path``.
    """
    length = path.stat().st_size
    if points > _POINTS_PER_BYTE * length:
        raise ConfigError(
            f"{path} claims {points} points, more than its {length} bytes can hold: it is damaged "
            "or incomplete; export it again",
            "path",
        )


def require_memory(needed: float, subject: str, remedy: str, field: str) -> None:
    """Check that the available memory [bytes] suffices.

    Raises
    ------
    ConfigError
        It does not; the error names the field ``field``.
    """
    available = memory.available()
    if available is not None and needed > available:
        shortage = memory.shortage(needed, available)
        raise ConfigError(f"{subject} needs about {shortage}; {remedy}", field)


def _reason(error: Exception) -> str:
    return (str(error).splitlines() or [""])[0][:200] or type(error).__name__
