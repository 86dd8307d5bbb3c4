"""What every executor keeps: each task once, failures as data, nothing left behind."""

import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cloudpickle
import pytest

from pellicle import ConfigError, Executor
from pellicle.components import Say

# Workers cannot import a module of a folder that is no package.
cloudpickle.register_pickle_by_value(sys.modules[__name__])


@dataclass(frozen=True)
class Job:
    """A task that counts."""

    number: int
    folder: Path | None = None
    memory: int = 1

    @property
    def name(self) -> str:
        """What messages call it."""
        return f"job {self.number}"


def square(job: Job, say: Say) -> int:
    """Return the square of the number."""
    return job.number**2


def talk(job: Job, say: Say) -> str:
    """Say two things and return a third."""
    say(("begun", job.number))
    say({"done": job.number})
    return "quiet"


def fail_if_odd(job: Job, say: Say) -> int:
    """Raise for every other job."""
    if job.number % 2:
        raise ConfigError(f"{job.number} is odd", "job.number")
    return job.number


def leave(job: Job, say: Say) -> int:
    """Leave the process as a badly behaved plugin might."""
    if job.number == 1:
        raise SystemExit(3)
    return job.number


def return_what_cannot_travel(job: Job, say: Say) -> Any:
    """Return an object that does not pickle, from the second job."""
    return threading.Lock() if job.number == 1 else job.number


class FussyError(Exception):
    """Pickles, and cannot be read back."""

    def __init__(self, first: str, second: str) -> None:
        super().__init__(first + second)


def raise_what_cannot_travel(job: Job, say: Say) -> int:
    """Raise an exception that does not survive pickling, from the second job."""
    if job.number == 1:
        raise FussyError("two ", "parts")
    return job.number


def leave_a_mark(job: Job, say: Say) -> int:
    """Leave a file that tells that the job was begun."""
    assert job.folder is not None
    with (job.folder / str(job.number)).open("x"):
        return job.number


def silence(job: Job, said: Any) -> None:
    """Report to nobody."""


def jobs(number: int, folder: Path | None = None) -> list[Job]:
    """Return as many jobs, numbered from 0."""
    return [Job(i, folder) for i in range(number)]


def by_number(outcomes: Iterator[tuple[Job, Any]]) -> dict[int, Any]:
    """Return outcomes by the number of the job, each job once."""
    pairs = list(outcomes)
    found = {job.number: outcome for job, outcome in pairs}
    assert len(found) == len(pairs)
    return found


def test_no_tasks_no_outcomes(executor: Executor) -> None:
    """A study that is finished already costs nothing."""
    assert list(executor.map(square, [], silence)) == []


@pytest.mark.parametrize("number", [1, 7])
def test_each_task_once(executor: Executor, number: int) -> None:
    """One task or more than there are workers: each comes back once, with its own outcome."""
    given = jobs(number)
    assert by_number(executor.map(square, given, silence)) == {i: i**2 for i in range(number)}


def test_tasks_come_back_as_they_were(executor: Executor) -> None:
    """What is yielded is the very task that was given, so that the caller can look it up."""
    given = jobs(3)
    assert {id(job) for job, _ in executor.map(square, given, silence)} == set(map(id, given))


def test_equal_tasks_are_two_tasks(executor: Executor) -> None:
    """Tasks are told apart by their places, not by what they hold."""
    given = [Job(4), Job(4)]
    assert [outcome for _, outcome in executor.map(square, given, silence)] == [16, 16]


def test_each_task_is_carried_out_once(executor: Executor, tmp_path: Path) -> None:
    """No task is begun twice: each would find its own mark and fail."""
    found = by_number(executor.map(leave_a_mark, jobs(5, tmp_path), silence))
    assert found == {i: i for i in range(5)}
    assert {path.name for path in tmp_path.iterdir()} == set(map(str, range(5)))


def test_what_work_raises_is_an_outcome(executor: Executor) -> None:
    """A failed task comes with its exception, whole, and the others with what they returned."""
    found = by_number(executor.map(fail_if_odd, jobs(5), silence))
    assert {i: found[i] for i in (0, 2, 4)} == {0: 0, 2: 2, 4: 4}
    for number in (1, 3):
        assert isinstance(found[number], ConfigError)
        assert str(found[number]) == f"job.number: {number} is odd"


def test_work_that_exits_is_a_failure_of_its_own(executor: Executor) -> None:
    """``sys.exit()`` in a run ends neither the study nor its other runs."""
    found = by_number(executor.map(leave, jobs(3), silence))
    assert (found[0], found[2]) == (0, 2)
    assert isinstance(found[1], Exception)
    assert "job 1" in str(found[1])


def test_outcome_that_cannot_travel(executor: Executor) -> None:
    """An outcome that does not pickle comes as it is or as an exception, and harms no other."""
    found = by_number(executor.map(return_what_cannot_travel, jobs(3), silence))
    assert (found[0], found[2]) == (0, 2)
    if isinstance(found[1], Exception):
        assert "job 1" in str(found[1])
        assert "pickle" in str(found[1])
    else:
        assert isinstance(found[1], type(threading.Lock()))


def test_exception_that_cannot_travel(executor: Executor) -> None:
    """An exception that does not survive pickling comes as one that says the same."""
    found = by_number(executor.map(raise_what_cannot_travel, jobs(3), silence))
    assert (found[0], found[2]) == (0, 2)
    assert isinstance(found[1], Exception)
    assert "two parts" in str(found[1])


def test_what_work_says_is_reported(executor: Executor) -> None:
    """What is said arrives in order, with its task, in the thread that asks for outcomes."""
    given = jobs(4)
    heard: dict[int, list[Any]] = {job.number: [] for job in given}

    def report(job: Job, said: Any) -> None:
        assert threading.current_thread() is here
        assert any(job is one for one in given)
        heard[job.number].append(said)

    here = threading.current_thread()
    for job, outcome in executor.map(talk, given, report):
        assert outcome == "quiet"
        assert heard[job.number] == [("begun", job.number), {"done": job.number}]


def test_closed_early_begins_nothing_more(executor: Executor, tmp_path: Path) -> None:
    """Once the caller has enough, the tasks that wait are never begun."""
    outcomes = executor.map(leave_a_mark, jobs(50, tmp_path), silence)
    _, outcome = next(outcomes)
    outcomes.close()  # type: ignore[attr-defined]
    begun = sorted(path.name for path in tmp_path.iterdir())
    assert str(outcome) in begun
    assert len(begun) < 50
    # A worker that lived on would get further meanwhile.
    assert by_number(executor.map(square, jobs(4), silence)) == {i: i**2 for i in range(4)}
    assert sorted(path.name for path in tmp_path.iterdir()) == begun


def test_report_that_raises_ends_the_tasks(executor: Executor) -> None:
    """An error of the caller's own is not swallowed; Ctrl-C in a report is the same."""

    def report(job: Job, said: Any) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(executor.map(talk, jobs(4), report))
