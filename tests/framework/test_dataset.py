"""The variables of a result."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import pellicle as pl

FIELDS = {"pressure": "Pa", "displacement": "m", "gap": "m", "contact": "1"}
NUMBERS = {
    "depth": "m",
    "force": "N",
    "mean_pressure": "Pa",
    "contact_area": "m2",
    "contact_fraction": "1",
    "contact_area_yastrebov": "m2",
    "contact_fraction_yastrebov": "1",
    "mean_contact_pressure": "Pa",
    "contact_radius": "m",
    "semi_major_axis": "m",
    "semi_minor_axis": "m",
    "major_axis_angle": "rad",
    "patches": "1",
    "perimeter": "m",
    "iterations": "1",
    "operator_applications": "1",
    "residual_contact": "1",
    "residual_penetration": "1",
    "residual_complementarity": "1",
    "converged": "1",
    "status": None,
}


@pytest.fixture(scope="module")
def dataset() -> xr.Dataset:
    """Return the dataset of two steps on a rectangle."""
    run = pl.Run(
        grid={"points": [16, 20], "size": ["0.5 mm", "0.4 mm"]},
        kernel={"type": "half_space", "reduced_modulus": "10 kPa"},
        indenter={"type": "sphere", "radius": "1 mm"},
        loading={"depth": ["5 um", "10 um"]},
        corrections=[{"type": "yastrebov"}],
    )
    return pl.run(run, progress=False).dataset


@pytest.mark.parametrize(("name", "unit"), FIELDS.items())
def test_field(dataset: xr.Dataset, name: str, unit: str) -> None:
    """Each field is there for every step and cell, with its unit."""
    assert dataset[name].dims == ("step", "x", "y")
    assert dataset[name].shape == (2, 16, 20)
    assert dataset[name].attrs["units"] == unit


@pytest.mark.parametrize(("name", "unit"), NUMBERS.items())
def test_number(dataset: xr.Dataset, name: str, unit: str | None) -> None:
    """Each number is there for every step, with its unit."""
    assert dataset[name].dims == ("step",)
    assert dataset[name].attrs.get("units") == unit


def test_every_variable_is_described(dataset: xr.Dataset) -> None:
    """Each variable and coordinate says what it is."""
    assert all(variable.attrs["long_name"] for variable in dataset.variables.values())


def test_coordinates_are_cell_centres(dataset: xr.Dataset) -> None:
    """Coordinates are the centres of the cells in metres."""
    x, y = pl.Grid(points=[16, 20], size=["0.5 mm", "0.4 mm"]).coordinates()
    assert np.array_equal(dataset["x"], x.ravel())
    assert np.array_equal(dataset["y"], y.ravel())
    assert dataset["x"].attrs["units"] == dataset["y"].attrs["units"] == "m"


def test_types(dataset: xr.Dataset) -> None:
    """Contact and converged are flags, counts are whole, status is text."""
    assert dataset["contact"].dtype == bool
    assert dataset["converged"].dtype == bool
    assert dataset["iterations"].dtype.kind == "i"
    assert dataset["operator_applications"].dtype.kind == "i"
    assert list(dataset["status"].values) == ["converged", "converged"]


def test_numbers_agree_with_fields(dataset: xr.Dataset) -> None:
    """Force, area, fraction and mean pressure are those of the fields."""
    cell, domain = 5e-4 / 16 * 4e-4 / 20, 5e-4 * 4e-4
    contact = dataset["contact"].sum(("x", "y")).values
    force = dataset["pressure"].sum(("x", "y")).values * cell
    assert dataset["force"].values == pytest.approx(force, rel=1e-12)
    assert dataset["mean_pressure"].values == pytest.approx(force / domain, rel=1e-12)
    assert dataset["contact_area"].values == pytest.approx(contact * cell, rel=1e-12)
    assert dataset["contact_fraction"].values == pytest.approx(contact * cell / domain, rel=1e-12)
    assert np.array_equal(dataset["contact"], dataset["pressure"] > 0)
    assert dataset["depth"].values == pytest.approx([5e-6, 10e-6])
