"""The record of a fit: what was fitted, with which versions, when; and the same fit again."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

from pellicle import registry
from pellicle.components import Component
from pellicle.errors import ConfigError, StorageError
from pellicle.schema import walk

from .config import FitConfig
from .files.measurement import Measurement
from .files.readers import sha256

_ABOVE = 2
"""Folders above that of a record in which its curves are sought."""


@dataclass(frozen=True)
class Record:
    """When a fit was made, and with which versions."""

    versions: Mapping[str, str]
    """Version of each package that the fit used."""
    date: str
    wall_time: float
    """[s]"""

    def to_dict(self) -> dict[str, Any]:
        """Return versions, date and time as JSON data."""
        return vars(self) | {"versions": dict(self.versions)}


class Stopwatch:
    """Makes the record of a fit that began when it was created."""

    def __init__(self) -> None:
        self._began = perf_counter()

    def record(self, config: FitConfig, data: Iterable[dict[str, Any]]) -> Record:
        """Return the record of a fit of curves with these `data_of`, which ends now."""
        libraries = {entry["library"] for entry in data if entry["library"]}
        return Record(
            registry().all_versions(components_of(config), libraries),
            datetime.now(UTC).isoformat(timespec="seconds"),
            round(perf_counter() - self._began, 3),
        )


def data_of(curve: Measurement, config: FitConfig) -> dict[str, Any]:
    """Return the origin of a curve, and which part of it is fitted, as JSON data."""
    return {
        **curve.origin.to_dict(),
        "spring_constant": curve.stiffness,
        "segment": config.segment,
        "baseline": config.baseline,
        "poissons_ratio": config.poissons_ratio,
    }


def components_of(config: FitConfig) -> set[type[Component]]:
    """Return the components that a fit uses; of some only the tables are known."""
    fields = walk({"indenter": config.indenter, "kernel": config.kernel})
    types = {value for path, value, _ in fields if path.endswith(".type")}
    named = {
        registered.component
        for family in registry().components.values()
        for name, registered in family.items()
        if name in types
    }
    objects = config.indenter, config.executor, *config.model, *chain(*config.rivals)
    return named | {type(entry) for entry in objects if isinstance(entry, Component)}


class Repetition(NamedTuple):
    """A fit to repeat."""

    config: FitConfig
    sha256: Mapping[str, str]
    """Hash of each file that was fitted, by its path as it was given."""
    versions: Mapping[str, str]

    def difference(self, content: Mapping[str, Any]) -> str:
        """Return how files and versions of the JSON data of fits differ; empty if they do not."""
        now = _hashes(content)
        files = sorted(now.keys() | self.sha256.keys())
        differs = [file for file in files if now.get(file) != self.sha256.get(file)]
        differs += [
            f"{name} {version} (was {self.versions[name]})"
            for name, version in content.get("versions", {}).items()
            if self.versions.get(name) not in (None, version)
        ]
        return f"not what was fitted then: {', '.join(differs)}" if differs else ""


def repetition(path: Path) -> Repetition:
    """Return what the JSON file of a fit, of a pool or of many fits says was fitted.

    Its curves are sought from the current folder, from that of the file, and from those above it;
    those whose hashes are the recorded ones are preferred.

    Raises
    ------
    ConfigError
        The file is not the JSON of a fit, or the curves were not read from files.
    StorageError
        The file cannot be read.
    """
    content = content_of(path)
    hashes = _hashes(content)
    if not hashes:
        raise ConfigError(
            f"{path}: holds no fit of a file; numbers that were given in Python have to be given "
            "again, with FitConfig.from_json"
        )
    config = FitConfig.from_json(json.dumps(content))
    file, digest = next(iter(hashes.items()))
    folders = [Path(), *path.resolve().parents[: 1 + _ABOVE]]
    folders = [folder for folder in folders if (folder / file).is_file()]
    if not folders:
        raise StorageError(
            f"{file}: is not there, nor in the folder of {path} or above it; call pellicle where "
            "the fit was made"
        )
    folder = next((f for f in folders if sha256(f / file) == digest), folders[0])
    if folder != Path():
        hashes = {str(folder / file): digest for file, digest in hashes.items()}
        config = FitConfig.merged(config, curves=tuple(folder / curve for curve in config.curves))
    return Repetition(config, hashes, content.get("versions", {}))


def _hashes(content: Mapping[str, Any]) -> dict[str, str]:
    """Return the hash of each file of the JSON data of a fit, of a pool or of many fits."""
    found: dict[str, str] = {}
    for row in content.get("curves", ()):
        data = row.get("data", {})
        found |= {data["file"]: data["sha256"]} if data.get("file") else _hashes(row)
    return found


def content_of(path: Path) -> dict[str, Any]:
    """Return what the JSON file of a fit holds; it raises what `repetition` does."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError:
        content = None
    if not isinstance(content, dict) or not isinstance(content.get("configuration"), dict):
        raise ConfigError(
            f"{path}: is not the JSON of a fit; give the file that pellicle fit -o leaves, such as "
            "bead-fit.json or fits.json"
        )
    return content
