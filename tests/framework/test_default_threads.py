"""How many threads a run takes if it is not said, and that they change nothing but the time."""

import os
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.fft

import pellicle as pl
from pellicle.components.installed import registry
from pellicle.runs.runner import default_threads
from pellicle.surface.convolution import blocks, row_blocks, shared
from tests.framework.broken.catalogue import PARTS

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
        results = shared(work, range(20))
    assert [number for number, _ in results] == list(range(20))
    assert len({name for _, name in results[:threads]}) == threads


def test_work_within_work_does_not_wait_for_itself() -> None:
    """A block that shares blocks of its own is computed on the thread that has it."""
    with scipy.fft.set_workers(2):
        sums = shared(lambda row: sum(shared(lambda column: row * column, range(5))), range(50))
    assert sums == [10 * row for row in range(50)]


@pytest.mark.parametrize("failing", [0, 7])
def test_errors_of_any_thread_are_raised(failing: int) -> None:
    """An error in one block reaches the caller, also after the others."""

    def work(number: int) -> None:
        if number == failing:
            raise ValueError("this block")

    with scipy.fft.set_workers(2), pytest.raises(ValueError, match="this block"):
        shared(work, range(8))


def test_floating_point_errors_are_handled_as_by_the_caller() -> None:
    """All threads see the caller's `numpy.errstate`."""
    meeting = threading.Barrier(2)

    def work(_: int) -> str:
        meeting.wait(timeout=10)
        return np.geterr()["divide"]

    with scipy.fft.set_workers(2), np.errstate(divide="ignore"):
        assert shared(work, range(2)) == ["ignore", "ignore"]
