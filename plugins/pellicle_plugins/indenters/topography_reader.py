"""Reads the files of profilometers and scanning probe microscopes, by SurfaceTopography."""

from __future__ import annotations

import hashlib
import warnings
from functools import lru_cache
from math import inf
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from pellicle import memory
from pellicle.arrays import Array
from pellicle.errors import ConfigError
from pellicle.units import Quantity

# Peak while a scan is read and laid on the grid, in arrays of its points, and while plain text is
# parsed, in lengths of the file: above what was measured at 2000² points (8) and 1000² (11).
_ARRAYS = 9
_TIMES_TEXT = 12
# What deflate, which HDF5, zip and gzip pack by, makes of equal bytes: no file holds more.
_POINTS_PER_BYTE = 1032
# Share of their distance by which the places of regular points may be off, as they are rounded.
_OFF_PLACE = 0.05
# Share by which the size in a header may differ from that which the coordinates have.
_OFF_SIZE = 0.02


class Scan(NamedTuple):
    """A measured surface."""

    heights: Array
    """[m], along x then y; NaN where a point is missing."""
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
        Name of the data set; the one that the format means as a rule if None.
    unit
        Length that 1 in the file stands for [m], if the file does not say it.
    size
        Edge lengths [m], if the file does not say them.

    Raises
    ------
    ConfigError
        The extra is not installed, or the file cannot be used.
    """
    if not path.is_file():
        raise ConfigError(f"{path}: no such file; give the file of a scan", "path")
    stat = path.stat()
    if stat.st_size == 0:
        raise ConfigError(f"{path} is empty; give the file of a scan", "path")
    return _read(path.absolute(), stat.st_mtime_ns, stat.st_size, channel, unit, size)


# The runs of a study may take many parts of one large scan.
@lru_cache(maxsize=1)
def _read(
    path: Path,
    changed: int,
    length: int,
    channel: str | None,
    unit: float | None,
    size: tuple[float, float] | None,
) -> Scan:
    """Return what `read_scan` does; a file that was written to since is read again."""
    io = library().IO
    try:
        file = path.open("rb")
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}; give the file of a scan", "path") from None
    # The readers warn of what is not ours to mend, and raise whatever a damaged file leads to.
    with file, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", np.exceptions.ComplexWarning)
        text = b"\0" not in file.read(512)
        require_memory(
            length * (_TIMES_TEXT if text else 1),
            f"{path}, a file of {length / 1e9:.3g} GB,",
            "export a part of it",
            "path",
        )
        file.seek(0)
        digest = hashlib.file_digest(file, "sha256").hexdigest()
        file.seek(0)
        try:
            reader = io.open_topography(file)
            if reader.format() == "hgt" and path.suffix.lower() != ".hgt":
                # Any file of 2n² bytes passes as this format, which is n² bare whole numbers.
                raise io.CannotDetectFileFormat
            found = _channel(reader, path, channel)
            scale = _scale(found, path, unit)
            edges = _size(found, path, scale, size)
            nx, ny = found.nb_grid_pts
            require_content(nx * ny, path)
            require_memory(
                8.0 * _ARRAYS * nx * ny,
                f"{path} with its {nx} × {ny} points",
                "export a part of it",
                "path",
            )
            # Sizes are not needed for the heights, but asked for where the file has none.
            dummy = None if found.physical_sizes is not None else (1.0, 1.0)
            read = found.topography(physical_sizes=dummy).heights()
            heights = np.ma.filled(np.ma.asarray(read, dtype=np.float64), np.nan)
            if _is_coordinates(reader, found):
                heights = _on_grid(heights, edges, path)
        except ConfigError:
            raise
        except io.CannotDetectFileFormat:
            raise ConfigError(
                f"{path} is of no format that can be read, or damaged; give one of "
                f"{', '.join(sorted(reader.format() for reader in io.readers))}, or plain "
                "numbers as type = 'heights'",
                "path",
            ) from None
        except np.exceptions.ComplexWarning:
            raise ConfigError(f"{path} holds complex values; give real numbers", "path") from None
        except Exception as error:
            raise ConfigError(
                f"{path} is damaged or incomplete ({_reason(error)}); export it again", "path"
            ) from None
        values = heights * scale
    values[~np.isfinite(values)] = np.nan
    values.setflags(write=False)
    return Scan(values, edges, digest)


def library() -> ModuleType:
    """Return the package SurfaceTopography, which takes seconds to import.

    Raises
    ------
    ConfigError
        It is not installed.
    """
    try:
        with warnings.catch_warnings():
            # It says that there is no MPI, which is not asked for.
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
    """Return the data set that is meant, which is heights over a regular grid."""
    channels = {each.name: each for each in reader.channels}
    heights = ", ".join(repr(each.name) for each in reader.height_channels) or "none"
    if name is not None and name not in channels:
        raise ConfigError(
            f"{name!r} is not in {path}; its channels of heights are: {heights}", "channel"
        )
    found = reader.default_channel if name is None else channels[name]
    if not found.is_height_channel:
        raise ConfigError(
            f"{found.name!r} of {path} is in {found.data_unit}, not heights; its channels of "
            f"heights are: {heights}",
            "channel",
        )
    if found.dim != 2:
        raise ConfigError(
            f"{path} is a profile along a line, and contact needs an area; give an areal scan, or, "
            "for line contact, the heights alone as type = 'heights' with grid.points = […, 1]",
            "path",
        )
    # A reader of coordinates has refused those that are read as a matrix, but for their header.
    if found.is_uniform is False or (
        _is_coordinates(reader, found) and found.physical_sizes is None
    ):
        raise _irregular(path)
    return found


def _irregular(path: Path) -> ConfigError:
    return ConfigError(
        f"{path} has points at irregular distances; resample them to a regular grid first", "path"
    )


def _is_coordinates(reader: Any, channel: Any) -> bool:
    """Whether what was read as a matrix of three columns are points x, y, z."""
    return bool(reader.format() == "asc" and channel.nb_grid_pts[0] == 3)


def _on_grid(columns: Array, size: tuple[float, float], path: Path) -> Array:
    """Return the heights of points x, y, z, of shape (3, n), over the regular grid they make.

    Raises
    ------
    ConfigError
        They make none, or one whose edges are not as ``size``, stated in the file, is.
    """
    *positions, heights = columns
    rows, extents = [], []
    for position in positions:
        if not np.isfinite(position).all() or np.ptp(position) == 0:
            raise _irregular(path)
        gaps = np.diff(np.sort(position))
        pitch = np.ptp(position) / np.count_nonzero(gaps > gaps.max() / 2)
        place = (position - position.min()) / pitch
        if (np.abs(place - np.rint(place)) > _OFF_PLACE).any():
            raise _irregular(path)
        rows.append(np.rint(place).astype(int))
        extents.append(np.ptp(position) + pitch)
    shape = rows[0].max() + 1, rows[1].max() + 1
    index = rows[0] * shape[1] + rows[1]
    if heights.size != shape[0] * shape[1] or (np.bincount(index) != 1).any():
        raise _irregular(path)
    # Coordinates and size may be in different units, and the size with or without the last pitch.
    ratios = [
        {edge / extent, edge / (extent * (n - 1) / n)}
        for edge, extent, n in zip(size, extents, shape, strict=True)
    ]
    if all(abs(one / other - 1) > _OFF_SIZE for one in ratios[0] for other in ratios[1]):
        raise ConfigError(
            f"{path} states a size of {size[0]:g} × {size[1]:g} m, and its coordinates are as "
            f"{extents[0]:g} to {extents[1]:g}; correct its header",
            "path",
        )
    grid = np.empty(heights.size)
    grid[index] = heights
    return grid.reshape(shape)


def _scale(found: Any, path: Path, unit: float | None) -> float:
    """Return the length that 1 in the file stands for [m]."""
    if found.unit is None:
        if unit is None:
            raise ConfigError(
                f"is missing, and {path} does not say in which unit its heights are; give the "
                "length that 1 stands for: '1 um'",
                "unit",
            )
        return unit
    if unit is not None:
        raise ConfigError(f"{path} states its own unit, {found.unit}; leave this out", "unit")
    try:
        return Quantity("m")(f"1 {found.unit}")
    except ValueError as error:
        raise ConfigError(f"{path} is in a unit that is no length: {error}", "path") from None


def _size(
    found: Any, path: Path, scale: float, size: tuple[float, float] | None
) -> tuple[float, float]:
    stated = found.physical_sizes
    # Programs that do not know the size write 0.
    if stated is None or not all(0 < edge < inf for edge in stated):
        if size is None:
            raise ConfigError(
                f"is missing, and {path} does not say it; give the edge lengths of the scan, such "
                "as ['80 um', '60 um']",
                "size",
            )
        return size
    x, y = (float(edge) * scale for edge in stated)
    if size is not None:
        raise ConfigError(f"{path} states its own size, {x:g} × {y:g} m; leave this out", "size")
    return x, y


def require_content(points: int, path: Path) -> None:
    """Refuse a file whose header claims more points than its bytes can hold, packed or not.

    Raises
    ------
    ConfigError
        In ``path``: it claims so.
    """
    length = path.stat().st_size
    if points > _POINTS_PER_BYTE * length:
        raise ConfigError(
            f"{path} claims {points} points, more than its {length} bytes can hold: it is damaged "
            "or incomplete; export it again",
            "path",
        )


def require_memory(needed: float, asked: str, remedy: str, field: str) -> None:
    """Refuse what needs more memory [bytes] than there is.

    Raises
    ------
    ConfigError
        In ``field``: it does not fit.
    """
    there = memory.available()
    if there is not None and needed > there:
        shortage = memory.shortage(needed, there)
        raise ConfigError(f"{asked} needs about {shortage}; {remedy}", field)


def _reason(error: Exception) -> str:
    return (str(error).splitlines() or [""])[0][:200] or type(error).__name__
