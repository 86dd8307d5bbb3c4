"""Runs by a dask scheduler: workers die, clusters are elsewhere, and the extra may be missing."""

import builtins
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cloudpickle
import distributed
import pytest
from dask import config as configuration

import pellicle as pl
from pellicle.components import Say
from pellicle.plugins import registry

# Workers cannot import a module of a folder that is no package.
cloudpickle.register_pickle_by_value(sys.modules[__name__])

pytestmark = pytest.mark.usefixtures("forked_dask")
posix = pytest.mark.skipif(sys.platform == "win32", reason="has other signals")
PATIENCE = 60.0


@dataclass(frozen=True)
class Job:
    """A task with a folder for its traces."""

    number: int
    folder: Path = Path()
    memory: int = 1

    @property
    def name(self) -> str:
        """What messages call it."""
        return f"job {self.number}"


def dask(**fields: Any) -> pl.Executor:
    """Return the executor."""
    return registry().make(pl.Executor, {"type": "dask", **fields})


def silence(job: Job, said: Any) -> None:
    """Report to nobody."""


def square(job: Job, say: Say) -> int:
    """Return the square of the number."""
    return job.number**2


def die_the_first_time(job: Job, say: Say) -> int:
    """Kill the own worker at the second job, but for the second attempt; count all attempts."""
    attempts = len(list(job.folder.glob(f"{job.number}-*")))
    (job.folder / f"{job.number}-{attempts}").touch()
    if job.number == 1 and attempts == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return job.number


def always_die(job: Job, say: Say) -> int:
    """Kill the own worker at the second job, whenever it is tried, but not while it starts."""
    if job.number == 1:
        time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGKILL)
    return job.number


def die_at_once(job: Job, say: Say) -> None:
    """Kill the own worker, as soon as there is one."""
    os.kill(os.getpid(), signal.SIGKILL)


def talk_for_ever(job: Job, say: Say) -> None:
    """Say something, again and again, and leave a mark when that is no longer wanted."""
    try:
        while True:
            say("on and on")
            time.sleep(0.01)
    finally:
        (job.folder / f"ended-{job.number}").touch()


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """Return the address of a scheduler that is not the executor's own."""
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        dashboard_address=":0",
        scheduler_kwargs={"dashboard": False},
        memory_limit=2 * 10**9,
    ) as cluster:
        yield cluster.scheduler_address


def test_scheduler_by_address(address: str) -> None:
    """Tasks are carried out by a scheduler that is there already, and it is there afterwards."""
    for _ in range(2):
        found = dict(dask(address=address).map(square, [Job(i) for i in range(4)], silence))
        assert found == {Job(i): i**2 for i in range(4)}


@posix
def test_task_of_a_killed_worker_runs_elsewhere(tmp_path: Path) -> None:
    """The table is that of an undisturbed study, and no finished task was begun again."""
    jobs = [Job(i, tmp_path) for i in range(6)]
    # Here as for users: by default dask starts each worker afresh.
    with configuration.set({"distributed.worker.multiprocessing-method": "spawn"}):
        found = dict(dask(workers=2).map(die_the_first_time, jobs, silence))
    assert found == {job: job.number for job in jobs}
    assert len(list(tmp_path.glob("1-*"))) == 2


@posix
def test_task_that_kills_every_worker_is_given_up() -> None:
    """It says how many died of it; the others are carried out."""
    with configuration.set({"distributed.scheduler.allowed-failures": 1}):
        found = dict(dask(workers=2).map(always_die, [Job(i) for i in range(3)], silence))
    assert (found[Job(0)], found[Job(2)]) == (0, 2)
    assert isinstance(found[Job(1)], pl.PellicleError)
    assert str(found[Job(1)]).startswith("2 workers died of it")


@posix
def test_no_worker_is_left() -> None:
    """Tasks for which there are no workers any more fail, and do not wait for ever."""
    found = list(dask(workers=1).map(die_at_once, [Job(0), Job(1)], silence))
    assert len(found) == 2
    for _, outcome in found:
        assert isinstance(outcome, pl.PellicleError)
        assert "died" in str(outcome)


def test_task_larger_than_every_worker(address: str) -> None:
    """It is not sent off to die four times; the others run."""
    jobs = [Job(0, memory=3 * 10**9), Job(2)]
    found = dict(dask(address=address).map(square, jobs, silence))
    assert found[jobs[1]] == 4
    message = "job 0 needs about 3 GB, and 2 GB are available on the largest worker; use fewer"
    assert str(found[jobs[0]]).startswith(message)


def test_tasks_at_work_elsewhere_end_when_nobody_waits(address: str, tmp_path: Path) -> None:
    """On a scheduler that goes on without us, tasks end at their next word."""
    jobs = [Job(i, tmp_path) for i in range(2)]
    heard = threading.Event()

    def report(job: Job, said: Any) -> None:
        heard.set()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(dask(address=address).map(talk_for_ever, jobs, report))
    assert heard.is_set()
    end = time.monotonic() + PATIENCE
    # Both workers are free again, or this would wait for ever.
    assert len(list(dask(address=address).map(square, [Job(i) for i in range(4)], silence))) == 4
    while not list(tmp_path.iterdir()):
        assert time.monotonic() < end
        time.sleep(0.01)


def test_no_scheduler_at_the_address() -> None:
    """The message names the address and what to give instead."""
    with (
        configuration.set({"distributed.comm.timeouts.connect": "0.2s"}),
        pytest.raises(pl.ConfigError, match="address: no scheduler answers at 'tcp://"),
    ):
        list(dask(address="tcp://127.0.0.1:9").map(square, [Job(0)], silence))


def test_address_that_is_none() -> None:
    """What is no address at all is refused in the same words."""
    with pytest.raises(pl.ConfigError, match="address: no scheduler answers at 'nonsense://x'"):
        list(dask(address="nonsense://x").map(square, [Job(0)], silence))


def test_without_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    """Who asks for dask and has none is told what to install; the plugin itself loads."""
    for name in [*sys.modules]:
        if name.split(".")[0] in ("distributed", "dask") or name.endswith("executors.submission"):
            monkeypatch.delitem(sys.modules, name)
    really = builtins.__import__

    def without_distributed(name: str, *more: Any, **named: Any) -> Any:
        if name.split(".")[0] in ("distributed", "dask"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return really(name, *more, **named)

    monkeypatch.setattr(builtins, "__import__", without_distributed)
    with pytest.raises(pl.ConfigError, match=r"pip install 'pellicle\[cluster\]'"):
        list(dask().map(square, [Job(0)], silence))


@posix
def test_workers_without_pellicle(tmp_path: Path) -> None:
    """A cluster that lacks it says so, for each task."""
    hidden = tmp_path / "hidden" / "pellicle_plugins"
    hidden.mkdir(parents=True)
    (hidden / "__init__.py").write_text(
        "raise ModuleNotFoundError(\"No module named 'pellicle_plugins'\", name='pellicle_plugins')"
    )
    environment = {**os.environ, "PYTHONPATH": str(hidden.parent)}
    with distributed.LocalCluster(
        n_workers=0, dashboard_address=":0", scheduler_kwargs={"dashboard": False}
    ) as cluster:
        worker = subprocess.Popen(
            [
                *(sys.executable, "-m", "distributed.cli.dask_worker", cluster.scheduler_address),
                *("--no-nanny", "--no-dashboard", "--nthreads=1"),
                *("--local-directory", str(tmp_path)),
            ],
            env=environment,
            stderr=subprocess.DEVNULL,
        )
        try:
            executor = dask(address=cluster.scheduler_address)
            ((_, outcome),) = executor.map(square, [Job(0)], silence)
        finally:
            worker.terminate()
            worker.wait()
    assert isinstance(outcome, pl.PellicleError)
    assert "workers lack pellicle_plugins; install there" in str(outcome)
