"""The record of a fit: what was fitted, with which versions, and when."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain
from pathlib import Path
from time import perf_counter
from typing import Any

from pellicle import registry
from pellicle.components import Component
from pellicle.errors import ConfigError, StorageError
from pellicle.schema import walk

from .config import FitConfig
from .files.measurement import Measurement


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


def repetition(path: Path) -> FitConfig:
    """Return the configuration that the JSON of a fit, of a pool or of many fits records.

    Its curves are sought from the current folder, as they were then.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        configuration = content["configuration"]
    except OSError as error:
        raise StorageError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (ValueError, TypeError, KeyError):
        raise ConfigError(
            f"{path}: is not the JSON of a fit; give the file that pellicle fit -o leaves, such as "
            "bead-fit.json or fits.json"
        ) from None
    config = FitConfig.of(configuration)
    curves = [one for row in content.get("curves", ()) for one in row.get("curves", [row])]
    if not config.curves or any(not c.get("data", {"file": path}).get("file") for c in curves):
        raise ConfigError(
            f"{path}: holds no fit of a file; numbers that were given in Python have to be given "
            "again, with the configuration in it"
        )
    return config
