"""What executors are given here: tasks of some size, nobody to report to, and workers of dask."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cloudpickle
import distributed
import pytest

import pellicle as pl
from pellicle.components import Say
from tests.conftest import end

# Workers cannot import a module of a folder that is no package.
cloudpickle.register_pickle_by_value(sys.modules[__name__])

posix = pytest.mark.skipif(sys.platform == "win32", reason="has other signals")
PATIENCE = 60.0


@dataclass(frozen=True)
class Job:
    """A task of some size [bytes], with a folder for its traces."""

    number: int
    folder: Path = Path()
    memory: int = 1

    @property
    def name(self) -> str:
        return f"job {self.number}"


def silence(job: Job, text: Any) -> None:
    """Report to nobody."""


def square(job: Job, say: Say) -> int:
    """Return the square of the number."""
    return job.number**2


def dask(**fields: Any) -> pl.Executor:
    """Return the executor of dask."""
    return pl.registry().make(pl.Executor, {"type": "dask", **fields})


@contextmanager
def worker_of(
    address: str, folder: Path, *options: str, is_awaited: bool = True, **environment: str
) -> Iterator[subprocess.Popen[bytes]]:
    """Start a worker process of its own, wait until its scheduler knows it, and end it."""
    command = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-dashboard"]
    command += ["--host", "127.0.0.1", "--local-directory", str(folder), *options]
    with distributed.Client(address, set_as_default=False) as client:
        before = len(client.nthreads())
        worker = subprocess.Popen(command, env=os.environ | environment, stderr=subprocess.DEVNULL)
        try:
            if is_awaited:
                client.wait_for_workers(before + 1, timeout=PATIENCE)
            yield worker
        finally:
            end(worker)
