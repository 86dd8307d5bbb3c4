"""Studies in parts, of which one process at a time writes files, and those that are killed."""

import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
import xarray as xr

import pellicle as pl
from pellicle.batch import Part
from pellicle.results import storage
from pellicle.runs.lock import lock_files
from pellicle.studies.runner import plan_runs
from tests.command import call, run_parts
from tests.tables_of_runs import run_file

STUDY = run_file("""
[study.vary]
kernel.tension = ["0.1 N/m", "0.5 N/m", "1 N/m"]
indenter.radius = ["1 mm", "1.2 mm"]
""")
FORTY = """
[study.vary]
kernel.tension = { start = "0.1 N/m", stop = "1 N/m", num = 20, spacing = "log" }
indenter.radius = ["1 mm", "1.4 mm"]
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of a study file, which is the current one."""
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(STUDY, encoding="utf-8")
    return tmp_path


run = partial(call, "run", "s.toml")


def require_same(table: xr.Dataset, other: xr.Dataset) -> None:
    """Fail unless two tables are equal but for wall times."""
    xr.testing.assert_equal(table.drop_vars("wall_time"), other.drop_vars("wall_time"))


def table(out: str) -> xr.Dataset:
    """Return the table in a folder."""
    return xr.load_dataset(Path(out) / "study.h5", engine="h5netcdf")


def test_last_part_writes_the_table(folder: Path) -> None:
    """Parts share the runs; the table is that of one process, and no lock is left."""
    assert "4 of 6 runs are left" in run("--part", "1/3").output
    assert not (folder / "s" / "study.h5").exists()
    assert len(list((folder / "s" / "runs").iterdir())) == 2
    left = run("--part", "3/3", "--json", "--quiet").stdout
    assert json.loads(left) == {"failed": [], "left": 2}
    assert "wrote s/study.h5" in run("--part", "2/3").output.replace("\\", "/")
    run("-o", "whole", "--quiet")
    require_same(table("s"), table("whole"))
    assert not list(folder.rglob("*.lock"))


def test_runs_of_another_process_are_left_to_it(folder: Path) -> None:
    """Any part passes over locked runs, and so does the whole study, which says so."""
    first, *_ = plan_runs(pl.Study.from_toml("s.toml"), folder / "s" / "study.h5")
    with lock_files(first.journal.stem.parent, first.journal.stem.name):
        printed = run("--part", "any")
        assert f"{first.name}: another process solves it" in printed.stderr
        assert "1 of 6 runs are left" in printed.stdout
        assert "of 6 runs 1 were not finished" in run(code=1).stderr
    assert "wrote" in run("--part", "any").stdout
    assert pl.run_study("s.toml", "s", progress=False)["converged"].all()


def test_part_that_fails_says_so(folder: Path) -> None:
    """A run that fails does not stop the others, is told, and is left for the next call."""
    Path("s.toml").write_text(STUDY.replace('"1.2 mm"', '"1.2 um"'), encoding="utf-8")
    tasks = plan_runs(pl.Study.from_toml("s.toml"), folder / "s" / "study.h5")
    (folder / "s" / "runs").mkdir(parents=True)
    tasks[0].journal.path.write_bytes(b"no result")
    printed = run("--part", "1/6", code=1)
    assert f"{tasks[0].name} (file runs/{tasks[0].journal.path.name}): failed" in printed.stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--part", "4/3"], "'4/3' is neither any nor a part such as 3/40"),
        (["--part", "some"], "'some' is neither any nor a part such as 3/40"),
        (["--part", "1/2", "--overwrite"], "delete the folder to start over"),
    ],
)
def test_is_refused(options: list[str], message: str, folder: Path) -> None:
    """A part that is none, or that would delete what others did, ends before anything is solved."""
    assert message in " ".join(run(*options, code=2).stderr.split())
    assert [path.name for path in folder.iterdir()] == ["s.toml"]


def test_run_has_no_parts(folder: Path) -> None:
    """A single run is refused; a planned part lists its own runs."""
    assert "1 run, 0 done" in run("--part", "1/6", "--dry-run").output
    Path("s.toml").write_text(run_file(), encoding="utf-8")
    assert "parts are of a study" in run("--part", "1/2", code=2).stderr


def test_parts_hold_each_task_once() -> None:
    """All parts together are all tasks."""
    for count in (1, 3, 7, 12):
        parts = [Part(number, count).of(range(10)) for number in range(1, count + 1)]
        assert sorted(index for part in parts for index in part) == [*range(10)]


@pytest.mark.slow
def test_forty_parts_with_kills(tmp_path: Path) -> None:
    """Of 40 parts on two processes some are killed; the table is that of one process."""
    grid: dict[str, Any] = {"grid": {"points": 32, "size": "0.5 mm"}}
    (tmp_path / "s.toml").write_text(run_file(FORTY, **grid), encoding="utf-8")
    killed = run_parts(["run", "s.toml", "-o", "out", "--quiet"], 40, tmp_path, kills=12)
    assert killed > 3
    got = xr.load_dataset(tmp_path / "out" / "study.h5", engine="h5netcdf")
    assert np.isfinite(got["force"]).all()
    require_same(got, pl.run_study(tmp_path / "s.toml", progress=False, threads=1))
    assert len(list((tmp_path / "out" / "runs").glob("*.h5"))) == 40


TWO_RUNS = run_file("[study.vary]\nkernel.reduced_modulus = ['10 kPa', '20 kPa']")


@contextmanager
def another_process(folder: Path, name: str) -> Iterator[subprocess.Popen[bytes]]:
    """Have another process lock files."""
    code = (
        "import sys, pathlib\nfrom pellicle.runs.lock import lock_files\n"
        "with lock_files(pathlib.Path(sys.argv[1]), sys.argv[2]):\n"
        "    print('locked', flush=True)\n    sys.stdin.read()"
    )
    holder = subprocess.Popen(
        [sys.executable, "-c", code, folder, name], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert holder.stdin is not None
    assert holder.stdout is not None
    try:
        assert holder.stdout.readline() == b"locked\n"
        yield holder
    finally:
        holder.kill()
        holder.wait()
        holder.stdin.close()
        holder.stdout.close()


@pytest.mark.parametrize(("text", "name"), [(run_file(), "work"), (TWO_RUNS, "study")])
def test_second_process_is_refused(text: str, name: str, tmp_path: Path) -> None:
    """A second run or study at the same files ends at once.

    The lock of a process that was killed is no hindrance, and no lock is left behind.
    """
    file, out = tmp_path / "work.toml", tmp_path / "out"
    file.write_text(text, encoding="utf-8")
    command = ["run", str(file), "-o", str(out), "-q"]
    with another_process(out, name) as holder:
        refused = call(*command, code=2)
        assert f"{out / name} is locked by another process" in refused.stderr.replace("\n", " ")
        assert [path.name for path in out.iterdir()] == [f".{name}.lock"]
        holder.send_signal(signal.SIGKILL)
        holder.wait()
        call(*command)
    assert not list(out.rglob("*.lock"))


def test_other_files_are_not_locked(tmp_path: Path) -> None:
    """Runs of another name in the same folder, and of the same name elsewhere, do not wait."""
    (tmp_path / "work.toml").write_text(run_file(), encoding="utf-8")
    with lock_files(tmp_path / "out", "other"), lock_files(tmp_path / "elsewhere", "work"):
        result = pl.run(tmp_path / "work.toml", directory=tmp_path / "out", progress=False)
    assert result.converged


def test_nothing_is_locked_where_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run without outputs leaves the folder alone."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "work.toml").write_text(run_file(), "utf-8")
    with lock_files(tmp_path, "work"):
        assert pl.run("work.toml", progress=False).converged


def test_lock_is_released(tmp_path: Path) -> None:
    """Files may be locked again by the same process, but not twice at once."""
    for _ in range(2):
        with (
            lock_files(tmp_path, "work"),
            pytest.raises(pl.StorageError, match="is locked by another process"),
            lock_files(tmp_path, "work"),
        ):
            raise AssertionError("locked twice")
    assert list(tmp_path.iterdir()) == []


KILLED = """
[study]
executor = { type = "processes", workers = 2 }
[study.vary]
kernel.tension = { start = "0.1 N/m", stop = "1 N/m", num = 4, spacing = "log" }
indenter.radius = ["1 mm", "1.2 mm", "1.4 mm"]
"""
FILE = run_file(KILLED, grid={"points": 32, "size": "0.5 mm"})
KILLS = 2


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


@pytest.mark.slow
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


@pytest.mark.slow
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
