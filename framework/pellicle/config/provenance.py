"""The origin of a result: its run, the versions of all packages used, and the date."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from pellicle.components import Component
from pellicle.files import for_document
from pellicle.model.paths import walk
from pellicle.plugins import registry

from .run import Run


def provenance(run: Run) -> dict[str, str]:
    """Return the origin of a result as attributes of its dataset."""
    return {
        "title": for_document(run.title),
        "configuration": run.to_json(),
        "identity": run.identity,
        **now_with([run]),
    }


def now_with(runs: Iterable[Run]) -> dict[str, str]:
    """Return the date, and the versions of the packages that solve ``runs``, as attributes."""
    used = {
        type(value)
        for run in runs
        for value in (run.loading.prescription, *(value for _, value, _ in walk(run)))
        if isinstance(value, Component)
    }
    owners = {
        registered.origin.distribution: registered.origin.version
        for family in registry().components.values()
        for registered in family.values()
        if registered.component in used
    }
    libraries = sorted({name for component in used for name in component.libraries})
    versions = {name: version(name) for name in ("pellicle", "numpy", "scipy")} | owners
    for name in libraries:
        # A worker may receive data that a library has read without having the library itself.
        with suppress(PackageNotFoundError):
            versions[name] = version(name)
    return {
        "versions": ", ".join(f"{name} {number}" for name, number in versions.items()),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }
