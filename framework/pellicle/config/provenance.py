"""Where a result comes from: its run, the versions of what solved it, and the date."""

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
    """Return the attributes that say where a result comes from."""
    return {
        "title": for_document(run.title),
        "configuration": run.to_json(),
        "identity": run.identity,
        **now_with([run]),
    }


def now_with(runs: Iterable[Run]) -> dict[str, str]:
    """Return the date, and the versions of what solves ``runs``, as attributes of a result."""
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
        # A worker that is handed what a library read may be without it.
        with suppress(PackageNotFoundError):
            versions[name] = version(name)
    return {
        "versions": ", ".join(f"{name} {number}" for name, number in versions.items()),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }
