"""Files of JPK, Asylum, AFM Workshop, Optics11 and NT-MDT, by afmformats (extra ``afm``)."""

from __future__ import annotations

import csv
import re
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from io import TextIOWrapper
from itertools import chain, count
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np

from pellicle.arrays import Mask
from pellicle.errors import ConfigError, PellicleError, StorageError
from pellicle.units import Quantity
from pellicle_fit.files.columns import (
    UNITS,
    Calibration,
    Column,
    check_signal,
    from_columns,
    missing_parts,
    recalibrate,
)
from pellicle_fit.files.measurement import CurvesByLabel, Measurement, Site
from pellicle_fit.files.missing import OPTIONS, MissingInputError
from pellicle_fit.files.reader import DRIVEN, Reader
from pellicle_fit.files.text_table import read_table

from .tables import Table

_JPK = (".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".jpk-qi-series")
_HDF5 = (".h5", ".hdf5")
_WORKSHOP = b"Force-Distance Curve"
_BEGINNING = 1 << 16
"""Size of the beginning of a file [bytes]."""
INSTALL = "such files are read by afmformats: install it with pip install 'pellicle[afm]'"
_CALIBRATION = {"spring constant": "spring_constant", "sensitivity": "sensitivity"}
"""What files may hold, and its name here."""
_PLACES = {"tip position": "position", "height (measured)": "height", "height (piezo)": "height"}
"""Names of places in files, and their roles."""
_NT_MDT = (
    "three columns without names are taken for height [nm] and deflection [nA] on approach and "
    "retraction, as NT-MDT's Nova exports them; if they are not, say what they are with --columns"
)


class _AFM(Reader):
    """Files that afmformats reads."""

    libraries: ClassVar[tuple[str, ...]] = ("afmformats",)
    mark: ClassVar[bytes] = b""
    """What stands at the beginning of a text of the instrument."""

    def sniff(self, path: Path) -> bool:
        """Return whether the beginning of the file has the mark."""
        if not self.mark:
            return True
        with path.open("rb") as file:
            return self.mark in file.read(_BEGINNING)

    def read(self, path: Path, calibration: Calibration) -> CurvesByLabel:
        """Return what reads each curve by its number."""
        return _read(path, calibration)


class JPK(_AFM, title="JPK"):
    """Force curves, maps and QI images of JPK and of Bruker's BioAFMs."""

    type: Literal["jpk"] = "jpk"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = _JPK


class Igor(_AFM, title="Asylum Research"):
    """Force curves of Asylum Research, as Igor's binary waves."""

    type: Literal["igor"] = "igor"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".ibw",)


class Workshop(_AFM, title="AFM Workshop"):
    """Force curves of AFM Workshop, as text."""

    type: Literal["workshop"] = "workshop"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".csv",)
    mark: ClassVar[bytes] = _WORKSHOP


class WorkshopMap(_AFM, title="map of AFM Workshop"):
    """Force maps of AFM Workshop, a zip of texts."""

    type: Literal["workshop_map"] = "workshop_map"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".zip",)


class Chiaro(_AFM, title="Optics11"):
    """Indentations of Optics11's Chiaro and Piuma, as text."""

    type: Literal["chiaro"] = "chiaro"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".txt",)
    mark: ClassVar[bytes] = b"Device:\tChiaro"


class Nova(_AFM, title="NT-MDT"):
    """Three columns without names, as NT-MDT's Nova exports them."""

    type: Literal["nova"] = "nova"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".txt",)

    def sniff(self, path: Path) -> bool:
        """Return whether a text is three columns without names."""
        with path.open("rb") as file:
            lines = file.read(_BEGINNING).splitlines()
        first = next((line for line in lines if line.strip() and line[:1] not in b"#%"), b"")
        if not re.match(rb"\s*[-+.\d]", first):
            return False
        with suppress(csv.Error):
            _, heads, _ = read_table(path, {})
            return [head.text for head in heads] == [""] * 3
        return False

    def read(self, path: Path, calibration: Calibration) -> CurvesByLabel:
        """Return what reads the only curve; what afmformats cannot read is a table."""
        try:
            return _read(path, calibration, is_nt_mdt=True)
        except StorageError:
            return Table().read(path, calibration)


class Exported(_AFM, title="export of afmformats"):
    """Curves that afmformats, nanite or PyJibe exported as HDF5."""

    type: Literal["exported"] = "exported"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = _HDF5

    def sniff(self, path: Path) -> bool:
        """Return whether a file names afmformats as its software."""
        # h5py raises these for damaged links and attributes.
        with suppress(OSError, RuntimeError, KeyError):
            return bool(_exports(path))
        return False


class ExportedTable(_AFM, title="text export of afmformats"):
    """A curve that afmformats, nanite or PyJibe exported as text."""

    type: Literal["exported_table"] = "exported_table"
    examples = ({},)
    suffixes: ClassVar[tuple[str, ...]] = (".tab",)
    mark: ClassVar[bytes] = b"# BEGIN METADATA"


_PAUSES = {3: (1,), 4: (0, 2)}
"""Places of the pauses among the segments of creep and of stress relaxation, by their number."""


def _read(path: Path, calibration: Calibration, *, is_nt_mdt: bool = False) -> CurvesByLabel:
    """Return what reads each curve, by its number, one at a time."""
    if find_spec("afmformats") is None:
        raise StorageError(f"{path}: is the file of an instrument; {INSTALL}")
    if not path.is_file():
        raise StorageError(f"{path}: cannot be read (no such file)")
    with _errors(path, is_nt_mdt):
        recordings = _calibrated(path, calibration, is_nt_mdt)
        if not recordings:
            raise ValueError("no curve")
        numbers = [str(recording["metadata"]["enum"]) for recording in recordings]
    readers: dict[str, partial[Measurement]] = {}
    # HDF5 lists curve 10 before curve 2, and the curves of an archive may share a number.
    pairs = zip(numbers, recordings, strict=True)
    for number, recording in sorted(pairs, key=lambda pair: (len(pair[0]), pair[0])):
        others = (f"{number} ({copy})" for copy in count(2))
        label = next(label for label in chain([number], others) if label not in readers)
        curve = partial(_curve, path, recording, calibration, is_nt_mdt)
        readers[label if len(recordings) > 1 else ""] = curve
    return readers


def _calibrated(path: Path, calibration: Calibration, is_nt_mdt: bool) -> list[Mapping[str, Any]]:
    """Return the recordings in a file, with what it lacks of the calibration that is given.

    The loaders of makers differ in what they do with a spring constant that they do not need.
    """
    from afmformats.errors import MissingMetaDataError

    known = {words: getattr(calibration, name) for words, name in _CALIBRATION.items()}
    # What JPK stores is the signal of the detector, and how it was converted.
    used = {"sensitivity"} if path.suffix.lower() in _JPK else set()

    def load() -> list[Mapping[str, Any]]:
        values = {words: known[words] for words in used if known[words] is not None}
        return _recordings(path, values, is_nt_mdt)

    with warnings.catch_warnings():
        # Of a curve on its own and one of a map, each is read as the other.
        warnings.filterwarnings("ignore", "Expected '.*' curve")
        try:
            recordings = load()
        except MissingMetaDataError as error:
            used |= {*error.meta_keys}
            recordings = load()
    if calibration.sensitivity is not None and "sensitivity" not in used:
        text = "is not used: the file holds forces, not the signal of a detector; leave it out"
        raise ConfigError(text, "sensitivity")
    if calibration.sensitivity is not None:
        check_signal(calibration.sensitivity, "A" if is_nt_mdt else "V")
    return recordings


def _recordings(path: Path, values: dict[str, float], is_nt_mdt: bool) -> list[Mapping[str, Any]]:
    """Return data and metadata of each curve in a file, as afmformats reads them."""
    from afmformats import formats
    from afmformats.formats.fmt_workshop.ws_single import load_csv

    suffix = path.suffix.lower()
    if suffix in _HDF5:
        reader = formats.fmt_hdf5.H5DictReader
        groups = _exports(path).items()
        return [{"data": reader(path, g), "metadata": own | {"enum": g}} for g, own in groups]
    if suffix == ".zip":
        # The loader of archives fails for places on a line, and warns of 10 before 2.
        with zipfile.ZipFile(path) as archive:
            names = [n for n in archive.namelist() if _WORKSHOP in archive.open(n).read(_BEGINNING)]
            recordings: list[Mapping[str, Any]] = []
            for name in sorted(names):
                try:
                    recordings += load_csv(TextIOWrapper(archive.open(name), "utf-8"), None, values)
                except (ValueError, LookupError) as error:
                    # One that is damaged does not hide the others.
                    recordings.append({"data": ValueError(f"{error}"), "metadata": {"enum": name}})
            return recordings
    if suffix in _JPK:
        # An archive stays open there, and would hide the file that replaces it.
        formats.fmt_jpk.jpk_reader.ArchiveCache.open_archives.pop(path, None)
    recipes = formats.formats_by_suffix[suffix]
    recipe = formats.recipe_ntmdt_txt if is_nt_mdt else formats.recipe_chiaro_txt
    loader = recipe["loader"] if suffix == ".txt" else recipes[0].loader
    return list(loader(path, meta_override=values))


def _exports(path: Path) -> dict[str, dict[str, Any]]:
    """Return the attributes of the groups in which afmformats exported curves, by their names."""
    import h5py

    with h5py.File(path) as file:
        # A link may lead nowhere.
        nodes = [(name, file.get(name)) for name in file]
        groups = ((n, of) for n, of in nodes if isinstance(of, h5py.Group) and "force" in of)
        is_export = str(file.attrs.get("software")) == "afmformats"
        return {name: dict(group.attrs) for name, group in groups if is_export}


@contextmanager
def _errors(path: Path, is_nt_mdt: bool) -> Iterator[None]:
    """Raise the errors of afmformats, some of which are not Exceptions, as those of the file."""
    from afmformats import errors, meta

    try:
        yield
    except PellicleError:
        raise
    except errors.MissingMetaDataError as error:
        calibration = _CALIBRATION | ({"sensitivity": "sensitivity [nm/nA]"} if is_nt_mdt else {})
        names = [calibration.get(word, word) for word in error.meta_keys]
        where = f"{path}: {_NT_MDT}; " if is_nt_mdt else f"{path}: "
        raise MissingInputError(where, {n: OPTIONS.get(n, "") for n in names}) from None
    except (Exception, errors.AFMFileFormatError, meta.MetaDataMissingError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        advice = "export each curve as a table or as text"
        raise StorageError(f"{path}: afmformats cannot read it ({reason}); {advice}") from None


def _curve(
    path: Path, recording: Mapping[str, Any], calibration: Calibration, is_nt_mdt: bool
) -> Measurement:
    with _errors(path, is_nt_mdt):
        data, metadata = recording["data"], recording["metadata"]
        if isinstance(data, Exception):
            raise data
        place = next((name for name in _PLACES if name in data), "")
        names = {_PLACES.get(place, ""): place, "force": "force", "time": "time"}
        columns = {
            role: Column("", name, UNITS.get(role, "m"), np.asarray(data[name], dtype=float))
            for role, name in names.items()
            if name in data
        }
        if tip := columns.get("position"):
            columns["position"] = tip._replace(values=-tip.values)
        constant = metadata.get("spring constant")
        if constant is None or (isinstance(constant, float) and not 0 < constant < np.inf):
            constant = calibration.spring_constant
        own = Calibration(spring_constant=constant, speed=calibration.speed)
        if lacks := missing_parts(columns, own):
            raise MissingInputError(f"{path}: ", {name: OPTIONS.get(name, "") for name in lacks})
        curve, site = from_columns(columns, own), None
        # Files that were converted may hold a text with a unit.
        with suppress(ValueError):
            site = Site(*(Quantity("m")(metadata.get(f"position {letter}")) for letter in "xy"))
        pause = _pause(data, metadata)
    origin = curve.origin._replace(sensitivity=metadata.get("sensitivity"), library="afmformats")
    messages = (_NT_MDT,) * is_nt_mdt + (DRIVEN,) * (place == "height (piezo)")
    curve = replace(curve, origin=origin, site=site, messages=messages, pause=pause)
    return recalibrate(curve, calibration, is_own=True)


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
