"""Curves in the formats of instruments, through afmformats (extra ``afm``)."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.errors import ConfigError, PellicleError, StorageError
from pellicle.units import Quantity

from .cleaning import grows
from .columns import Calibration, Channel, unused_time
from .measurement import Axis, Measurement, Site
from .origin import CurveOrigin

SUFFIXES = (
    ".jpk-force",
    ".jpk-force-map",
    ".jpk-qi-data",
    ".jpk-qi-series",
    ".ibw",
    ".tab",
    ".zip",
)
"""Suffixes that only instrument files have; .h5, .csv and .txt may be an instrument's too."""
INSTALL = "such files are read by afmformats: install it with pip install 'pellicle[afm]'"
_FAR = 0.5
"""Least motion of a segment that is not a pause, over the largest motion."""
_SPRING, _TIP = "spring constant", "tip position"
_HEIGHTS = ("height (measured)", "height (piezo)")


def installed() -> bool:
    """Return whether afmformats is installed."""
    return find_spec("afmformats") is not None


def read(
    path: Path, calibration: Calibration, segment: str
) -> Mapping[str, Measurement | PellicleError]:
    """Return the ``segment`` of each curve by its number; the label of a single curve is empty.

    A curve is read from the file whenever its value is taken, so that a force map does not have to
    fit in memory.

    Raises
    ------
    ConfigError
        The file holds no calibration and none is given, or its own differs from the given one.
    StorageError
        The file cannot be read, or afmformats is not installed.
    """
    if not installed():
        raise StorageError(f"{path}: is the file of an instrument; {INSTALL}")
    from afmformats.formats import get_recipe

    values = {_SPRING: calibration.spring_constant, "sensitivity": calibration.sensitivity}
    overrides = {name: value for name, value in values.items() if value is not None}
    if not path.is_file():
        raise StorageError(f"{path}: cannot be read (no such file)")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with _pellicle_errors(path):
            loader = get_recipe(path).loader
            try:
                recordings = loader(path, meta_override=overrides)
            except NotImplementedError:
                # Formats that always hold their calibration do not take another.
                recordings = loader(path)
            # HDF5 lists curve 10 before curve 2.
            recordings = sorted(recordings, key=lambda recording: recording["metadata"]["enum"])
    return _Recordings(path, recordings, overrides, segment, _texts(caught))


def _texts(caught: Sequence[warnings.WarningMessage]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(f"afmformats: {warning.message}" for warning in caught))


class _Recordings(Mapping[str, Measurement | PellicleError]):
    """The curves of a file by their numbers, each read whenever it is taken."""

    def __init__(
        self,
        path: Path,
        recordings: Sequence[Mapping[str, Any]],
        overrides: Mapping[str, float],
        segment: str,
        messages: tuple[str, ...],
    ) -> None:
        self._path, self._overrides, self._segment = path, overrides, segment
        self._messages = messages
        self._recordings = {
            "" if len(recordings) == 1 else str(recording["metadata"]["enum"]): recording
            for recording in recordings
        }

    def __len__(self) -> int:
        return len(self._recordings)

    def __iter__(self) -> Iterator[str]:
        return iter(self._recordings)

    def __getitem__(self, label: str) -> Measurement | PellicleError:
        recording = self._recordings[label]
        try:
            with warnings.catch_warnings(record=True) as caught, _pellicle_errors(self._path):
                warnings.simplefilter("always")
                curve = _curve(self._path, recording, self._overrides, self._segment)
        except PellicleError as error:
            return error
        messages = tuple(dict.fromkeys((*self._messages, *_texts(caught), *curve.messages)))
        return replace(curve, messages=messages)


@contextmanager
def _pellicle_errors(path: Path) -> Iterator[None]:
    """Raise the errors of afmformats, some of which are not Exceptions, as errors of pellicle."""
    from afmformats import errors, meta

    try:
        yield
    except PellicleError:
        raise
    except errors.MissingMetaDataError as error:
        raise ConfigError(
            f"{path}: holds no {' and '.join(error.meta_keys)}; give spring_constant and "
            "sensitivity with their units (--spring-constant and --sensitivity on the command line)"
        ) from None
    except (Exception, errors.AFMFileFormatError, meta.MetaDataMissingError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise StorageError(f"{path}: afmformats cannot read it ({reason})") from None


def _curve(
    path: Path, recording: Mapping[str, Any], overrides: Mapping[str, float], segment: str
) -> Measurement:
    """Return one segment of one curve in SI."""
    data, metadata = recording["data"], recording["metadata"]
    for name, value in overrides.items():
        if not np.isclose(metadata.get(name, value), value, rtol=1e-6):
            raise ConfigError(
                f"{path}: holds a {name} of {metadata[name]:g} already, and this format takes no "
                "other; leave it out",
                name.replace(" ", "_"),
            )
    force = np.asarray(data["force"], dtype=float)
    stiffness = metadata.get(_SPRING, overrides.get(_SPRING))
    if _TIP in data:
        tip, source = np.asarray(data[_TIP], dtype=float), _TIP
    else:
        height = next((name for name in _HEIGHTS if name in data), None)
        if height is None:
            raise ConfigError(f"{path}: has no height over the sample (has {', '.join(data)})")
        bending = force / Calibration(spring_constant=stiffness).required_spring_constant()
        tip, source = np.asarray(data[height], dtype=float) + bending, height
    rows: Any = slice(None)
    if "segment" in data and segment != "both":
        rows = _rows_of(np.asarray(data["segment"]), tip, segment)
    used = {"position": f"{source} [m]", "force": "force [N]"}
    time = np.asarray(data["time"], dtype=float)[rows] if "time" in data else None
    messages: tuple[str, ...] = ()
    if time is not None and not grows(time):
        messages = (unused_time(Channel("s", time)),)
        time = None
    origin = CurveOrigin(
        columns=used if time is None else used | {"time": "time [s]"},
        sensitivity=metadata.get("sensitivity", overrides.get("sensitivity")),
        library="afmformats",
    )
    site = _site(metadata)
    return Measurement(
        -tip[rows],
        force[rows],
        messages=messages,
        stiffness=stiffness,
        time=time,
        origin=origin,
        site=site,
    )


def _rows_of(segments: Array, tip: Array, segment: str) -> Mask:
    """Return the rows of the approach or of the retract, between which there may be pauses.

    The approach is the first segment that falls by half of the largest motion, the retract the last
    that rises by as much; in a file without such segments they are the first and the last.
    """
    numbers = np.unique(segments)
    motions = np.array([np.ptp(tip[segments == number][[0, -1]]) for number in numbers])
    down = np.array([float(np.diff(tip[segments == number][[0, -1]])[0]) < 0 for number in numbers])
    far = motions >= _FAR * motions.max()
    if segment == "approach":
        chosen = next(iter(numbers[far & down]), numbers[0])
    else:
        chosen = next(iter(numbers[far & ~down][::-1]), numbers[-1])
    mask: Mask = segments == chosen
    return mask


def _site(metadata: Mapping[str, Any]) -> Site | None:
    """Return where on the sample a curve was measured; None if the file does not say it."""
    try:
        x, y = (_length(metadata.get(f"position {axis}")) for axis in "xy")
    except ValueError:
        return None
    try:
        along_x, along_y = (_axis(metadata, axis) for axis in "xy")
    except (TypeError, ValueError):
        return Site(x, y)
    return Site(x, y, (along_x, along_y))


def _axis(metadata: Mapping[str, Any], axis: str) -> Axis:
    """Return the positions along one edge of a map, whose size includes half a pixel beyond."""
    centre, size = (_length(metadata.get(f"grid {name} {axis}")) for name in ("center", "size"))
    count = int(metadata.get(f"grid shape {axis}", 0))
    if count < 1 or size <= 0:
        raise ValueError("the grid has no extent")
    pitch = size / count
    return Axis(centre - size / 2 + pitch / 2, pitch, count)


def _length(value: object) -> float:
    """Return a length [m], which files that were converted may hold as text with a unit."""
    return Quantity("m")(value)
