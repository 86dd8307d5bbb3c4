"""Runs by a dask scheduler: workers die or never come, and the extra may be missing."""

import builtins
import os
import signal
import sys
import threading
import time
import warnings
from pathlib import Path
from typing import Any

import cloudpickle
import psutil
import pytest
from dask import config as configuration

import pellicle as pl
from pellicle.components import Say
from tests.plugins.executors.jobs import Job, dask, posix, silence, square, worker_of

# Workers cannot import a module of a folder that is no package.
cloudpickle.register_pickle_by_value(sys.modules[__name__])


ALONE = "--no-nanny", "--nthreads=1"


def always_die(job: Job, say: Say) -> int:
    """Kill the own worker at the second job, whenever it is tried, but not while it starts."""
    if job.number == 1:
        time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGKILL)
    return job.number


def talk_a_while(job: Job, say: Say) -> None:
    """Say something, again and again, for some seconds."""
    for _ in range(1000):
        say("on and on")
        time.sleep(0.01)


def talk_for_ever(job: Job, say: Say) -> None:
    """Say something, again and again, and leave a mark when that is no longer wanted."""
    try:
        while True:
            say("on and on")
            time.sleep(0.01)
    finally:
        (job.folder / f"ended-{job.number}").touch()


@pytest.fixture(scope="module")
def address(dask_address: str) -> str:
    """Return the address of a scheduler with two workers."""
    return dask_address


def test_scheduler_by_address(address: str) -> None:
    """Tasks are carried out by a scheduler that is there already, and it is there afterwards."""
    for _ in range(2):
        outcomes = dict(dask(address=address).map(square, [Job(i) for i in range(4)], silence))
        assert outcomes == {Job(i): i**2 for i in range(4)}


def test_an_address_is_needed() -> None:
    """Without one the message says how to start a scheduler, and what to use on one machine."""
    with pytest.raises(pl.ConfigError, match="address: is missing") as error:
        dask()
    for part in ("`dask scheduler`", "`dask worker ADDRESS`", '"processes"'):
        assert part in str(error.value)


@posix
def test_task_that_kills_every_worker_is_given_up(address: str) -> None:
    """It says how many died of it; the others are carried out."""
    outcomes = dict(dask(address=address).map(always_die, [Job(i) for i in range(3)], silence))
    assert (outcomes[Job(0)], outcomes[Job(2)]) == (0, 2)
    assert isinstance(outcomes[Job(1)], pl.PellicleError)
    assert str(outcomes[Job(1)]).startswith("1 worker died of it")


def test_no_workers_are_warned_of(start_dask: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Who waits for workers that do not come is told so, and how to start them."""
    monkeypatch.setattr("pellicle_plugins.executors.dask_tasks._CHECK_INTERVAL", 0.05)
    with (
        start_dask(0) as address,
        pytest.raises(UserWarning, match=r"has no workers; .* `dask worker ADDRESS`"),
    ):
        list(dask(address=address).map(square, [Job(2)], silence))


@pytest.mark.slow
def test_workers_may_come_later(start_dask: Any, tmp_path: Path) -> None:
    """Runs wait for the first worker, as a queue may take its time to start it, and tell of it."""
    lines: list[str] = []
    with (
        start_dask(0) as address,
        worker_of(address, tmp_path, *ALONE, is_awaited=False),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore", UserWarning)
        jobs = [Job(i) for i in range(3)]
        outcomes = dict(dask(address=address).map(square, jobs, lambda _, line: lines.append(line)))
    assert outcomes == {Job(i): i**2 for i in range(3)}
    assert lines[:1] == ["a worker joined; there are 1 now"]


@pytest.mark.slow
def test_task_larger_than_every_worker(start_dask: Any) -> None:
    """It is not sent off to die four times; the others run."""
    jobs = [Job(0, memory=3 * 10**9), Job(2)]
    with start_dask(1, "--no-nanny", "--memory-limit", "2GB") as address:
        outcomes = dict(dask(address=address).map(square, jobs, silence))
    assert outcomes[jobs[1]] == 4
    message = "job 0 needs about 3 GB, and 2 GB are available on the largest worker; use fewer"
    assert str(outcomes[jobs[0]]).startswith(message)


@pytest.mark.slow
@posix
def test_a_scheduler_that_dies_fails_its_tasks(start_dask: Any) -> None:
    """Without a scheduler tasks come with an exception, and nothing waits for ever."""
    with start_dask(1, "--no-nanny", "--death-timeout", "1") as address:
        port = int(address.rpartition(":")[2])
        scheduler = next(
            process
            for process in psutil.Process().children()
            if any(c.laddr.port == port for c in process.net_connections() if c.status == "LISTEN")
        )

        def report(job: Job, text: Any) -> None:
            scheduler.kill()

        outcomes = list(dask(address=address).map(talk_a_while, [Job(0), Job(1)], report))
    assert len(outcomes) == 2
    for _, outcome in outcomes:
        assert str(outcome) == "the connection to the scheduler was lost"


def test_tasks_at_work_elsewhere_end_when_nobody_waits(address: str, tmp_path: Path) -> None:
    """On a scheduler that goes on without us, tasks have ended when the iterator is closed."""
    jobs = [Job(i, tmp_path) for i in range(2)]
    heard = threading.Event()

    def report(job: Job, text: Any) -> None:
        heard.set()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(dask(address=address).map(talk_for_ever, jobs, report))
    assert heard.is_set()
    ended = sorted(tmp_path.iterdir())
    assert ended
    # Both workers are free again, or this would wait for ever.
    assert len(list(dask(address=address).map(square, [Job(i) for i in range(4)], silence))) == 4
    assert sorted(tmp_path.iterdir()) == ended


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense://x"])
def test_no_scheduler_at_the_address(address: str) -> None:
    """The message names the address and what to give instead."""
    with (
        configuration.set({"distributed.comm.timeouts.connect": "0.2s"}),
        pytest.raises(pl.ConfigError, match=f"address: no scheduler answers at '{address}'"),
    ):
        list(dask(address=address).map(square, [Job(0)], silence))


def test_without_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    """Who asks for dask and has none is told what to install; the plugin itself loads."""
    for name in [*sys.modules]:
        if name.split(".")[0] in ("distributed", "dask") or name.endswith("executors.dask_tasks"):
            monkeypatch.delitem(sys.modules, name)
    really = builtins.__import__

    def without_distributed(name: str, *more: Any, **named: Any) -> Any:
        if name.split(".")[0] in ("distributed", "dask"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return really(name, *more, **named)

    monkeypatch.setattr(builtins, "__import__", without_distributed)
    with pytest.raises(pl.ConfigError, match=r"pip install 'pellicle\[cluster\]'"):
        list(dask(address="tcp://127.0.0.1:9").map(square, [Job(0)], silence))


@pytest.mark.slow
@posix
def test_workers_without_pellicle(start_dask: Any, tmp_path: Path) -> None:
    """A cluster that lacks it says so, for each task."""
    hidden = tmp_path / "hidden" / "pellicle_plugins"
    hidden.mkdir(parents=True)
    (hidden / "__init__.py").write_text(
        "raise ModuleNotFoundError(\"No module named 'pellicle_plugins'\", name='pellicle_plugins')"
    )
    path = str(hidden.parent)
    with start_dask(0) as address, worker_of(address, tmp_path, *ALONE, PYTHONPATH=path):
        ((_, outcome),) = dask(address=address).map(square, [Job(0)], silence)
    assert isinstance(outcome, pl.PellicleError)
    assert "workers lack pellicle_plugins; install there" in str(outcome)
