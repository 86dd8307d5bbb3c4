"""The origin of a result: its run, the versions of all packages used, and the date."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from contextlib import suppress
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from pellicle.components import Component
from pellicle.files import for_document
from pellicle.plugins import registry

from .run import Run, components_in


def provenance(run: Run) -> dict[str, Any]:
    """Return the origin of a result as attributes of its dataset."""
    return {
        "title": for_document(run.title),
        "configuration": run.to_json(),
        "identity": run.identity,
        "depth_to_base": run.kernel.depth_to_base(),
        **now_with([run]),
    }


def now_with(runs: Iterable[Run]) -> dict[str, str]:
    """Return the date, and the versions of the packages that solve ``runs``, as attributes."""
    used = components_in(part for run in runs for part in (run, run.loading.prescription))
    numbers = versions({*map(type, used)})
    return {
        "versions": ", ".join(f"{name} {number}" for name, number in numbers.items()),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def versions(used: Collection[type[Component]], others: Iterable[str] = ()) -> dict[str, str]:
    """Return the version of pellicle, of the owners of components, of their and other libraries."""
    libraries = sorted({*others, *(name for component in used for name in component.libraries)})
    numbers = {name: version(name) for name in ("pellicle", "numpy", "scipy")}
    numbers |= registry().versions(used)
    for name in libraries:
        # A worker may receive data that a library has read without having the library itself.
        with suppress(PackageNotFoundError):
            numbers[name] = version(name)
    return numbers
