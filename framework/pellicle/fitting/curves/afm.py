"""Curves in the formats of instruments, through afmformats (extra ``afm``)."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.errors import ConfigError, PellicleError, StorageError

from .columns import Calibration
from .curve import Curve
from .origin import Origin

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
"""Least motion of a segment that is no pause, over the largest motion."""
_SPRING, _TIP = "spring constant", "tip position"
_HEIGHTS = ("height (measured)", "height (piezo)")


def installed() -> bool:
    """Return whether afmformats is installed."""
    return find_spec("afmformats") is not None


def read(path: Path, calibration: Calibration, segment: str) -> dict[str, Curve | PellicleError]:
    """Return the ``segment`` of each curve by its number; the label of a single curve is empty.

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

    given = {_SPRING: calibration.spring_constant, "sensitivity": calibration.sensitivity}
    overrides = {name: value for name, value in given.items() if value is not None}
    if not path.is_file():
        raise StorageError(f"{path}: cannot be read (no such file)")
    curves: dict[str, Curve | PellicleError] = {}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with _pellicle_errors(path):
            loader = get_recipe(path).loader
            try:
                recordings = loader(path, meta_override=overrides)
            except NotImplementedError:
                # Formats that always hold their calibration do not take another.
                recordings = loader(path)
        for recording in recordings:
            label = "" if len(recordings) == 1 else str(recording["metadata"]["enum"])
            try:
                with _pellicle_errors(path):
                    curves[label] = _curve(path, recording, overrides, segment)
            except PellicleError as error:
                curves[label] = error
    messages = tuple(dict.fromkeys(f"afmformats: {warning.message}" for warning in caught))
    return {
        label: replace(curve, messages=messages) if isinstance(curve, Curve) else curve
        for label, curve in curves.items()
    }


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
) -> Curve:
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
    time = _time(data, rows)
    origin = Origin(
        columns=used if time is None else used | {"time": "time [s]"},
        sensitivity=metadata.get("sensitivity", overrides.get("sensitivity")),
        library="afmformats",
    )
    return Curve(-tip[rows], force[rows], stiffness=stiffness, time=time, origin=origin)


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


def _time(data: Mapping[str, Any], rows: Any) -> Array | None:
    """Return the time [s]; None where the file holds none that grows."""
    if "time" not in data:
        return None
    time = np.asarray(data["time"], dtype=float)[rows]
    steps = np.diff(time)
    return time if np.isfinite(steps).all() and (steps >= 0).all() and steps.any() else None
