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

from pellicle.errors import ConfigError, PellicleError, StorageError

from .columns import Calibration
from .curve import Curve

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

    overrides = {
        name.replace("_", " "): value
        for name, value in calibration.model_dump(exclude_none=True).items()
    }
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
        tip = np.asarray(data[_TIP], dtype=float)
    else:
        height = next((name for name in _HEIGHTS if name in data), None)
        if height is None:
            raise ConfigError(f"{path}: has no height over the sample (has {', '.join(data)})")
        bending = force / Calibration(spring_constant=stiffness).required_spring_constant()
        tip = np.asarray(data[height], dtype=float) + bending
    rows: Any = slice(None)
    if "segment" in data and segment != "both":
        # The first and the last segment are the same if there is only one.
        segments = np.asarray(data["segment"])
        rows = segments == (segments.min() if segment == "approach" else segments.max())
    return Curve(-tip[rows], force[rows], stiffness=stiffness)
