"""What a run or a study will do, does and did, as the terminal says it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pellicle.components.charts import Table
from pellicle.units import DIGITS, decimal, readable

if TYPE_CHECKING:
    from pellicle.studies.runner import RunTask


def planned(tasks: Sequence[RunTask]) -> tuple[Table, str]:
    """Return a row for each run, finished or not, and a sentence on all."""
    rows, done = [], 0
    for task in tasks:
        _, finished, problem = task.stored()
        done += finished >= task.steps
        nx, ny = task.run.grid.points
        state = f"{finished} of {task.steps} steps done" if finished < task.steps else "done"
        rows.append(
            (
                task.name,
                str(task.journal.path),
                f"{nx} × {ny}",
                " × ".join(readable(edge, "m", 3) for edge in task.run.grid.size),
                str(task.steps),
                f"{task.memory / 1e6:.3g} MB",
                problem or (state if finished else "to do"),
            )
        )
    most = max(task.memory for task in tasks) / 1e6
    sentence = (
        f"{len(tasks)} run{'s' * (len(tasks) > 1)}, {done} done, "
        f"{len(tasks) - done} to do; at most {most:.3g} MB each"
    )
    heads = "run", "file", "points", "size", "steps", "memory", "state"
    return Table.of_rows(heads, rows), sentence


def done(files: Sequence[Path], resumed: int, whole: str, seconds: float) -> Iterator[str]:
    """Yield how much was done before, the files that were written, and how long all took."""
    if resumed:
        yield f"{resumed} of {whole} were done before (--overwrite starts over)"
    for path in files:
        yield f"wrote {path}"
    yield f"took {decimal(seconds, 2)} s"


def shared(runs: int, seconds: float) -> str:
    """Return that runs that would take long are shared among processes."""
    return (
        f"the other {runs} runs would take {seconds:.0f} s here: they go to processes, as many as "
        "cores and memory allow (study.executor decides otherwise)"
    )


def interrupted(finished: str, folder: Path) -> str:
    """Return where an interruption left the ``finished`` steps or runs."""
    return f"interrupted; finished {finished} are in {folder}, and the same command continues"


def larger_domain(size: tuple[float, float], folder: Path) -> str:
    """Return how to solve a run on a domain that holds its contacts."""
    x, y = (readable(edge, "m", DIGITS) for edge in size)
    return (
        f'grid.size = ["{x}", "{y}"] holds the contact of every step; -o DIR solves it in '
        f"another folder, --overwrite in place of the result in {folder}"
    )
