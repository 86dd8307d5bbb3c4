"""Summaries of the table of a study: parameters, progress and failures of its runs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pellicle.contact.caveats import Status, by_phrase, from_text
from pellicle.errors import first_of
from pellicle.results.derived import DERIVED
from pellicle.results.dimensions import parts
from pellicle.results.wording import Wording, means_something, wording
from pellicle.variables import BEYOND_THEORY, CAVEATS, names_of

if TYPE_CHECKING:
    import xarray as xr

_FAILURES = {
    "failed": "failed",
    "NOT CONVERGED": "did not converge",
    "not run": "were not finished",
}
"""Phrases for messages such as "3 did not converge", by verdict."""
_OF_PATHS = ["pull_off", "pull_off_accuracy", "detach", "jump_in", "dissipated_energy"]
_OF_CYCLES = ["storage_stiffness", "loss_stiffness", "phase", "cycle_dissipation"]
_LEAST_LETTERS = 8
Columns = list[tuple[str, list[str]]]
"""Head and cells of each column."""
_BEYOND = "a contact is far beyond the theory or its cells"
_WORST_FIRST = "failed", "not run", "NOT CONVERGED"


def columns(table: xr.Dataset, *, si: bool = False) -> Columns:
    """Return head and cells of the table of runs: parameters, main numbers and verdict."""
    main = [n for n in names_of("main") if means_something(table, n)]
    names = [n for n in (*main, *_derived(table)) if n in table and "step" in table[n].dims]
    runs = list(runs_of(table))
    progress = [progress_of(run) for run in runs]
    last: Columns = []
    for name in names:
        column = wording(table[name], si=si)
        cells = [
            column.number(run[name].values[done - 1].item()) if done else ""
            for run, (done, *_) in zip(runs, progress, strict=True)
        ]
        last.append((column.head, cells))
    return [
        ("run", list(map(str, range(1, len(runs) + 1)))),
        *(
            (axis.head, [axis.number(run[name].item()) for run in runs])
            for name, axis in _axes(table, si=si).items()
        ),
        ("steps", [f"{done}/{planned}" for done, planned, _ in progress]),
        *last,
        ("status", [verdict for *_, verdict in progress]),
        ("file", short_files(table)),
    ]


def path_columns(table: xr.Dataset, *, si: bool = False) -> Columns:
    """Return the main numbers of the whole path of each run; no columns where it has none."""
    per_run = [n for n in _derived(table) if n in table and "step" not in table[n].dims]
    names = [n for n in (*_OF_PATHS, *_OF_CYCLES, *per_run) if n in table]
    runs = list(runs_of(table))
    shown = [("run", list(map(str, range(1, len(runs) + 1))))]
    for name in names:
        column = wording(table[name], si=si)
        shown.append((column.head, [column.number(run[name].item()) for run in runs]))
    return shown if names else []


def _derived(table: xr.Dataset) -> list[str]:
    return list(json.loads(table.attrs[DERIVED]))


def _axes(table: xr.Dataset, *, si: bool = False) -> dict[str, Wording]:
    """Return how each varied parameter is shown."""
    return {str(n): wording(table[n], si=si) for n in table.coords if n != "step"}


def run_names(table: xr.Dataset) -> list[str]:
    """Return the values that distinguish each run, such as "surface tension 30 mN/m"."""
    axes = _axes(table).items()
    return [", ".join(axis.text(run[n].item()) for n, axis in axes) for run in runs_of(table)]


def short_files(table: xr.Dataset) -> list[str]:
    """Return the names of the files of runs, cut after the letters that differ, but at least 8."""
    names = [str(run["run"].item()) for run in runs_of(table)]
    lengths = range(_LEAST_LETTERS, max(map(len, names), default=_LEAST_LETTERS) + 1)
    least = next((n for n in lengths if len({name[:n] for name in names}) == len({*names})), None)
    return [f"{name[:least]}…" if least and least < len(name) else name for name in names]


def progress_of(run: xr.Dataset) -> tuple[int, int, str]:
    """Return the number of finished steps, of planned steps, and the worst verdict of a run."""
    statuses = _statuses(run)[0]
    verdicts = {status.verdict for status in statuses}
    worst = next((verdict for verdict in _WORST_FIRST if verdict in verdicts), "converged")
    done = sum(status not in (Status.NOT_RUN, Status.FAILED) for status in statuses)
    return done, len(statuses), worst


def reasons(table: xr.Dataset) -> Iterator[str]:
    """Yield the runs that did not converge or failed, with the first status of either kind.

    Runs of equal status are one text, which names the first.
    """
    groups: dict[str, list[str]] = {}
    for name, file, run in zip(run_names(table), short_files(table), runs_of(table), strict=True):
        firsts: dict[str, str] = {}
        for status, message in zip(_statuses(run)[0], run["status"].values, strict=False):
            if not status.converged and status != Status.NOT_RUN:
                firsts.setdefault(status.verdict, str(message))
        for message in firsts.values():
            groups.setdefault(message, []).append(f"{name} (file {file})")
    for message, runs in groups.items():
        yield f"{first_of(runs)}: {message}"


def runs_of(table: xr.Dataset) -> Iterator[xr.Dataset]:
    """Yield the part of a table that belongs to each run."""
    return parts(table, table["run"].dims)


def failures(table: xr.Dataset) -> str:
    """Return a phrase on runs that failed, did not converge or were not finished, if any."""
    verdicts = [{status.verdict for status in statuses} for statuses in _statuses(table)]
    counts = {verdict: sum(verdict in run for run in verdicts) for verdict in _FAILURES}
    phrases = [f"{count} {_FAILURES[verdict]}" for verdict, count in counts.items() if count]
    return f"of {len(verdicts)} runs {', '.join(phrases)}" if phrases else ""


def caveats(table: xr.Dataset) -> Iterator[str]:
    """Yield a message for each kind of caveat: how many runs have it, and a run and a step that do.

    Of a small domain it is the step that needs the largest one.
    """
    texts = _by_run(table, CAVEATS)
    steps = (
        ((int(run), int(step) + 1), caveat)
        for run, step in zip(*np.nonzero(texts), strict=True)
        for caveat in from_text(texts[run, step])
    )
    kinds = {
        phrase: [(run, f"step {step}: {caveat.sentence}") for (run, step), caveat in group]
        for phrase, group in by_phrase(steps).items()
    }
    if BEYOND_THEORY in table:
        beyond = enumerate(table[BEYOND_THEORY].values.ravel())
        kinds[_BEYOND] = [(run, text) for run, text in beyond if text]
    names, files = run_names(table), short_files(table)
    for phrase, messages in kinds.items():
        for run, message in messages[:1]:
            yield (
                f"of {len(names)} runs, in {len({run for run, _ in messages})} {phrase}; "
                f"{names[run]} (file {files[run]}), {message}"
            )


def _statuses(table: xr.Dataset) -> list[list[Status]]:
    """Return the statuses of the steps of each run."""
    return [[Status[code] for code in run if code] for run in _by_run(table, "status_code")]


def _by_run(table: xr.Dataset, name: str) -> NDArray[Any]:
    """Return a variable of the steps, of shape (runs, steps)."""
    values = table[name].values
    return values.reshape(-1, values.shape[-1])
