"""Workers of a dask scheduler: large and small ones, late ones, those that are killed or end."""

import os
import signal
import sys
import time
from collections import defaultdict
from contextlib import suppress
from pathlib import Path
from typing import Any

import cloudpickle
import pytest

from pellicle.batch import lock_files
from pellicle.components import Say
from tests.plugins.executors.jobs import Job, dask, posix, silence, worker_of

# Workers cannot import a module of a folder that is no package.
cloudpickle.register_pickle_by_value(sys.modules[__name__])

pytestmark = [pytest.mark.slow, posix]
GB = 10**9
# The first death that is counted ends a task.
STRICT = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}


def trace(job: Job, seconds: float) -> int:
    """Leave a file with the own process and the begin and end of a job that takes a while."""
    begin = time.time()
    time.sleep(seconds)
    (job.folder / f"{job.number}-{os.getpid()}").write_text(f"{begin} {time.time()}")
    return job.number


def linger(job: Job, say: Say) -> int:
    """Take a fifth of a second."""
    return trace(job, 0.2)


def linger_longer(job: Job, say: Say) -> int:
    """Take a second."""
    return trace(job, 1.0)


def kill_the_first_time(job: Job, say: Say) -> int:
    """Kill the own worker at the second job, but for the second attempt."""
    mark = job.folder / "killed"
    if job.number == 1 and not mark.exists():
        time.sleep(0.3)
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return trace(job, 0.5)


def always_kill(job: Job, say: Say) -> int:
    """Kill the own worker at the second job, while the others are at work."""
    time.sleep(0.5)
    if job.number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.5)
    return job.number


def go_on(job: Job, say: Say) -> int:
    """Do twelve pieces of work, each kept, with the files locked as those of a run are.

    A piece cannot be interrupted. Return how often the work was begun.
    """
    with lock_files(job.folder, f"{job.number}"):
        begun, done = (job.folder / f"{job.number}.{name}" for name in ("begun", "done"))
        with begun.open("a") as file:
            file.write("x")
        while not done.exists() or done.stat().st_size < 12:
            say("a piece")
            time.sleep(0.8)
            with done.open("a") as file:
                file.write("x")
        return begun.stat().st_size


def traces(folder: Path) -> dict[int, list[tuple[int, float, float]]]:
    """Return number, begin and end of the jobs of each process."""
    found = defaultdict(list)
    for path in folder.glob("*-*"):
        with suppress(ValueError):
            number, process = map(int, path.name.split("-"))
            begin, finish = map(float, path.read_text().split())
            found[process].append((number, begin, finish))
    return found


def most_at_once(jobs: list[Job], done: list[tuple[int, float, float]]) -> int:
    """Return the largest memory [bytes] of the jobs that one process did at the same time."""
    return max(
        sum(jobs[other].memory for other, start, stop in done if start <= begin < stop)
        for _, begin, _ in done
    )


def test_large_runs_wait_for_memory(start_dask: Any, tmp_path: Path) -> None:
    """Two that one worker cannot hold are never there at once; small ones fill the gaps."""
    jobs = [Job(i, tmp_path, int((1.2 if i < 6 else 0.3) * GB)) for i in range(14)]
    with start_dask(2, "--nthreads", "3", "--memory-limit", "2GB") as address:
        outcomes = dict(dask(address=address).map(linger, jobs, silence))
    assert outcomes == {job: job.number for job in jobs}
    done = traces(tmp_path)
    assert len(done) == 2
    for process in done:
        assert GB < most_at_once(jobs, done[process]) <= 2 * GB


def test_two_studies_share_workers(start_dask: Any, tmp_path: Path) -> None:
    """What another study has placed on a worker is not free."""
    jobs = [Job(i, tmp_path, int(1.2 * GB)) for i in range(4)]
    with start_dask(1, "--nthreads", "4", "--memory-limit", "2GB") as address:
        first = dask(address=address).map(linger_longer, jobs[:2], silence)
        second = dask(address=address).map(linger_longer, jobs[2:], silence)
        outcomes = dict([next(first)])
        outcomes |= dict([*first, *second])
    assert len(outcomes) == 4
    ((_, done),) = traces(tmp_path).items()
    assert most_at_once(jobs, done) == jobs[0].memory


@pytest.mark.parametrize("threads", [1, 2])
def test_threads_of_a_worker_are_shared(start_dask: Any, tmp_path: Path, threads: int) -> None:
    """A worker of four threads does four runs of one thread at once, or two of two."""
    jobs = [Job(i, tmp_path) for i in range(8)]
    with start_dask(1, "--nthreads", "4") as address:
        dict(dask(address=address, threads=threads).map(linger, jobs, silence))
    ((_, done),) = traces(tmp_path).items()
    assert most_at_once(jobs, done) == 4 // threads


def test_small_worker_gets_small_runs(start_dask: Any, tmp_path: Path) -> None:
    """A worker with too little memory for a run does the others."""
    jobs = [Job(i, tmp_path, int((3 if i < 3 else 0.1) * GB)) for i in range(9)]
    small = ("--memory-limit", "1GB", "--nthreads", "1")
    with (
        start_dask(1, "--memory-limit", "4GB", **STRICT) as address,
        worker_of(address, tmp_path, *small),
    ):
        outcomes = dict(dask(address=address).map(linger, jobs, silence))
    assert outcomes == {job: job.number for job in jobs}
    at_work = sorted({number for number, *_ in done} for done in traces(tmp_path).values())
    assert len(at_work) == 2
    large = next(numbers for numbers in at_work if 0 in numbers)
    assert {0, 1, 2} <= large
    assert large != set(range(9))


def test_larger_worker_that_joins_late(start_dask: Any, tmp_path: Path) -> None:
    """It does what waits for it, and part of the rest."""
    jobs = [Job(i, tmp_path, int((3 if i < 2 else 0.1) * GB)) for i in range(12)]
    lines: list[str] = []
    with start_dask(1, "--memory-limit", "1GB", **STRICT) as address:
        pairs = dask(address=address).map(linger_longer, jobs, lambda _, line: lines.append(line))
        outcomes = dict([next(pairs)])
        with worker_of(address, tmp_path, "--memory-limit", "4GB", "--nthreads", "1"):
            outcomes |= dict(pairs)
    assert outcomes == {job: job.number for job in jobs}
    assert "a worker joined; there are 2 now" in lines


def test_run_of_a_killed_worker_goes_elsewhere(start_dask: Any, tmp_path: Path) -> None:
    """Of three worker processes one is killed, which is told; its run is begun again, no other."""
    jobs, lines = [Job(i, tmp_path) for i in range(9)], list[str]()
    single = ("--nthreads", "1", "--no-nanny")
    with (
        start_dask(0) as address,
        worker_of(address, tmp_path, *single),
        worker_of(address, tmp_path, *single),
        worker_of(address, tmp_path, *single),
    ):
        told = dask(address=address).map(
            kill_the_first_time, jobs, lambda _, line: lines.append(line)
        )
        outcomes = dict(told)
    assert outcomes == {job: job.number for job in jobs}
    assert any(line.startswith("a worker was lost") for line in lines)
    done = [number for numbers in traces(tmp_path).values() for number, *_ in numbers]
    assert sorted(done) == list(range(9))
    assert len(traces(tmp_path)) == 2


@pytest.mark.filterwarnings("ignore:the dask scheduler has no workers")
def test_run_that_kills_its_worker_is_found_among_others(start_dask: Any) -> None:
    """Runs that were beside it are tried again, and not blamed."""
    jobs = [Job(i) for i in range(3)]
    with start_dask(1, "--nthreads", "3", **STRICT) as address:
        outcomes = dict(dask(address=address).map(always_kill, jobs, silence))
    assert str(outcomes.pop(jobs[1])).startswith("1 worker died of it")
    assert outcomes == {jobs[0]: 0, jobs[2]: 2}


@pytest.mark.parametrize("lifetime", [["--lifetime", "8s"], []], ids=["lifetime", "SIGTERM"])
def test_worker_that_ends(start_dask: Any, tmp_path: Path, lifetime: list[str]) -> None:
    """Its run goes on elsewhere, once its files are free, and no death is counted."""
    jobs = [Job(i, tmp_path) for i in range(2)]
    lines: list[str] = []

    def report(job: Job, line: str) -> None:
        lines.append(line)
        if not lifetime and lines.count("a piece") == 3:
            worker.terminate()

    with (
        start_dask(1, "--nthreads", "2", **STRICT) as address,
        worker_of(address, tmp_path, "--nthreads", "1", *lifetime) as worker,
    ):
        outcomes = dict(dask(address=address).map(go_on, jobs, report))
    assert any(line.startswith("a worker has ended") for line in lines)
    assert {outcomes[job] for job in jobs} == {1, 2}
    assert all((tmp_path / f"{job.number}.done").stat().st_size == 12 for job in jobs)
