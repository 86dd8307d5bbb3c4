"""What the table of a study says of its runs, in lines for people."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from pellicle.results.status import Status
from pellicle.results.variables import names_of

if TYPE_CHECKING:
    import xarray as xr

_WITHOUT_NUMBERS = (Status.NOT_RUN, Status.FAILED)


def rows(made: xr.Dataset) -> list[dict[str, str]]:
    """Return a line for each run of a table: parameters, last step, and how it ended."""
    found = []
    derived = json.loads(made.attrs["configuration"])["study"].get("derived", {})
    for row in each_run(made):
        done, wanted, verdict = standing(row)
        last = {
            name: f"{row[name].values[done - 1]:.6g}" if done and name in row else ""
            for name in (*names_of("main"), *derived)
        }
        found.append(
            {
                "run": str(row["run"].item()),
                **{str(key): _text(row[key].item()) for key in row.coords if key != "step"},
                "steps": f"{done}/{wanted}",
                **last,
                "status": verdict,
            }
        )
    return found


def standing(row: xr.Dataset) -> tuple[int, int, str]:
    """Return the steps that a run of a table has, those that it should have, and its worst end."""
    statuses = [Status[code] for code in row["status_code"].values if code]
    verdicts = {status.verdict for status in statuses}
    worst = next((w for w in ("failed", "not run", "NOT CONVERGED") if w in verdicts), "converged")
    done = sum(status not in _WITHOUT_NUMBERS for status in statuses)
    return done, len(statuses), worst


def reasons(made: xr.Dataset) -> Iterator[str]:
    """Yield a line for each run of a table that is not as it should be: which, and why."""
    for row in each_run(made):
        codes = [code for code in row["status_code"].values if code]
        bad = next((n for n, code in enumerate(codes) if not Status[code].converged), None)
        if bad is not None and codes[bad] != Status.NOT_RUN.name:
            names = (name for name in row.coords if name != "step")
            where = ", ".join(f"{name} = {_text(row[name].item())}" for name in names)
            yield f"{row['run'].item()} ({where}): {row['status'].values[bad]}"


def each_run(made: xr.Dataset) -> Iterator[xr.Dataset]:
    """Yield the part of a table that is one run's."""
    sizes = made["run"].sizes
    for index in np.ndindex(*sizes.values()):
        yield made.isel(dict(zip(sizes, index, strict=True)))


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def failures(made: xr.Dataset) -> str:
    """Return how many runs of a table are not as they should be, and how; empty if all are."""
    verdicts = [{status.verdict for status in statuses} for statuses in _statuses(made)]
    messages = {
        "failed": "failed",
        "NOT CONVERGED": "did not converge",
        "not run": "were not finished",
    }
    counts = {verdict: sum(verdict in run for run in verdicts) for verdict in messages}
    parts = [f"{count} {messages[verdict]}" for verdict, count in counts.items() if count]
    return f"of {len(verdicts)} runs {', '.join(parts)}" if parts else ""


def coarse(made: xr.Dataset) -> Iterator[str]:
    """Yield in a sentence how many runs of a table have contacts that the cells do not resolve."""
    statuses = _statuses(made)
    count = sum(Status.COARSE in run for run in statuses)
    if count:
        yield f"of {len(statuses)} runs, in {count} the cells are too coarse for this contact"


def _statuses(made: xr.Dataset) -> list[list[Status]]:
    """Return the statuses of the steps of each run of a table."""
    codes = made["status_code"].values
    return [[Status[code] for code in run if code] for run in codes.reshape(-1, codes.shape[-1])]
