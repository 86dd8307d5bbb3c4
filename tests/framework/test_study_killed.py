"""A study whose process or worker is killed in its midst ends as if nothing had happened."""

import os
import random
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
import xarray as xr

import pellicle as pl
from pellicle.results import storage
from tests.tables_of_runs import run_file

STUDY = """
[study]
executor = { type = "processes", workers = 2 }
[study.vary]
kernel.tension = { start = "0.1 N/m", stop = "1 N/m", num = 4, spacing = "log" }
indenter.radius = ["1 mm", "1.2 mm", "1.4 mm"]
"""
FILE = run_file(STUDY, grid={"points": 32, "size": "0.5 mm"})
KILLS = 2
pytestmark = pytest.mark.slow


def study(folder: Path, executor: str) -> pl.Study:
    """Return the study of the file with another executor."""
    (folder / "s.toml").write_text(FILE, encoding="utf-8")
    return pl.Study.from_toml(folder / "s.toml", [f"study.executor={executor}"])


def require_undisturbed(table: xr.Dataset, folder: Path, rtol: float = 0.0) -> None:
    """Fail unless the table is that of a study that nothing happened to, and nothing is left."""
    plan = study(folder, "{type='serial'}")
    undisturbed = pl.run_study(plan, progress=False, threads=1)
    assert table.sizes == undisturbed.sizes
    for name in undisturbed.data_vars:
        if name == "wall_time":
            continue
        if undisturbed[name].dtype.kind == "f":
            np.testing.assert_allclose(table[name], undisturbed[name], rtol=rtol)
        else:
            assert (table[name].values == undisturbed[name].values).all()
    runs = folder / "out" / "runs"
    changed = {path: path.stat().st_mtime_ns for path in runs.iterdir()}
    assert len(changed) == 12, "no half-written file is left"
    pl.run_study(plan, folder / "out", progress=False, threads=1)
    assert {path: path.stat().st_mtime_ns for path in runs.iterdir()} == changed


def _states(runs: Path) -> set[tuple[str, int]]:
    """Return the state of each file of a run, which differs from step to step."""
    files = set()
    for path in runs.glob("*.h5"):
        with suppress(FileNotFoundError):
            files.add((path.name, path.stat().st_size))
    return files


def test_killed_and_restarted(tmp_path: Path) -> None:
    """SIGKILL at random moments loses no finished step, spoils no file and changes no number."""
    plan = study(tmp_path, "{type='serial'}")
    command = [sys.executable, "-m", "pellicle", "run", "s.toml", "-o", "out", "--quiet"]
    runs = tmp_path / "out" / "runs"
    chance = random.Random(4)
    steps: dict[str, int] = {}
    for kill in range(KILLS):
        process = subprocess.Popen(command, cwd=tmp_path, env=os.environ | {"OMP_NUM_THREADS": "1"})
        # Counted in files, not in seconds: a slow machine must be killed in mid-study too.
        seen = _states(runs)
        wanted = len(seen) + chance.randrange(1, 4)
        while process.poll() is None and len(seen) < wanted:
            seen |= _states(runs)
            time.sleep(0.002)
        time.sleep(chance.random() * 0.05)
        process.send_signal(signal.SIGKILL)
        assert process.wait() == -signal.SIGKILL, f"it had ended before kill {kill}"
        for path in runs.glob("*.h5"):
            count = storage.read(path).sizes["step"]
            assert count >= steps.get(path.name, 0)
            steps[path.name] = count
    assert 0 < sum(steps.values()) < 36
    pl.run_study(plan, tmp_path / "out", progress=False, threads=1)
    table = xr.load_dataset(tmp_path / "out" / "study.h5", engine="h5netcdf")
    require_undisturbed(table, tmp_path)


def kill_one_worker(runs: Path, over: threading.Event, finished: list[int]) -> None:
    """Kill a worker of dask as soon as there is a result, and note how many there are."""
    while not list(runs.glob("*.h5")):
        if over.wait(0.005):
            return
    time.sleep(0.02)
    helpers = ("resource_tracker", "semaphore_tracker")
    # Other tests of this process may have workers of their own.
    ours = (c for c in psutil.Process().children() if "distributed.cli.dask_worker" in c.cmdline())
    nanny = max(ours, key=psutil.Process.create_time)
    workers = [
        child
        for child in nanny.children(recursive=True)
        if not child.children() and not any(name in " ".join(child.cmdline()) for name in helpers)
    ]
    workers[0].kill()
    finished.append(len(list(runs.glob("*.h5"))))


@pytest.mark.skipif(sys.platform == "win32", reason="a file in use cannot be replaced there")
def test_dask_worker_killed(start_dask: Any, tmp_path: Path) -> None:
    """The other worker does the runs of the one that is killed."""
    finished: list[int] = []
    over = threading.Event()
    out = tmp_path / "out"
    with start_dask() as address:
        killer = threading.Thread(target=kill_one_worker, args=(out / "runs", over, finished))
        killer.start()
        try:
            plan = study(tmp_path, f"{{type='dask', address='{address}'}}")
            table = pl.run_study(plan, out, progress=False)
        finally:
            over.set()
            killer.join()
    assert finished
    assert finished[0] < 12
    require_undisturbed(table, tmp_path, rtol=1e-9)
