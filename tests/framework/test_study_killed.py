"""A study killed at random moments ends as if nothing had happened."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
import xarray as xr

import pellicle as pl
from pellicle.results import storage

FILE = """
title = "12 runs of 3 steps"
outputs = []
[grid]
points = 32
size = "0.5 mm"
[kernel]
type = "tensed_membrane"
reduced_modulus = "10 kPa"
[indenter]
type = "paraboloid"
radius = "1 mm"
[loading]
depth = ["5 um", "10 um", "15 um"]
[study]
executor = { type = "processes", workers = 2 }
[study.vary]
kernel.tension = { start = "0.1 N/m", stop = "1 N/m", num = 4, spacing = "log" }
indenter.radius = ["1 mm", "1.2 mm", "1.4 mm"]
"""
KILLS = 2
TIMES = {"wall_time"}


SERIAL = ["study.executor={type='serial'}"]


def _start(folder: Path) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "pellicle", "run", "s.toml", "-o", "out", "--quiet"]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    return subprocess.Popen(command, cwd=folder, env=environment)


def _states(runs: Path) -> set[tuple[str, int]]:
    """Return the state of each file of a run, which differs from step to step."""
    files = set()
    for path in runs.glob("*.h5"):
        with suppress(FileNotFoundError):
            files.add((path.name, path.stat().st_size))
    return files


@pytest.mark.slow
def test_killed_and_restarted(tmp_path: Path) -> None:
    """SIGKILL at random moments loses no finished step, spoils no file and changes no number."""
    (tmp_path / "s.toml").write_text(FILE, encoding="utf-8")
    runs = tmp_path / "out" / "runs"
    chance = random.Random(4)
    steps: dict[str, int] = {}
    for kill in range(KILLS):
        process = _start(tmp_path)
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
    plan = pl.Study.from_toml(tmp_path / "s.toml", SERIAL)
    pl.run_study(plan, tmp_path / "out", progress=False, threads=1)
    table = xr.load_dataset(tmp_path / "out" / "study.h5", engine="h5netcdf")
    undisturbed = pl.run_study(plan, progress=False, threads=1)
    assert table.sizes == undisturbed.sizes
    for name in undisturbed.data_vars:
        if name not in TIMES:
            xr.testing.assert_equal(table[name], undisturbed[name])
    changed = {path: path.stat().st_mtime_ns for path in runs.iterdir()}
    assert len(changed) == 12, "no half-written file is left"
    pl.run_study(plan, tmp_path / "out", progress=False, threads=1)
    assert {path: path.stat().st_mtime_ns for path in runs.iterdir()} == changed
