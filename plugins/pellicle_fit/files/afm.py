"""Curves in the formats of instruments, through afmformats (extra ``afm``)."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.errors import ConfigError, PellicleError, StorageError
from pellicle.units import Quantity

from .columns import Calibration, Channel, from_columns
from .measurement import Axis, Measurement, Readers, Site
from .missing import OPTIONS, MissingInputError
from .passes import labelled

_JPK = (".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".jpk-qi-series")
SUFFIXES = (*_JPK, ".ibw", ".tab", ".zip")
"""Suffixes that only instrument files have; .h5, .csv and .txt may be an instrument's too."""
INSTALL = "such files are read by afmformats: install it with pip install 'pellicle[afm]'"
_CALIBRATION = {"spring constant": "spring_constant", "sensitivity": "sensitivity"}
"""What files may hold, and its name here."""
_TIP = "tip position"
_HEIGHTS = ("height (measured)", "height (piezo)")


def installed() -> bool:
    """Return whether afmformats is installed."""
    return find_spec("afmformats") is not None


def read_instrument(path: Path, calibration: Calibration, segment: str) -> Readers:
    """Return what reads the ``segment`` of each curve, by its number, one at a time."""
    if not installed():
        raise StorageError(f"{path}: is the file of an instrument; {INSTALL}")
    from afmformats.formats import get_recipe

    given = {words: getattr(calibration, name) for words, name in _CALIBRATION.items()}
    overrides = {words: value for words, value in given.items() if value is not None}
    if not path.is_file():
        raise StorageError(f"{path}: cannot be read (no such file)")
    with _errors_and_warnings(path) as messages:
        loader = get_recipe(path).loader
        try:
            recordings = loader(path, meta_override=overrides)
        except NotImplementedError:
            # Formats that always hold their calibration do not take another.
            recordings = loader(path)
        # HDF5 lists curve 10 before curve 2.
        recordings = sorted(recordings, key=lambda recording: recording["metadata"]["enum"])
    return {
        "" if len(recordings) == 1 else str(recording["metadata"]["enum"]): partial(
            _curve, path, recording, calibration, segment, messages
        )
        for recording in recordings
    }


@contextmanager
def _errors_and_warnings(path: Path) -> Iterator[list[str]]:
    """Raise the errors of afmformats, some of which are not Exceptions, and list its warnings."""
    from afmformats import errors, meta

    texts: list[str] = []
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            yield texts
        texts += [f"afmformats: {warning.message}" for warning in caught]
    except PellicleError:
        raise
    except errors.MissingMetaDataError as error:
        raise _without(path, error.meta_keys) from None
    except (Exception, errors.AFMFileFormatError, meta.MetaDataMissingError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise StorageError(f"{path}: afmformats cannot read it ({reason})") from None


def _without(path: Path, words: Sequence[str]) -> MissingInputError:
    """Return the error of a file that does not hold its calibration."""
    names = [_CALIBRATION.get(word, word) for word in words]
    return MissingInputError(f"{path}: ", {name: OPTIONS.get(name, "") for name in names})


def _curve(
    path: Path,
    recording: Mapping[str, Any],
    calibration: Calibration,
    segment: str,
    messages: Sequence[str],
) -> Measurement:
    """Return one segment of one curve in SI."""
    with _errors_and_warnings(path) as own:
        data, metadata = recording["data"], recording["metadata"]
        known = {}
        for words, name in _CALIBRATION.items():
            given = getattr(calibration, name)
            known[name] = metadata.get(words, given)
            if given is not None and not np.isclose(known[name], given, rtol=1e-6):
                raise ConfigError(
                    f"{path}: holds a {words} of {known[name]:g} already, and this format takes no "
                    "other; leave it out",
                    name,
                )
        stiffness = known["spring_constant"]
        calibration = Calibration(spring_constant=stiffness, speed=calibration.speed)
        force = np.asarray(data["force"], dtype=float)
        source = next((name for name in (_TIP, *_HEIGHTS) if name in data), None)
        if source is None:
            raise ConfigError(f"{path}: has no height over the sample (has {', '.join(data)})")
        position = -np.asarray(data[source], dtype=float)
        if source != _TIP:
            if stiffness is None:
                raise _without(path, ["spring constant"])
            position -= force / stiffness
        columns = {"position": Channel("m", position, source), "force": Channel("N", force)}
        if "time" in data:
            columns["time"] = Channel("s", np.asarray(data["time"], dtype=float))
        if "segment" in data and segment != "both":
            labels = np.asarray(data["segment"])
            rows = labelled(position, labels, inward=segment == "approach")
            columns = {role: c._replace(values=c.values[rows]) for role, c in columns.items()}
        curve = from_columns(columns, calibration)
        site = _site(metadata)
    return replace(
        curve,
        messages=tuple(dict.fromkeys((*messages, *own, *curve.messages))),
        origin=replace(curve.origin, sensitivity=known["sensitivity"], library="afmformats"),
        site=site,
    )


def _site(metadata: Mapping[str, Any]) -> Site | None:
    """Return where on the sample a curve was measured; None if the file does not say it."""

    def length(name: str) -> float:
        # Files that were converted may hold a text with a unit.
        return Quantity("m")(metadata.get(name))

    def axis(letter: str) -> Axis:
        # The size includes half a pixel beyond the first position and the last.
        centre, size = length(f"grid center {letter}"), length(f"grid size {letter}")
        count = int(metadata.get(f"grid shape {letter}", 0))
        if count < 1 or size <= 0:
            raise ValueError("the grid has no extent")
        pitch = size / count
        return Axis(centre - size / 2 + pitch / 2, pitch, count)

    try:
        x, y = length("position x"), length("position y")
    except ValueError:
        return None
    try:
        return Site(x, y, (axis("x"), axis("y")))
    except (TypeError, ValueError):
        return Site(x, y)
