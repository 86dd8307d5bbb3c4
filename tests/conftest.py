"""What holds for every test: floating-point errors raise, and the checkout is installed."""

import multiprocessing
from collections.abc import Iterator
from importlib.metadata import entry_points

import numpy as np
import pytest


def pytest_configure() -> None:
    """Stop at once where there are no plugins: hundreds of failures would not say why."""
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


@pytest.fixture(scope="module")
def forked_dask() -> Iterator[None]:
    """Have dask fork its workers off a process that has loaded its libraries: a fifth of the time.

    Where the system cannot, and in tests without this, they are started as for users.
    """
    # Its defaults, first: `set` would take them along when it takes back what it has set.
    import distributed  # noqa: F401
    from dask import config

    method = "forkserver"
    there = method in multiprocessing.get_all_start_methods()
    with config.set({"distributed.worker.multiprocessing-method": method} if there else {}):
        yield
