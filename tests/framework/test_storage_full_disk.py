"""A disk that takes no more in the midst of a file, as the system tells it, not as we imagine."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import xarray as xr

import pellicle as pl
from pellicle.results import storage

if sys.platform == "win32":
    pytest.skip("has no limit on the size of files", allow_module_level=True)

import resource

from tests.tables_of_runs import RUN


@contextmanager
def files_end_at(size: int) -> Iterator[None]:
    """Let no file of this process grow beyond a size [bytes]: writing fails with an errno there."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture(scope="module")
def steps() -> list[xr.Dataset]:
    """Return three steps of a result, each on its own."""
    data = pl.run(RUN, progress=False, threads=1).dataset
    return [data.isel(step=[index]) for index in range(3)]


def write_first(path: Path, steps: list[xr.Dataset]) -> None:
    """Begin a file that is there already."""
    storage.write(steps[2], path)


def append(path: Path, steps: list[xr.Dataset]) -> None:
    """Add a step."""
    storage.append(steps[1], path)


def join_tails(path: Path, steps: list[xr.Dataset]) -> None:
    """Make a file and its tail one."""
    storage.close(path)


@pytest.mark.parametrize("act", [write_first, append, join_tails])
@pytest.mark.parametrize("size", [0, 4096, 12288])
def test_nothing_is_lost(
    act: Callable[[Path, list[xr.Dataset]], None],
    size: int,
    steps: list[xr.Dataset],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """There is a message, the file holds what it held, and no part of another is left."""
    path = tmp_path / "run.h5"
    storage.write(steps[0], path)
    with monkeypatch.context() as patch:
        if act is join_tails:
            patch.setattr(storage, "_SMALL", 0)
            storage.append(steps[1], path)
            storage.write(steps[1], path.with_name(f".{path.name}.{2:08d}.tail"))
    before = storage.read(path)
    with (
        files_end_at(size),
        pytest.raises(pl.StorageError, match=r"run\.h5: cannot be written \(File too large\)"),
    ):
        act(path, steps)
    xr.testing.assert_identical(storage.read(path), before)
    assert not list(tmp_path.glob(".*.part"))
    act(path, steps)
    assert storage.read(path).sizes["step"] >= 1
