"""How many threads a run takes if it is not said, and how much memory by an estimate before it."""

import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy
import scipy.fft
from packaging.version import Version

import pellicle as pl
from pellicle import memory
from pellicle.components.installed import registry
from pellicle.runs.memory_estimate import memory_of
from pellicle.runs.runner import default_threads
from pellicle.surface.convolution import blocks, in_threads, row_blocks
from tests.framework.broken.catalogue import PARTS
from tests.tables_of_runs import half_space, paraboloid, pressing, self_affine, tensed

RUN: Any = PARTS | {"loading": {"depth": "2 um"}}
VARY: Any = {"indenter.radius": [1e-3]}


@pytest.mark.parametrize(
    ("points", "boundary", "threads"),
    [
        (1023, "periodic", 1),
        (1024, "periodic", 6),
        ((2048, 512), "periodic", 6),
        (511, "free", 1),
        (512, "free", 6),
    ],
)
def test_threads_are_taken_where_transforms_are_large(
    points: int, boundary: str, threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All cores from 1024² transformed points on, of which a free grid has four for each cell."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: set(range(6)), raising=False)
    grid = pl.Grid(points=points, size=1.0, boundary=boundary)
    assert default_threads(grid) == threads


@pytest.mark.parametrize("threads", [0, 1.5, "2", True, [2]], ids=repr)
def test_threads_are_a_whole_number(threads: Any, tmp_path: Path) -> None:
    """Anything but None or a whole number ≥ 1 is refused in words, and nothing is computed."""
    address = {"address": "tcp://127.0.0.1:8786"}
    for use in (
        lambda: pl.run(RUN, directory=tmp_path, threads=threads),
        lambda: pl.run_study(pl.Study(run=RUN, vary=VARY), tmp_path, threads=threads),
        lambda: registry().make(pl.Executor, {"type": "serial", "threads": threads}),
        lambda: registry().make(pl.Executor, {"type": "processes", "threads": threads}),
        lambda: registry().make(pl.Executor, {"type": "dask", "threads": threads} | address),
    ):
        with pytest.raises(pl.ConfigError, match=r"threads: .* whole number of threads, 1 to"):
            use()
    assert not list(tmp_path.iterdir())


def test_blocks_cover_every_index_once() -> None:
    """Blocks are in order, without gaps; the last one is shorter."""
    assert blocks(10, 4) == [slice(0, 4), slice(4, 8), slice(8, 10)]
    assert blocks(0) == []
    assert [rows.stop - rows.start for rows in row_blocks((5, 2**15))] == [2, 2, 1]
    assert row_blocks((3, 2**20)) == [slice(0, 1), slice(1, 2), slice(2, 3)]


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_as_many_threads_as_asked_for_take_part(threads: int) -> None:
    """Work that waits for all threads ends only if each takes a block; results keep their order."""
    meeting = threading.Barrier(threads)

    def work(number: int) -> tuple[int, str]:
        if number < threads:
            meeting.wait(timeout=10)
        return number, threading.current_thread().name

    with scipy.fft.set_workers(threads):
        results = in_threads(work, range(20))
    assert [number for number, _ in results] == list(range(20))
    assert len({name for _, name in results[:threads]}) == threads


def test_work_within_work_does_not_wait_for_itself() -> None:
    """A block that shares blocks of its own is computed on the thread that has it."""
    with scipy.fft.set_workers(2):
        sums = in_threads(
            lambda row: sum(in_threads(lambda column: row * column, range(5))), range(50)
        )
    assert sums == [10 * row for row in range(50)]


@pytest.mark.parametrize("failing", [0, 7])
def test_errors_of_any_thread_are_raised(failing: int) -> None:
    """An error in one block reaches the caller, also after the others."""

    def work(number: int) -> None:
        if number == failing:
            raise ValueError("this block")

    with scipy.fft.set_workers(2), pytest.raises(ValueError, match="this block"):
        in_threads(work, range(8))


def test_floating_point_errors_are_handled_as_by_the_caller() -> None:
    """All threads see the caller's `numpy.errstate`."""
    meeting = threading.Barrier(2)

    def work(_: int) -> str:
        meeting.wait(timeout=10)
        return np.geterr()["divide"]

    with scipy.fft.set_workers(2), np.errstate(divide="ignore"):
        assert in_threads(work, range(2)) == ["ignore", "ignore"]


SIZE = 1e-3
LINE = "periodic, a line of cells"
JKR = {"type": "jkr", "work_of_adhesion": 0.02, "estimate_error": False}
OUTPUTS = ["csv", "figures", "maps", "html", "vtk", "patches", "spectrum", "distributions"]
HALF_SPACE, SKIN = half_space(1e4), tensed(1e4, 0.05)
LAYER = {"type": "bonded_layer", "youngs_modulus": 1e4, "poissons_ratio": 0.4, "thickness": 1e-4}


def _relaxing(branches: int) -> dict[str, Any]:
    relaxation = [{"fraction": 0.8 / branches, "time": 10.0**n} for n in range(branches)]
    return {"type": "viscoelastic", "solid": HALF_SPACE, "relaxation": relaxation}


DRAINING = {
    "type": "poroelastic",
    "shear_modulus": 1e3,
    "poissons_ratio": 0.2,
    "diffusivity": 1e-9,
}
SKIN_ON_GEL = {"type": "coated", "tension": 0.01, "substrate": _relaxing(2)}


def _kind(points: int, boundary: str = "free", **changes: Any) -> dict[str, Any]:
    depth = 2e-5 if boundary == "free" else 1e-6
    cells, bead = [points, points], paraboloid(1e-3)
    tables = pressing(cells, SIZE, HALF_SPACE, bead, boundary=boundary, depth=depth)
    return {**tables, "outputs": [], **changes}


def _rough(points: int, cells: float) -> dict[str, Any]:
    return self_affine(1e-6, 0.8, cells * SIZE / points)


def _full(points: int) -> dict[str, Any]:
    return {"indenter": _rough(points, 16), "loading": {"mean_pressure": 5e3}}


# Below 1024² the figures themselves take as much as the fields.
ALL_OUTPUTS: dict[str, Any] = {"outputs": [{"type": name} for name in OUTPUTS]}
KINDS = {
    "free": _kind(384, kernel=SKIN),
    "free, contact over most of the domain": _kind(384, loading={"depth": 2e-4}),
    "free, tabulated kernel": _kind(384, kernel=LAYER),
    "free, four steps": _kind(384, loading={"depth": [5e-6, 1e-5, 1.5e-5, 2e-5]}),
    "free, conjugate_gradient": _kind(384, solver={"type": "conjugate_gradient"}),
    "free, contact stiffness": _kind(384, loading={"depth": 2e-5, "stiffness": True}),
    "free, sticks": _kind(256, interaction=JKR, loading={"depth": [2e-5, 1e-5]}),
    "periodic, sticks": _kind(256, "periodic", interaction=JKR, loading={"depth": [2e-6, 1e-6]}),
    "periodic, full contact": _kind(384, "periodic", **_full(384)),
    "periodic, conjugate_gradient": _kind(384, "periodic", solver={"type": "conjugate_gradient"}),
    "periodic, self-affine down to two cells": _kind(
        384, "periodic", indenter=_rough(384, 2.01), loading={"depth": 2e-6}
    ),
    "periodic, four steps": _kind(384, "periodic", loading={"depth": [1e-6, 2e-6, 3e-6, 4e-6]}),
    "periodic, full contact, many outputs": _kind(1024, "periodic", **_full(1024), **ALL_OUTPUTS),
    "free, a solid that relaxes": _kind(
        384, kernel=_relaxing(5), loading={"depth": [1e-4] * 4, "time": [0, 1, 2, 3]}
    ),
    "periodic, a skin on a solid that relaxes": _kind(
        384,
        "periodic",
        kernel=SKIN_ON_GEL,
        loading={"force": [1e-6] * 4, "time": [0, 1, 3, 6]},
    ),
    "free, a skin on a solid that relaxes": _kind(
        384, kernel=SKIN_ON_GEL, loading={"force": [1e-6] * 4, "time": [0, 1, 3, 6]}
    ),
    "free, a solid that drains": _kind(
        384, kernel=DRAINING, loading={"depth": [1e-5] * 4, "time": [0, 1, 3, 6]}
    ),
    LINE: _kind(
        384,
        "periodic",
        grid={"points": [2**19, 1], "size": [SIZE, SIZE / 2**19], "boundary": "periodic"},
    ),
}


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_estimate_grows_with_cells_and_steps(boundary: str) -> None:
    """Twice the points take four times the memory, and steps that are kept take more."""
    large, larger, longer = (
        memory_of(pl.Run(**_kind(points, boundary, loading={"depth": [1e-6] * steps})))
        for points, steps in ((4096, 1), (8192, 1), (4096, 10))
    )
    assert larger == pytest.approx(4 * large, rel=1e-2)
    assert longer > 2 * large


FULL_CONTACT = {
    "free, contact over most of the domain",
    "free, conjugate_gradient",
    "periodic, full contact",
    "periodic, conjugate_gradient",
    "periodic, full contact, many outputs",
}


def _growths(threads: int, names: Iterable[str]) -> dict[str, int]:
    """Return the growth of the peak of a process [bytes] in each kind of run.

    Arrays are mapped one by one, as glibc maps those above 32 MB, which matter. Of the smaller ones
    of these grids the heap would keep 0 to 3 after they are freed, at random.
    """
    script = Path(__file__).with_name("memory_growth.py")
    given = json.dumps({name: KINDS[name] for name in names})
    done = subprocess.run(
        [sys.executable, str(script), str(threads)],
        env=os.environ | {"MALLOC_MMAP_THRESHOLD_": str(2**17)},
        input=given,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    growths: dict[str, int] = json.loads(done.stdout)
    return growths


@pytest.fixture(scope="module")
def growths() -> dict[str, int]:
    """Return what was measured of each kind of run."""
    return _growths(1, KINDS)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("kind", KINDS)
def test_estimate_is_the_growth_of_the_peak(kind: str, growths: dict[str, int]) -> None:
    """The estimate is 0.95 to 1.15 times the growth of the peak in full contact.

    A small contact takes up to a third less, and from scipy 1.18 on a transform along a line needs
    two arrays less than the estimate assumes.
    """
    most = 1.15 if kind in FULL_CONTACT else 1.4
    if kind == LINE and Version(scipy.__version__) >= Version("1.18"):
        most = 1.6
    run = pl.Run(**KINDS[kind])
    # Without the arrays that the heap would keep, see `_growths`.
    kept = 3 * 8 * run.grid.points[0] * run.grid.points[1]
    assert 0.95 <= (memory_of(run) - kept) / growths[kind] <= most


def test_require(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that does not fit is refused, one that fits or on a machine that is silent is not."""
    grid, needed = pl.Grid(points=64, size=1.0, boundary="free"), 1e9
    monkeypatch.setattr(memory, "available", lambda: needed * 0.99)
    with pytest.raises(pl.ConfigError, match=r"grid\.points: 64 × 64 with 1 step needs about"):
        memory.require(needed, grid, 1)
    monkeypatch.setattr(memory, "available", lambda: needed * 1.01)
    memory.require(needed, grid, 1)
    monkeypatch.setattr(memory, "available", lambda: None)
    memory.require(needed, grid, 1)


MACHINE = 8e9
V2 = "sys/fs/cgroup"


def _system(root: Path, group: str, folders: dict[str, dict[str, str]]) -> Path:
    """Make the files of a system of 8 GB; ``folders`` has those of its control groups."""
    files = {
        "proc/meminfo": {"": "MemTotal: 9000000 kB\nMemAvailable: 7812500 kB\n"},
        "proc/self/cgroup": {"": group},
        **folders,
    }
    for folder, contents in files.items():
        for name, text in contents.items():
            path = root / folder / name if name else root / folder
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    return root


def _v2(limit: object, used: object, cached: int = 0) -> dict[str, str]:
    stat = f"anon 5\ninactive_file {cached}\nactive_file 7\n"
    return {"memory.max": f"{limit}\n", "memory.current": f"{used}\n", "memory.stat": stat}


GIGABYTE = 10**9
GROUPS: dict[str, tuple[str, dict[str, dict[str, str]], float]] = {
    "v2": ("0::/job\n", {f"{V2}/job": _v2(4 * GIGABYTE, GIGABYTE)}, 3e9),
    "v2, file cache is given up": (
        "0::/job\n",
        {f"{V2}/job": _v2(4 * GIGABYTE, 3 * GIGABYTE, 2 * GIGABYTE)},
        3e9,
    ),
    "v2, a group around it has less": (
        "0::/user/job\n",
        {f"{V2}/user/job": _v2("max", 1), f"{V2}/user": _v2(2 * GIGABYTE, GIGABYTE)},
        1e9,
    ),
    "v2, named as seen from outside": (
        "0::/docker/0123\n",
        {V2: _v2(2 * GIGABYTE, GIGABYTE)},
        1e9,
    ),
    "v2, more than the machine has": (
        "0::/job\n",
        {f"{V2}/job": _v2(64 * GIGABYTE, GIGABYTE)},
        MACHINE,
    ),
    "v2, nothing left": ("0::/job\n", {f"{V2}/job": _v2(GIGABYTE, GIGABYTE + 5)}, 0.0),
}


@pytest.mark.parametrize("which", GROUPS)
def test_available_respects_control_groups(which: str, tmp_path: Path) -> None:
    """Containers and batch systems bound what a process may have of the machine's memory."""
    group, folders, expected = GROUPS[which]
    assert memory.available(_system(tmp_path, group, folders)) == pytest.approx(expected)


def test_unreadable_groups_are_no_limit(tmp_path: Path) -> None:
    """A limit that cannot be read, a folder in its place, is passed over."""
    root = _system(tmp_path, "0::/job\n", {f"{V2}/job": {"memory.current": "5"}})
    (root / V2 / "job" / "memory.max").mkdir()
    assert memory.available(root) == pytest.approx(MACHINE)
