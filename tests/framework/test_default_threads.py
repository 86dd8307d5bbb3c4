"""How many threads a run takes if it is not said, and which numbers it is told are none."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

import pellicle as pl
from pellicle.components.installed import registry
from pellicle.runs.runner import default_threads
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
