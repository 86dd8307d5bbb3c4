"""What holds for every test: floating-point errors raise, and the checkout is installed."""

from __future__ import annotations

import gc
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable, Generator, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from importlib.metadata import entry_points
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from tests import durations

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

    from tests.command import Cli


# A busy machine is slow, which says nothing of the code.
settings.register_profile("busy", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("busy")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that measures every test."""
    parser.addoption(
        "--store-durations",
        action="store_true",
        help="store the CPU seconds of all tests in tests/durations.csv",
    )


@pytest.hookimpl(wrapper=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> Generator[None]:
    """Mark the quick tests, then begin with the longest files of those that are left.

    So no process ends with a long file while the other is idle. A test without a stored duration is
    not quick.
    """
    functions = {item: durations.function_of(item.nodeid) for item in items}
    seconds = durations.with_moved(durations.stored(), functions.values())
    for item, function in functions.items():
        is_short = seconds.get(function, inf) <= durations.QUICK
        if is_short and item.get_closest_marker("slow") is None:
            item.add_marker("quick")
    yield
    of_file: dict[Path, float] = defaultdict(float)
    for item in items:
        of_file[item.path] += seconds.get(functions[item], 0.0)
    items.sort(key=lambda item: -of_file[item.path])


def pytest_collection_finish() -> None:
    """Leave out of later garbage collections what collection has made."""
    gc.freeze()
    gc.enable()


def pytest_configure(config: pytest.Config) -> None:
    """Stop at once where there are no plugins: hundreds of failures would not say why."""
    if config.option.store_durations:
        config.pluginmanager.register(durations.Durations())
    # Collection only makes objects that stay; looking through them is a third of its time.
    gc.disable()
    # pytest-xdist would begin with the files of the most tests.
    config.option.loadscopereorder = False
    owners = {entry.dist.name for entry in entry_points(group="pellicle") if entry.dist}
    if "pellicle" not in owners:
        raise pytest.UsageError(
            "pellicle is not installed here, so it has no plugins; install the checkout first: "
            'pip install -e ".[test]"'
        )


@pytest.fixture(scope="session", autouse=True)
def _floating_point_errors_raise() -> Iterator[None]:
    with np.errstate(all="raise", under="ignore"):
        yield


@pytest.fixture(autouse=True)
def _no_figure_stays_open() -> Iterator[None]:
    """Close what a test has drawn, or the next one on the same worker would draw into it."""
    yield
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")


@pytest.fixture
def cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Cli:
    """Return `tests.command.call`, in an empty folder."""
    from tests.command import call

    monkeypatch.chdir(tmp_path)
    return call


StartDask = Callable[..., AbstractContextManager[str]]


def end(process: subprocess.Popen[bytes]) -> None:
    """End a process: a worker whose scheduler is gone would take ten seconds to give up."""
    process.terminate()
    try:
        process.wait(2)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


@pytest.fixture(scope="session")
def start_dask(tmp_path_factory: pytest.TempPathFactory) -> StartDask:
    """Return a function that starts a dask scheduler and workers of one thread on 127.0.0.1.

    It is a context whose value is the scheduler's address. Workers are forked off a process that
    has loaded its libraries, which takes a fifth of the time; ``environment`` is for all of them.
    """

    @contextmanager
    def start(workers: int = 2, *options: str, **environment: str) -> Iterator[str]:
        import distributed

        folder = tmp_path_factory.mktemp("dask")
        file = folder / "scheduler.json"
        forked = "forkserver" in multiprocessing.get_all_start_methods()
        method = "forkserver" if forked else "spawn"
        # An idle cluster that looks at itself every 10 ms takes a tenth of a core.
        here = {
            "DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD": method,
            "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
            "DASK_DISTRIBUTED__ADMIN__TICK__INTERVAL": "500ms",
            "DASK_DISTRIBUTED__ADMIN__SYSTEM_MONITOR__INTERVAL": "30s",
            "DASK_DISTRIBUTED__ADMIN__SYSTEM_MONITOR__GIL__ENABLED": "False",
        }
        common: dict[str, Any] = {
            "env": os.environ | here | environment,
            "stdout": subprocess.DEVNULL,
            "stderr": subprocess.DEVNULL,
        }
        loopback = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(file)]
        scheduler = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0"]
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--nthreads", "1"]
        local = ["--local-directory", str(folder), "--nworkers", str(workers)]
        commands = [[*scheduler, *loopback]]
        commands += [[*worker, *loopback, *local, *options]] if workers else []
        with ExitStack() as processes:
            for command in commands:
                processes.callback(end, subprocess.Popen(command, **common))
            # A client, and a worker, wait for the file to be there and whole.
            with distributed.Client(scheduler_file=str(file), set_as_default=False) as client:
                if workers:
                    client.wait_for_workers(workers, timeout=60)
                address = client.scheduler.address
            assert address.startswith(("tcp://127.0.0.1:", "tls://127.0.0.1:"))
            yield address

    return start


# An idle cluster takes a fortieth of a core, which over a session is more than its start.
@pytest.fixture(scope="module")
def dask_address(start_dask: StartDask) -> Iterator[str]:
    """Return the address of a scheduler with two workers, which gives a task up at its first death.

    The default of dask is its fourth.
    """
    with start_dask(DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0") as address:
        yield address


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chrome]:
    """Return a Chromium without a window."""
    from selenium.webdriver import Chrome, ChromeOptions, ChromeService

    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if chromium is None or driver is None:
        message = "no browser: apt-get install chromium chromium-driver"
        if os.environ.get("PELLICLE_BROWSER") == "required":
            pytest.fail(message)
        pytest.skip(message)
    options = ChromeOptions()
    options.binary_location = chromium
    for switch in (
        *("headless", "no-sandbox", "disable-gpu", "disable-quic", "no-first-run"),
        *("disable-background-networking", "disable-component-update", "disable-sync"),
        *("window-size=1280,900", f"user-data-dir={tmp_path_factory.mktemp('chromium')}"),
    ):
        options.add_argument(f"--{switch}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    opened = Chrome(options=options, service=ChromeService(driver))
    opened.set_script_timeout(20)
    yield opened
    opened.quit()


@pytest.fixture
def default_handler() -> Iterator[None]:
    """Answer Ctrl-C as Python does of itself; in the background of a shell it is ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
