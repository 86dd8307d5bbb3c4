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
from pellicle.files import read_text

from .file_checks import require_file, require_memory
from .scan import Channel, Scan, chosen, edge_lengths, height_scale, known
from .text_scan import text_channels
from .text_table import FORMAT_MARKS, read_tables

_ARRAYS = 9
"""Peak memory while a scan is read, in arrays of its points; 8 were measured at 2000² points."""


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
            channel = chosen(_channels(file, path), name, path)
            scale = height_scale(channel, unit, path)
            edges = edge_lengths(channel, size, scale, path)
            heights = channel.read() * scale
    except ConfigError:
        raise
    except PermissionError as error:
        raise ConfigError(f"{path}: {error.strerror}; give the file of a scan", "path") from None
    except Exception as error:
        reason = (str(error).splitlines() or [""])[0][:200] or type(error).__name__
        raise ConfigError(
            f"{path} is damaged or incomplete ({reason}); export it again", "path"
        ) from None
    heights[~np.isfinite(heights)] = np.nan
    heights.setflags(write=False)
    return Scan(heights, edges, digest)


def _channels(file: BinaryIO, path: Path) -> list[Channel]:
    """Return the data sets of a text or a file in a format of the library, first the default."""
    file.seek(0)
    head = file.read(512)
    file.seek(0)
    text = ""
    if head.startswith((BOM_UTF16_LE, BOM_UTF16_BE)) or b"\0" not in head:
        with suppress(ValueError):
            text = read_text(path)
    if not text.startswith(FORMAT_MARKS) and (tables := read_tables(text, path)):
        return text_channels(tables, path)
    io = library().IO
    with suppress(io.CannotDetectFileFormat):
        reader = io.open_topography(file)
        # Any file of 2n² bytes passes as hgt, n² integers without a header.
        if reader.format() != "hgt" or path.suffix.lower() == ".hgt":
            channels = reader.default_channel, *reader.channels
            return [_library_channel(channel, path) for channel in channels]
    raise ConfigError(
        f"{path} is damaged or in an unknown format; give a file that SurfaceTopography reads "
        "(gwy, opd, sdf, sur, x3p, …), text with a row of numbers, separated by blanks, commas or "
        "semicolons, on each line, or an array as type = 'heights'",
        "path",
    )


def _library_channel(channel: Any, path: Path) -> Channel:
    def read() -> Array:
        nx, ny = channel.nb_grid_pts
        require_memory(8.0 * _ARRAYS * nx * ny, f"{path} with its {nx} × {ny} points")
        # The heights do not depend on the size, but the reader requires one.
        dummy = None if channel.physical_sizes is not None else (1.0, 1.0)
        raw = channel.topography(physical_sizes=dummy).heights()
        return np.ma.filled(np.ma.asarray(raw, dtype=np.float64), np.nan)

    is_height = channel.is_height_channel
    unit = channel.unit if is_height else channel.data_unit
    edges = known([(float(edge), None) for edge in channel.physical_sizes or ()])
    return Channel(channel.name, unit, is_height, channel.dim == 2, edges, read)


def library() -> ModuleType:
    """Return the package SurfaceTopography, which takes seconds to import."""
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
