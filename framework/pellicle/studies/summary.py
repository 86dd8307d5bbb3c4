"""Summaries of the table of a study: parameters, progress and failures of its runs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from pellicle.results.status import Status
from pellicle.results.variables import names_of

if TYPE_CHECKING:
    import xarray as xr

_FAILURES = {
    "failed": "failed",
    "NOT CONVERGED": "did not converge",
    "not run": "were not finished",
}
"""Phrases for messages such as "3 did not converge", by verdict."""
_EVENTS = (
    *("pull_off", "detach", "jump_in", "dissipated_energy"),
    *("storage_stiffness", "loss_stiffness", "phase", "cycle_dissipation"),
)
_WORST_FIRST = "failed", "not run", "NOT CONVERGED"


def rows(table: xr.Dataset) -> list[dict[str, str]]:
    """Return a row for each run: parameters, main numbers of the last step, and verdict."""
    derived = json.loads(table.attrs["configuration"])["study"].get("derived", {})
    lines = []
    for run in runs_of(table):
        done, planned, verdict = progress_of(run)
        last = {
            name: f"{run[name].values[done - 1]:.6g}" if done and name in run else ""
            for name in (*names_of("main"), *derived)
            if name not in run or "step" in run[name].dims
        }
        lines.append(
            {
                "run": str(run["run"].item()),
                **_parameters(run),
                "steps": f"{done}/{planned}",
                **last,
                "status": verdict,
            }
        )
    return lines


def paths(table: xr.Dataset) -> list[dict[str, str]]:
    """Return a row for each run with the main numbers of its whole path, where it has any."""
    derived = json.loads(table.attrs["configuration"])["study"].get("derived", {})
    per_run = [n for n in derived if n in table and "step" not in table[n].dims]
    names = [n for n in (*_EVENTS, *per_run) if n in table]
    return [
        {
            "run": str(run["run"].item()),
            **{name: "" if np.isnan(run[name]) else f"{run[name].item():.6g}" for name in names},
        }
        for run in runs_of(table)
        if names
    ]


def progress_of(run: xr.Dataset) -> tuple[int, int, str]:
    """Return the number of finished steps, of planned steps, and the worst verdict of a run."""
    statuses = _statuses(run)[0]
    verdicts = {status.verdict for status in statuses}
    worst = next((verdict for verdict in _WORST_FIRST if verdict in verdicts), "converged")
    done = sum(status not in (Status.NOT_RUN, Status.FAILED) for status in statuses)
    return done, len(statuses), worst


def reasons(table: xr.Dataset) -> Iterator[str]:
    """Yield the name of each run that failed or did not converge, with its first bad status."""
    for run in runs_of(table):
        statuses = _statuses(run)[0]
        bad = next((n for n, status in enumerate(statuses) if not status.converged), None)
        if bad is not None and statuses[bad] != Status.NOT_RUN:
            where = ", ".join(f"{name} = {text}" for name, text in _parameters(run).items())
            yield f"{run['run'].item()} ({where}): {run['status'].values[bad]}"


def runs_of(table: xr.Dataset) -> Iterator[xr.Dataset]:
    """Yield the part of a table that belongs to each run."""
    sizes = table["run"].sizes
    for index in np.ndindex(*sizes.values()):
        yield table.isel(dict(zip(sizes, index, strict=True)))


def _parameters(run: xr.Dataset) -> dict[str, str]:
    values = {str(name): value.item() for name, value in run.coords.items() if name != "step"}
    return {n: f"{v:.6g}" if isinstance(v, float) else str(v) for n, v in values.items()}


def failures(table: xr.Dataset) -> str:
    """Return a phrase on runs that failed, did not converge or were not finished, if any."""
    verdicts = [{status.verdict for status in statuses} for statuses in _statuses(table)]
    counts = {verdict: sum(verdict in run for run in verdicts) for verdict in _FAILURES}
    parts = [f"{count} {_FAILURES[verdict]}" for verdict, count in counts.items() if count]
    return f"of {len(verdicts)} runs {', '.join(parts)}" if parts else ""


def caveats(table: xr.Dataset) -> Iterator[str]:
    """Yield a message for each caveat, with the number of runs that have it."""
    statuses = _statuses(table)
    for caveat, reason in (
        (
            {status for status in Status if status.is_coarse},
            "the cells are too coarse for this contact",
        ),
        ({Status.STEEP}, "slopes in contact are beyond the theory"),
        ({Status.SMALL_DOMAIN}, "the domain is small for a skin on a solid that relaxes"),
    ):
        if count := sum(not caveat.isdisjoint(run) for run in statuses):
            yield f"of {len(statuses)} runs, in {count} {reason}"


def _statuses(table: xr.Dataset) -> list[list[Status]]:
    """Return the statuses of the steps of each run."""
    codes = table["status_code"].values
    return [[Status[code] for code in run if code] for run in codes.reshape(-1, codes.shape[-1])]
