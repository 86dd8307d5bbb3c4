"""A part of a population: the curves that one of several processes fits, each under a lock."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from pellicle.batch import Part, lock_files
from pellicle.components import Say
from pellicle.errors import StorageError

from .population.row import Row
from .problem import FitProblem
from .representatives import Near
from .sealed_json import read_sealed, write_sealed
from .selection.neighbour import Neighbour

FITTED_ELSEWHERE = "another process fits it"
Work = Callable[[Any, Say], dict[str, Any]]
"""The fit of a task, as JSON data."""


@dataclass(frozen=True)
class FitTask:
    """The fit of one curve; it pickles to workers."""

    name: str
    """Name in a progress bar."""
    memory: int
    """Estimated peak memory of the fit [bytes]."""
    row: Row
    problem: FitProblem
    path: Path | None
    """File that keeps the fit."""
    common: Mapping[Any, float]
    """Uncertainty that all curves share, which stands beside medians and in no interval."""
    like: Sequence[Neighbour] = ()
    """Curves alike, of which all explanations were compared, the nearest first."""


def passes(
    tasks: Sequence[FitTask | None],
    near: Sequence[Sequence[Near]],
    rows: Sequence[Row],
    part: Part | None,
    work: Work,
) -> Iterator[tuple[list[int], Work]]:
    """Yield which curves of a batch are fitted one after the other, and the work on each.

    Curves that speak for others come first. A part waits for those that its own curves need, if
    another process fits them, so that each curve is fitted as by one process alone.
    """
    # Parts are counted over all curves, fitted or not, so that each curve stays in its part.
    full, spared = (
        [i for i, of in enumerate(near) if bool(of) is spared] for spared in (False, True)
    )

    def open_of(numbers: Iterable[int]) -> list[int]:
        return [i for i in numbers if tasks[i] and rows[i].is_open]

    if part is None:
        yield open_of(full), work
        yield open_of(spared), work
        return
    own = open_of(part.of(spared))
    yield open_of(part.of(full)), partial(fit_alone, work=work, wait=False)
    needed = {neighbour.row for i in own for neighbour in near[i]}
    yield open_of(sorted(needed)), partial(fit_alone, work=work, wait=True)
    yield own, partial(fit_alone, work=work, wait=False)


def fit_alone(task: FitTask, say: Say, *, work: Work, wait: bool) -> dict[str, Any]:
    """Return the kept fit of a curve, or fit and keep it while no other process does."""
    assert task.path is not None, "parts share a folder"
    with lock_files(task.path.parent, task.path.stem, wait=wait):
        try:
            return read_sealed(task.path)
        except StorageError:
            fit = work(task, say)
            write_sealed(fit, task.path)
            return fit
