"""Executors that break their contract at work are refused by name, before a result is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import pytest

import pellicle as pl
from tests.framework.broken_contracts.short_run import study


class Executor(pl.Executor):
    """One task after the other, and no contract kept."""

    type: Literal["liar"] = "liar"

    def map(self, work: Any, tasks: Any, report: Any) -> Iterator[Any]:
        """Yield each task with its outcome, changed."""
        for task in tasks:
            yield from self.change(task, work(task, lambda text: None))

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield something else."""
        yield task, outcome


class Twice(Executor):
    """Yields each task twice."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield twice."""
        yield from [(task, outcome)] * 2


class Never(Executor):
    """Yields no task."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield nothing."""
        return ()


class Copies(Executor):
    """Yields copies of tasks."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield a copy."""
        yield replace(task), outcome


class OutcomeOnly(Executor):
    """Yields outcomes without their tasks."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield the outcome."""
        yield outcome


class NoOutcome(Executor):
    """Loses the outcomes."""

    def change(self, task: Any, outcome: Any) -> Any:
        """Yield None for the outcome."""
        yield task, None


class Returning(Executor):
    """Returns a list."""

    def map(self, work: Any, tasks: Any, report: Any) -> Any:
        """Return all at once."""
        return [(task, work(task, lambda text: None)) for task in tasks]


EXECUTORS = {
    Twice: "yields reduced modulus 10 kPa twice; it has to yield each task once",
    Never: "map() ended without 2 of 2 tasks, such as reduced modulus 10 kPa",
    Copies: "it has to yield each of the tasks that it was given, the object itself",
    OutcomeOnly: "it has to yield each of the tasks that it was given, the object itself",
    NoOutcome: "with None; it has to yield it with what its work returned or raised",
    Returning: "map() returned [(RunTask(",
}


@pytest.mark.parametrize("lie", EXECUTORS)
def test_an_executor_that_lies_is_refused(lie: Any, tmp_path: Path) -> None:
    """Runs are not mixed up or left out unnoticed, and those that were done are kept."""
    with pytest.raises(pl.PluginError, match="executor 'liar'") as error:
        pl.run_study(study(lie()), tmp_path, progress=False, threads=1)
    assert EXECUTORS[lie] in str(error.value)
    assert (tmp_path / "study.h5").exists()
    table = pl.run_study(study(), tmp_path, progress=False, threads=1)
    assert (table["status"] == "converged").all()
