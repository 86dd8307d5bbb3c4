"""Sentences: what a run or a study will do, what became of it, and what its maps show."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.arrays import Dataset
from pellicle.config.describe import inputs, words_at
from pellicle.config.run import Run
from pellicle.contact.caveats import Status, by_phrase, from_text
from pellicle.errors import first_of
from pellicle.results.derived import configuration_of
from pellicle.results.runs import axes_of, by_run, runs_of, short_files, statuses_of
from pellicle.results.status import status_of_run as status_of_run
from pellicle.results.wording import column_of
from pellicle.schema.expression import formula
from pellicle.units import decimal
from pellicle.variables import CAVEATS, words_of_name

if TYPE_CHECKING:
    from pellicle.runs.validation import CheckedCase

_FAILURES = {
    "failed": "failed",
    "NOT CONVERGED": "did not converge",
    "not run": "were not finished",
}
"""Phrases for messages such as "3 did not converge", by verdict."""


def status_of_study(table: Dataset) -> tuple[str, bool | None, list[str]]:
    """Return what became of a study, whether all is well, None with reservations, and details."""
    failed, warnings = failures(table), [*caveats(table)]
    if failed:
        return f"{failed[0].upper()}{failed[1:]}.", False, [*reasons(table), *warnings]
    converged = f"Every step of all {table['run'].size} runs converged."
    return converged, None if warnings else True, warnings


def run_names(table: Dataset) -> list[str]:
    """Return the values that distinguish each run, such as "surface tension 30 mN/m"."""
    axes = {name: column_of(table[name]) for name in axes_of(table)}
    return [
        ", ".join(axis.text(run[name].item()) for name, axis in axes.items())
        for run in runs_of(table)
    ]


def reasons(table: Dataset) -> Iterator[str]:
    """Yield the runs that did not converge or failed, with the first status of either kind.

    Runs of equal status are one text, which names the first.
    """
    groups: dict[str, list[str]] = {}
    for name, file, run in zip(run_names(table), short_files(table), runs_of(table), strict=True):
        firsts: dict[str, str] = {}
        for status, message in zip(statuses_of(run)[0], run["status"].values, strict=False):
            if not status.converged and status != Status.NOT_RUN:
                firsts.setdefault(status.verdict, str(message))
        for message in firsts.values():
            groups.setdefault(message, []).append(f"{name} (file {file})")
    for message, runs in groups.items():
        yield f"{first_of(runs)}: {message}"


def failures(table: Dataset) -> str:
    """Return a phrase on runs that failed, did not converge or were not finished, if any."""
    verdicts = [{status.verdict for status in statuses} for statuses in statuses_of(table)]
    counts = {verdict: sum(verdict in run for run in verdicts) for verdict in _FAILURES}
    phrases = [f"{count} {_FAILURES[verdict]}" for verdict, count in counts.items() if count]
    return f"of {len(verdicts)} runs {', '.join(phrases)}" if phrases else ""


def caveats(table: Dataset) -> Iterator[str]:
    """Yield a message for each kind of caveat: how many runs have it, and a run and a step that do.

    Of a small domain it is the step that needs the largest one.
    """
    texts = by_run(table, CAVEATS)
    steps = (
        ((int(run), int(step) + 1), caveat)
        for run, step in zip(*np.nonzero(texts), strict=True)
        for caveat in from_text(texts[run, step])
    )
    names, files = run_names(table), short_files(table)
    for phrase, group in by_phrase(steps).items():
        (run, step), caveat = group[0]
        yield (
            f"of {len(names)} runs, in {len({run for (run, _), _ in group})} {phrase}; "
            f"{names[run]} (file {files[run]}), step {step}: {caveat.sentence}"
        )


def caption_of_setup(configuration: Mapping[str, Any], label: str) -> str:
    """Return the caption of the indenter over the surface in a load step."""
    values = {i.name: i.value for i in inputs(configuration, Run)}
    if "load" in values:
        return f"A {values['load']} on the {values['kernel']}, at {label}; heights stretched."
    return f"The {values['indenter']} on the {values['kernel']}, at {label}; heights stretched."


def outcome_of_cases(cases: Sequence[CheckedCase], kernels: Iterable[str]) -> str:
    """Return how many cases failed, and the kernels among ``kernels`` that none is about."""
    failed, count = sum(not checked.passed for checked in cases), len(cases)
    passed = f"{failed} of {count} cases failed" if failed else f"all {count} cases passed"
    solved = {checked.case.configuration["kernel"]["type"] for checked in cases}
    others = ", ".join(sorted({*kernels} - solved))
    return f"{passed}; no case is about the kernels {others}" if others else passed


def work_summary(files: Sequence[Path], resumed: int, whole: str, seconds: float) -> Iterator[str]:
    """Yield how much was done before, the files that were written, and how long all took."""
    if resumed:
        yield f"{resumed} of {whole} were done before (--overwrite starts over)"
    for path in files:
        yield f"wrote {path}"
    yield f"took {decimal(seconds, 2)} s"


def shared_among_processes(runs: int, seconds: float) -> str:
    """Return that runs that would take long are shared among processes."""
    return (
        f"the other {runs} runs would take {seconds:.0f} s here: they go to processes, as many as "
        "cores and memory allow (study.executor decides otherwise)"
    )


def interruption_place(finished: str, folder: Path) -> str:
    """Return where an interruption left the ``finished`` steps or runs."""
    return f"interrupted; finished {finished} are in {folder}, and the same command continues"


def larger_domain(file: Path, folder: Path) -> str:
    """Return how to solve a run on a domain that holds its contacts."""
    return (
        f"`pellicle check {file}` finds a grid.size that holds the contact of every step; -o DIR "
        f"solves it in another folder, --overwrite in place of the result in {folder}"
    )


def in_words(text: str, data: Dataset) -> str:
    """Return an expression over a result or a table with words in place of its names."""
    configuration = configuration_of(data)

    def words(name: str) -> str:
        if name in data.variables:
            return column_of(data[name]).words
        return words_at(configuration, Run, name) if "." in name else words_of_name(name)

    return formula(text, words)
