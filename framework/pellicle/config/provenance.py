"""The origin of a result: its run, the versions of all packages used, and the date."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Any

from pellicle.components.installed import registry
from pellicle.files import for_document

from .run import Run, components_in


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
