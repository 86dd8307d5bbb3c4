"""Curves in the formats of instruments, through afmformats (extra ``afm``)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from pellicle.arrays import Mask
from pellicle.errors import PellicleError, StorageError
from pellicle.units import Quantity

from .columns import UNITS, Calibration, Column, from_columns, lacking
from .measurement import Measurement, Readers, Site
from .missing import OPTIONS, MissingInputError

_JPK = (".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".jpk-qi-series")
SUFFIXES = (*_JPK, ".ibw", ".tab", ".zip")
"""Suffixes that only instrument files have; .h5, .csv and .txt may be an instrument's too."""
INSTALL = "such files are read by afmformats: install it with pip install 'pellicle[afm]'"
_CALIBRATION = {"spring constant": "spring_constant", "sensitivity": "sensitivity"}
"""What files may hold, and its name here."""
_PLACES = {"tip position": "position", "height (measured)": "height", "height (piezo)": "height"}
"""Names of places in files, and their roles."""

_PAUSES = {3: (1,), 4: (0, 2)}
"""Places of the pauses among the segments of creep and of stress relaxation, by their number."""


def read_instrument(path: Path, calibration: Calibration) -> Readers:
    """Return what reads each curve, by its number, one at a time."""
    if find_spec("afmformats") is None:
        raise StorageError(f"{path}: is the file of an instrument; {INSTALL}")
    from afmformats.formats import get_recipe

    given = {words: getattr(calibration, name) for words, name in _CALIBRATION.items()}
    override = {words: value for words, value in given.items() if value is not None}
    if not path.is_file():
        raise StorageError(f"{path}: cannot be read (no such file)")
    with _errors(path):
        recordings = get_recipe(path).loader(path, meta_override=override)
        # HDF5 lists curve 10 before curve 2.
        recordings = sorted(recordings, key=lambda recording: recording["metadata"]["enum"])
    return {
        "" if len(recordings) == 1 else str(recording["metadata"]["enum"]): partial(
            _curve, path, recording, calibration.speed
        )
        for recording in recordings
    }


@contextmanager
def _errors(path: Path) -> Iterator[None]:
    """Raise the errors of afmformats, some of which are not Exceptions, as those of the file."""
    from afmformats import errors, meta

    try:
        yield
    except PellicleError:
        raise
    except errors.MissingMetaDataError as error:
        names = [_CALIBRATION.get(word, word) for word in error.meta_keys]
        raise MissingInputError(f"{path}: ", {n: OPTIONS.get(n, "") for n in names}) from None
    except (Exception, errors.AFMFileFormatError, meta.MetaDataMissingError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise StorageError(f"{path}: afmformats cannot read it ({reason})") from None


def _curve(path: Path, recording: Mapping[str, Any], speed: float | None) -> Measurement:
    with _errors(path):
        data, metadata = recording["data"], recording["metadata"]
        place = next((name for name in _PLACES if name in data), "")
        names = {_PLACES.get(place, ""): place, "force": "force", "time": "time"}
        columns = {
            role: Column("", name, UNITS.get(role, "m"), np.asarray(data[name], dtype=float))
            for role, name in names.items()
            if name in data
        }
        if tip := columns.get("position"):
            columns["position"] = tip._replace(values=-tip.values)
        own = Calibration(spring_constant=metadata.get("spring constant"), speed=speed)
        if lacks := lacking(columns, own):
            raise MissingInputError(f"{path}: ", {name: OPTIONS.get(name, "") for name in lacks})
        curve, site = from_columns(columns, own), _site(metadata)
    origin = curve.origin._replace(sensitivity=metadata.get("sensitivity"), library="afmformats")
    return replace(curve, origin=origin, site=site, pause=_pause(data, metadata))


def _pause(data: Mapping[str, Any], metadata: Mapping[str, Any]) -> Mask | None:
    """Return which rows are of a pause; afmformats numbers segments and does not name them."""
    if "segment" not in data:
        return None
    segment = np.asarray(data["segment"])
    place = np.cumsum(np.append(False, segment[1:] != segment[:-1]))
    count = int(place[-1]) + 1
    pauses = _PAUSES.get(count, ()) if len({*segment.tolist()}) == count else ()
    if count == 2 and "duration intermediate" in metadata:
        pauses = (int("duration approach" in metadata),)
    return np.isin(place, pauses) if pauses else None


def _site(metadata: Mapping[str, Any]) -> Site | None:
    try:
        # Files that were converted may hold a text with a unit.
        return Site(*(Quantity("m")(metadata.get(f"position {letter}")) for letter in "xy"))
    except ValueError:
        return None
