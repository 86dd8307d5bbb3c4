"""The variables of a result."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from tests.small_run import RUN


@pytest.fixture(scope="module")
def dataset() -> xr.Dataset:
    """Return the dataset of three steps on a rectangle."""
    run = pl.Run(**RUN | {"grid": {"points": [20, 16], "size": ["0.4 mm", "0.3 mm"]}})
    return pl.run(run, progress=False).dataset


def test_every_variable_is_described(dataset: xr.Dataset) -> None:
    """Each variable and coordinate says what it is."""
    assert all(variable.attrs["long_name"] for variable in dataset.variables.values())


def test_coordinates_are_cell_centres(dataset: xr.Dataset) -> None:
    """Coordinates are the centres of the cells in metres."""
    x, y = pl.Grid(points=[20, 16], size=["0.4 mm", "0.3 mm"]).coordinates()
    assert np.array_equal(dataset["x"], x.ravel())
    assert np.array_equal(dataset["y"], y.ravel())
    assert dataset["x"].attrs["units"] == dataset["y"].attrs["units"] == "m"


def test_types(dataset: xr.Dataset) -> None:
    """Contact and converged are flags, counts are whole, status is text."""
    assert dataset["contact"].dtype == bool
    assert dataset["converged"].dtype == bool
    assert dataset["iterations"].dtype.kind == "i"
    assert dataset["operator_applications"].dtype.kind == "i"
    assert list(dataset["status"].values) == ["converged"] * 3


def test_numbers_agree_with_fields(dataset: xr.Dataset) -> None:
    """Force, area, fraction and mean pressure are those of the fields."""
    cell, domain = 4e-4 / 20 * 3e-4 / 16, 4e-4 * 3e-4
    contact = dataset["contact"].sum(("x", "y")).values
    force = dataset["pressure"].sum(("x", "y")).values * cell
    assert dataset["force"].values == pytest.approx(force, rel=1e-12)
    assert dataset["mean_pressure"].values == pytest.approx(force / domain, rel=1e-12)
    assert dataset["contact_area"].values == pytest.approx(contact * cell, rel=1e-12)
    assert dataset["contact_fraction"].values == pytest.approx(contact * cell / domain, rel=1e-12)
    assert np.array_equal(dataset["contact"], dataset["pressure"] > 0)
    assert dataset["depth"].values == pytest.approx([5e-6, 10e-6, 15e-6])
