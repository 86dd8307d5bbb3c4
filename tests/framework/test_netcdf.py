"""What is written by h5py is NetCDF-4 to the library that reads it."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from pellicle.results import netcdf


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
