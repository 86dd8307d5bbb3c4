"""Runs in processes: within memory, whoever dies, and nothing is left behind."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cloudpickle
import psutil
import pytest

import pellicle as pl
from pellicle import memory
from pellicle.components import Say
from pellicle.components.installed import registry
from tests.plugins.executors.jobs import PATIENCE, Job, posix, silence
from tests.tables_of_runs import paraboloid, pressing, tensed

# Workers cannot import a module of a folder that is no package.
cloudpickle.register_pickle_by_value(sys.modules[__name__])

GIGABYTE = 10**9


def processes(**fields: Any) -> pl.Executor:
    """Return the executor."""
    return registry().make(pl.Executor, {"type": "processes", **fields})


def until(happens: Callable[[], bool]) -> bool:
    """Wait for something, but not for ever."""
    end = time.monotonic() + PATIENCE
    while not happens():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def count_company(job: Job, say: Say) -> int:
    """Return how many tasks were at work at once while this one was, itself included."""
    mine = job.folder / f"at-work-{job.number}"
    mine.touch()
    most = 0
    for _ in range(20):
        most = max(most, len(list(job.folder.glob("at-work-*"))))
        time.sleep(0.005)
    mine.unlink()
    return most


def meet_another(job: Job, say: Say) -> bool:
    """Return whether another task began before this one ended."""
    (job.folder / str(job.number)).touch()
    return until(lambda: len(list(job.folder.iterdir())) > 1)


def die_if_one(job: Job, say: Say) -> int:
    """Kill the own process at the second job, as the system does when memory runs out."""
    if job.number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return job.number


def environment(job: Job, say: Say) -> dict[str, str]:
    """Return what the worker's libraries of linear algebra see."""
    return {name: value for name, value in os.environ.items() if name.endswith("_THREADS")}


def press(job: Job, say: Say) -> Any:
    """Return the pressures of a small run."""
    result = pl.run(
        pressing(16 + job.number, "0.5 mm", tensed(1e4, 0.1), paraboloid("1 mm"), depth="10 um"),
        progress=False,
        threads=1,
    )
    return result.dataset["pressure"].values.tobytes()


@pytest.fixture
def room(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Return what makes the machine's memory as large as is asked for [bytes]."""
    return lambda free: monkeypatch.setattr(memory, "available", lambda: free)


def test_no_more_at_once_than_fit(room: Callable[[float], None], tmp_path: Path) -> None:
    """Where three workers would be there and memory for two is, two tasks meet, and no three."""
    room(2.5 * GIGABYTE)
    jobs = [Job(i, tmp_path, GIGABYTE) for i in range(6)]
    most = dict(processes(workers=3).map(count_company, jobs, silence))
    assert len(most) == 6
    assert set(most.values()) <= {1, 2}
    # Each of two waits for the other.
    assert all(met for _, met in processes(workers=3).map(meet_another, jobs[:2], silence))


def test_memory_that_others_took_meanwhile(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What another program takes after the first task began is not there for the second."""
    answers = iter([4.0 * GIGABYTE, 1.0 * GIGABYTE])
    monkeypatch.setattr(memory, "available", lambda: next(answers, 1.5 * GIGABYTE))
    jobs = [Job(i, tmp_path, GIGABYTE) for i in range(3)]
    outcomes = dict(processes(workers=3).map(count_company, jobs, silence))
    assert outcomes == dict.fromkeys(jobs, 1)


def test_small_task_overtakes_one_that_must_wait(
    room: Callable[[float], None], tmp_path: Path
) -> None:
    """A large task does not keep small ones waiting, and is carried out in the end, alone."""
    room(3 * GIGABYTE)
    large = Job(0, tmp_path, int(2.5 * GIGABYTE))
    small = [Job(i, tmp_path, GIGABYTE) for i in (1, 2)]
    outcomes = list(processes(workers=2).map(count_company, [small[0], large, small[1]], silence))
    assert outcomes[-1] == (large, 1)
    assert {job for job, _ in outcomes} == {large, *small}


def test_task_larger_than_memory_fails_alone(room: Callable[[float], None]) -> None:
    """It is never started, and says what it needs and what there is; the others run."""
    room(GIGABYTE)
    jobs = [Job(0, memory=64 * GIGABYTE), Job(2, memory=GIGABYTE // 2)]
    outcomes = {job.number: out for job, out in processes(workers=2).map(die_if_one, jobs, silence)}
    assert outcomes[2] == 2
    assert isinstance(outcomes[0], pl.ConfigError)
    message = "job 0 needs about 64.2 GB, and 1 GB are available; use fewer points or fewer steps"
    assert str(outcomes[0]) == message


def test_memory_that_is_unknown_is_no_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the system does not say, tasks are begun as if there were enough."""
    monkeypatch.setattr(memory, "available", lambda: None)
    jobs = [Job(0, memory=10**18)]
    assert list(processes(workers=1).map(die_if_one, jobs, silence)) == [(jobs[0], 0)]


@posix
def test_killed_worker_loses_its_own_task_only() -> None:
    """The others go on, a new worker takes its place, and the outcome tells what happened."""
    jobs = [Job(i) for i in range(5)]
    outcomes = {job.number: out for job, out in processes(workers=2).map(die_if_one, jobs, silence)}
    assert {i: outcomes[i] for i in (0, 2, 3, 4)} == {0: 0, 2: 2, 3: 3, 4: 4}
    assert isinstance(outcomes[1], pl.PellicleError)
    assert "its worker died: SIGKILL" in str(outcomes[1])


@pytest.mark.parametrize("threads", [1, 2])
def test_linear_algebra_is_pinned(threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers are born with the limit, whatever the parent's is."""
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "7")
    ((_, seen),) = processes(workers=1, threads=threads).map(environment, [Job(0)], silence)
    assert isinstance(seen, dict)
    assert seen["OMP_NUM_THREADS"] == seen["OPENBLAS_NUM_THREADS"] == str(threads)


@pytest.mark.slow
def test_runs_are_the_same_as_here() -> None:
    """A worker computes to the last bit what this process does."""
    jobs = [Job(i) for i in range(3)]
    outcomes = dict(processes(workers=2).map(press, jobs, silence))
    assert outcomes == {job: press(job, print) for job in jobs}


# Started in the background of a shell, tests and what they start would ignore Ctrl-C.
UNGUARDED = """
import os, signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)
from dataclasses import dataclass
from pathlib import Path
import pellicle as pl

@dataclass(frozen=True)
class Job:
    number: int
    name: str = "job"
    memory: int = 1

def work(job, say):
    Path(f"{job.number}.part").write_text(str(os.getpid()))
    os.rename(f"{job.number}.part", f"{job.number}.pid")
    while "{sleep}":
        time.sleep(0.1)
    return job.number**2

executor = pl.registry().make(pl.Executor, {"type": "processes", "workers": 2})
for job, outcome in executor.map(work, [Job(i) for i in range(4)], print):
    print(job.number, outcome, flush=True)
"""


def script(folder: Path, sleep: str) -> "subprocess.Popen[str]":
    """Start a script without a guard of its main part, in a process group of its own."""
    (folder / "script.py").write_text(UNGUARDED.replace("{sleep}", sleep))
    return subprocess.Popen(
        [sys.executable, "script.py"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def left_of(group: int) -> Iterator[psutil.Process]:
    """Yield the processes of a group that are not dead, waited for or not."""
    for process in psutil.process_iter():
        try:
            if os.getpgid(process.pid) == group and process.status() != psutil.STATUS_ZOMBIE:
                yield process
        except (ProcessLookupError, psutil.NoSuchProcess):
            continue


@pytest.mark.slow
def test_script_without_guard(tmp_path: Path) -> None:
    """A plain script runs once, with work that it defines itself."""
    run = script(tmp_path, sleep="")
    out, err = run.communicate(timeout=PATIENCE)
    assert (run.returncode, err) == (0, "")
    assert sorted(out.splitlines()) == ["0 0", "1 1", "2 4", "3 9"]


@posix
@pytest.mark.parametrize(
    ("signal_", "to_group"),
    [
        pytest.param(signal.SIGINT, True, id="Ctrl-C", marks=pytest.mark.slow),
        pytest.param(signal.SIGINT, False, id="SIGINT to the parent", marks=pytest.mark.slow),
        pytest.param(signal.SIGKILL, False, id="SIGKILL to the parent"),
    ],
)
def test_no_process_is_left_behind(signal_: signal.Signals, to_group: bool, tmp_path: Path) -> None:
    """However the parent ends in the midst of runs, all its processes end with it, quietly."""
    run = script(tmp_path, sleep="for ever")
    try:
        assert until(lambda: len(list(tmp_path.glob("*.pid"))) == 2)
        assert len(list(left_of(run.pid))) >= 3
        (os.killpg if to_group else os.kill)(run.pid, signal_)
        out, err = run.communicate(timeout=PATIENCE)
        assert until(lambda: not list(left_of(run.pid)))
    finally:
        for process in left_of(run.pid):
            process.kill()
    assert run.returncode == -signal_
    assert out == ""
    assert err.count("Traceback") == (signal_ == signal.SIGINT)
    assert err.rstrip().endswith("KeyboardInterrupt" if signal_ == signal.SIGINT else "")
