"""How many threads a run takes if it is not said."""

from __future__ import annotations

import os

import pytest

import pellicle as pl
from pellicle.runs.runner import default_threads


@pytest.mark.parametrize(
    ("points", "boundary", "threads"),
    [
        (64, "periodic", 1),
        (512, "periodic", 1),
        (1023, "periodic", 1),
        (1024, "periodic", 6),
        ((2048, 512), "periodic", 6),
        (256, "free", 1),
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
