"""The identity of a run, and the origin of its result: all packages used, and the date."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from pellicle.components import Component
from pellicle.components.installed import registry
from pellicle.files import for_document, is_file
from pellicle.plugins.component import components_in
from pellicle.schema.model import get, replace_at, walk

if TYPE_CHECKING:
    from .run import Run

# Increment if an equal configuration gives different numbers, not if the file layout changes.
_NUMBERS_VERSION: Final = 1


def identity_of(run: Run) -> str:
    """Return `Run.identity`."""
    identifying = run.model_dump(mode="json", exclude_none=True, exclude={"title", "outputs"})
    identifying["schema"] = _NUMBERS_VERSION
    used = {*map(type, components_in([getattr(run.loading, "prescription", None)]))}
    for path, value, _ in walk(run):
        if isinstance(value, Component) and not path.startswith("outputs."):
            used.add(type(value))
        if isinstance(value, Path) and isinstance(get(identifying, path), str):
            stat = value.stat() if is_file(value) else None
            content = stat and _digest(value.absolute(), stat.st_mtime_ns, stat.st_size)
            identifying = replace_at(identifying, path, content or str(value))
    versions = registry().versions(used)
    if others := {name: number for name, number in versions.items() if name != "pellicle"}:
        identifying["plugins"] = others
    return hashlib.sha256(json.dumps(identifying, sort_keys=True).encode()).hexdigest()


@cache
def _digest(path: Path, changed: int, size: int) -> str:
    """Return the hash of a file, cached because the runs of a study may share a large file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def provenance(run: Run) -> dict[str, Any]:
    """Return the origin of a result as attributes of its dataset."""
    return {
        "title": for_document(run.title),
        "configuration": run.to_json(),
        "identity": run.identity,
        **facts_of([run]),
        **now_with([run]),
    }


def facts_of(runs: Sequence[Run]) -> dict[str, Any]:
    """Return what readers of results need to know of their configuration, as attributes.

    Of the runs of a study, they are those of the first run, except that ``boundary`` is periodic
    and ``adheres`` is 1 where any run's is, and ``planned_steps`` is the largest.
    """
    return {
        "prescribed": runs[0].prescribed,
        "planned_steps": max(run.steps for run in runs),
        "boundary": "periodic" if any(run.grid.boundary == "periodic" for run in runs) else "free",
        "tolerance": runs[0].solver.tolerance,
        "adheres": int(any(run.interaction for run in runs)),
    }


def now_with(runs: Iterable[Run]) -> dict[str, str]:
    """Return the date, and the versions of the packages that solve ``runs``, as attributes."""
    used = components_in(
        part for run in runs for part in (run, getattr(run.loading, "prescription", None))
    )
    numbers = registry().all_versions({*map(type, used)})
    return {
        "versions": ", ".join(f"{name} {number}" for name, number in numbers.items()),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }
