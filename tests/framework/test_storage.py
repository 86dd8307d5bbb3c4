"""The one HDF5 layout, NetCDF-4 to others, and that a file is whole at every moment."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr

from pellicle.errors import StorageError
from pellicle.results import netcdf, storage

ATTRIBUTES = {"configuration": '{"a": "τ₀"}', "versions": "pellicle 0", "title": "τ₀"}


def steps(*indices: int) -> xr.Dataset:
    """Return a dataset with fields, numbers, flags and texts of some steps."""
    rng = np.random.default_rng(indices[0])
    count = len(indices)
    status = ["converged", "a longer text: τ₀"]
    return xr.Dataset(
        {
            "pressure": (("step", "x", "y"), rng.random((count, 5, 4)), {"units": "Pa"}),
            "contact": (("step", "x", "y"), rng.random((count, 5, 4)) > 0.5, {"units": "1"}),
            "force": (("step",), rng.random(count), {"units": "N"}),
            "iterations": (("step",), np.array(indices) * 10, {"units": "1"}),
            "converged": (("step",), np.array(indices) % 2 == 0, {"units": "1"}),
            "status": (("step",), np.array([status[i % 2] for i in indices], dtype=object)),
        },
        {"step": list(indices), "x": np.arange(5.0), "y": np.arange(4.0)},
        ATTRIBUTES,
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return the name of a file in a folder that does not exist yet."""
    return tmp_path / "folder" / "result.h5"


def test_append_equals_writing_at_once(path: Path) -> None:
    """Steps written one by one make the file of all steps."""
    storage.write(steps(0), path)
    storage.append(steps(1), path)
    storage.append(steps(2, 3), path)
    joined = xr.concat([steps(0), steps(1), steps(2, 3)], "step", data_vars="all")
    xr.testing.assert_identical(storage.read(path), joined)


def test_readable_by_others(path: Path) -> None:
    """The file opens with h5py and with xarray's own NetCDF reader."""
    storage.write(steps(0, 1), path)
    storage.append(steps(2), path)
    storage.close(path)
    with h5py.File(path) as file:
        assert file["pressure"].shape == (3, 5, 4)
        assert file["pressure"].attrs["units"] == "Pa"
        assert file.attrs["schema_version"] == storage.SCHEMA_VERSION
        assert file["status"].asstr()[1] == "a longer text: τ₀"
    with xr.open_dataset(path, engine="h5netcdf") as opened:
        assert dict(opened.sizes) == {"step": 3, "x": 5, "y": 4}


def test_failed_write_leaves_the_file_whole(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A failure while replacing a file, even an interruption, leaves the old one."""
    storage.write(steps(0, 1), path)
    before = path.read_bytes()

    def interrupt(*arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("os.fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        storage.write(steps(7), path)
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]


def test_nothing_half_written_has_the_name(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A new file gets its name only when it is whole and on the disk."""
    seen: list[bool] = []
    monkeypatch.setattr("os.fsync", lambda descriptor: seen.append(path.exists()))
    storage.write(steps(0), path)
    assert seen == [False]
    assert path.exists()


def test_other_schema_version(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file of another schema version is refused with both versions and what wrote it."""
    monkeypatch.setattr(storage, "SCHEMA_VERSION", 99)
    storage.write(steps(0), path)
    monkeypatch.undo()
    with pytest.raises(
        StorageError,
        match=r"version 99, and this pellicle reads 3; read it with what wrote it .pellicle 0",
    ):
        storage.read(path)


@pytest.mark.slow
def test_segments(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a large result each step is written about twice, and every one is there after each."""
    monkeypatch.setattr(storage, "_SMALL", 0)
    joins: list[int] = []
    plain = storage._join

    def join(path: Path, *more: Any) -> Any:
        joins.append(len(more[0]))
        return plain(path, *more)

    monkeypatch.setattr(storage, "_join", join)
    storage.write(steps(0), path)
    for index in range(1, 20):
        storage.append(steps(index), path)
        assert storage.read(path)["step"].values.tolist() == list(range(index + 1))
        assert storage.read(path, without=["x", "y"]).sizes == {"step": index + 1}
    assert joins == [0, 1, 3, 7]
    whole = xr.concat([steps(index) for index in range(20)], "step", data_vars="all")
    xr.testing.assert_identical(storage.read(path), whole)
    storage.close(path)
    assert list(path.parent.iterdir()) == [path]
    xr.testing.assert_identical(storage.read(path), whole)


def test_segments_that_were_joined_already(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A process that dies before it removes what it joined leaves no step twice."""
    monkeypatch.setattr(storage, "_SMALL", 0)
    storage.write(steps(0, 1, 2), path)
    storage.append(steps(3), path)
    (segment,) = (other for other in path.parent.iterdir() if other != path)
    content = segment.read_bytes()
    storage.close(path)
    segment.write_bytes(content)
    assert storage.read(path)["step"].values.tolist() == [0, 1, 2, 3]
    storage.append(steps(4), path)
    assert storage.read(path)["step"].values.tolist() == [0, 1, 2, 3, 4]
    storage.write(steps(0), path)
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("offset", [0, 2])
def test_only_the_next_step_is_appended(path: Path, offset: int) -> None:
    """A step that is there already, or that leaves one out, is refused, and the file stays."""
    storage.write(steps(1, 2), path)
    before = path.read_bytes()
    with pytest.raises(StorageError, match=r"step \d does not continue it: it ends at step 2"):
        storage.append(steps(2 + offset), path)
    assert path.read_bytes() == before


def test_only_steps_of_the_same_run_are_appended(path: Path) -> None:
    """A file never holds steps of two configurations under one identity."""
    storage.write(steps(1).assign_attrs(identity="one"), path)
    with pytest.raises(StorageError, match="step 2 does not continue it"):
        storage.append(steps(2).assign_attrs(identity="another"), path)
    assert storage.read(path).sizes["step"] == 1


def test_lack_of_memory_is_reported(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file whose content does not fit in memory is refused in words."""
    storage.write(steps(1), path)

    def exhaust(*arguments: object, **options: object) -> None:
        raise MemoryError

    monkeypatch.setattr(netcdf, "dataset", exhaust)
    with pytest.raises(StorageError, match="does not fit in memory"):
        storage.read(path)


def test_segments_that_are_joined_while_they_are_read(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A result is read whole while the run that writes it goes on."""
    monkeypatch.setattr(storage, "_SMALL", 0)
    storage.write(steps(1, 2, 3), path)
    storage.append(steps(4), path)
    assert len(list(path.parent.iterdir())) == 2
    plain, calls = storage.opened, []

    def join_first(part: Path, *arguments: Any) -> object:
        calls.append(part)
        # The first two calls count the steps of both files, the third reads the first file.
        if len(calls) == 4:
            assert part != path
            storage.close(path)
        return plain(part, *arguments)

    monkeypatch.setattr(storage, "opened", join_first)
    assert storage.read(path)["step"].values.tolist() == [1, 2, 3, 4]
    assert list(path.parent.iterdir()) == [path]


def sample() -> xr.Dataset:
    """Return a dataset of every kind of variable and dimension."""
    random = np.random.default_rng(2)
    return xr.Dataset(
        {
            "field": (("step", "x", "y"), random.normal(size=(2, 3, 4)), {"units": "Pa"}),
            "inside": (("step", "x", "y"), random.uniform(size=(2, 3, 4)) < 0.5),
            "missing": ("step", [np.nan, 1.0], {"long_name": "a name"}),
            "count": ("step", [3, 4]),
            "status": ("step", ["converged", "größer"]),
            "lone": ((), 2.5),
            "unnamed": ("other", [1.0, 2.0]),
        },
        {
            "step": [0, 1],
            "x": [0.0, 1.0, 2.0],
            "y": [0.0, 1.0, 2.0, 3.0],
            "zipped": ("step", ["a", "b"]),
        },
        {"title": "Größe", "number": 3},
    )


def test_read_as_it_was(tmp_path: Path) -> None:
    """Values, kinds, names, units, coordinates and their order come back."""
    path = tmp_path / "sample.h5"
    path.write_bytes(
        netcdf.serialised(sample(), grows=["step"], packed=["field", "inside"]).getvalue()
    )
    dataset = xr.load_dataset(path, engine="h5netcdf")
    xr.testing.assert_identical(dataset, sample())
    assert list(dataset.data_vars) == list(sample().data_vars)
    assert {name: variable.dtype.kind for name, variable in dataset.items()} == {
        name: variable.dtype.kind for name, variable in sample().items()
    }


def test_layout(tmp_path: Path) -> None:
    """Steps can grow, what is to be packed is, and a missing number is one for every reader."""
    path = tmp_path / "sample.h5"
    path.write_bytes(netcdf.serialised(sample(), grows=["step"], packed=["field"]).getvalue())
    with h5py.File(path) as file:
        assert file["field"].maxshape == (None, 3, 4)
        assert file["missing"].maxshape == (None,)
        assert file["x"].maxshape == (3,)
        assert file["field"].compression == "gzip"
        assert file["inside"].compression is None
        assert np.isnan(file["missing"].fillvalue)


def test_reads_what_it_wrote(tmp_path: Path) -> None:
    """All of it, or what does not lie along a dimension."""
    path = tmp_path / "sample.h5"
    path.write_bytes(netcdf.serialised(sample(), grows=["step"]).getvalue())
    with h5py.File(path) as file:
        xr.testing.assert_identical(netcdf.dataset(file), sample())
        xr.testing.assert_identical(netcdf.dataset(file, without=["x"]), sample().drop_dims("x"))
