"""A study on two workers of a dask scheduler, one of which is killed in the midst of it."""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

import pellicle as pl

STUDY: dict[str, Any] = {
    "outputs": [],
    "grid": {"points": 24, "size": "0.5 mm"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": ["5 um", "10 um", "15 um"]},
}
VARY = {
    "kernel.tension": {"start": "0.1 N/m", "stop": "1 N/m", "num": 6, "spacing": "log"},
    "indenter.radius": ["1 mm", "1.2 mm", "1.4 mm"],
}
TIMES = {"wall_time"}


def study(**executor: object) -> pl.Study:
    """Return 18 runs of 3 steps."""
    return pl.Study(run=STUDY, vary=VARY, executor=executor)


def kill_one_worker(address: str, runs: Path, over: threading.Event, finished: list[int]) -> None:
    """Kill a worker of a scheduler as soon as there is a result, and note how many there are."""
    while not list(runs.glob("*.h5")):
        if over.wait(0.005):
            return
    time.sleep(0.02)
    helpers = ("resource_tracker", "semaphore_tracker")
    (nannies,) = (child for child in psutil.Process().children() if child.cmdline()[-1] == address)
    workers = [
        child
        for child in nannies.children(recursive=True)
        if not child.children() and not any(name in " ".join(child.cmdline()) for name in helpers)
    ]
    workers[0].kill()
    finished.append(len(list(runs.glob("*.h5"))))


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="a file in use cannot be replaced there")
def test_worker_killed_in_mid_study(start_dask: Any, tmp_path: Path) -> None:
    """The table is that of an undisturbed study, and another start solves nothing."""
    finished: list[int] = []
    over = threading.Event()
    runs = tmp_path / "runs"
    with start_dask() as address:
        killer = threading.Thread(target=kill_one_worker, args=(address, runs, over, finished))
        killer.start()
        try:
            table = pl.run_study(study(type="dask", address=address), tmp_path, progress=False)
        finally:
            over.set()
            killer.join()
    assert finished
    assert finished[0] < 18
    undisturbed = pl.run_study(study(type="serial"), progress=False, threads=1)
    assert table.sizes == undisturbed.sizes
    assert (table["status"] == "converged").all()
    for name in undisturbed.data_vars:
        if name in TIMES:
            continue
        if undisturbed[name].dtype.kind == "f":
            np.testing.assert_allclose(table[name], undisturbed[name], rtol=1e-9)
        else:
            assert (table[name].values == undisturbed[name].values).all()
    changed = {path: path.stat().st_mtime_ns for path in runs.iterdir()}
    assert len(changed) == 18, "no half-written file is left"
    pl.run_study(study(type="serial"), tmp_path, progress=False, threads=1)
    assert {path: path.stat().st_mtime_ns for path in runs.iterdir()} == changed
