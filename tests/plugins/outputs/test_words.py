"""Figures and pages speak in words and engineering units, never in keys of a run file."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from pellicle.components import Axis
from pellicle.config.coordinates import Coordinate, tell_apart
from pellicle.results.wording import column_of
from pellicle_plugins.outputs.base import axis_of, label


def coordinate(values: list[float], unit: str, name: str = "odd.thing") -> xr.DataArray:
    """Return the coordinate of a study."""
    return xr.Dataset(coords={name: (name, values, {"units": unit})})[name]


@pytest.mark.parametrize(
    ("values", "unit", "texts"),
    [
        ([0.9e-6, 1.1e-6], "m", ["thing 0.9 µm", "thing 1.1 µm"]),
        ([1.00001, 1.00002], "N", ["thing 1.00001 N", "thing 1.00002 N"]),
        ([0.0, 1e-30], "m", ["thing 0 m", "thing 1e-30 m"]),
        ([float("nan"), 1e-3], "N", ["thing –", "thing 1 mN"]),
        ([float("inf"), -2e-9], "N", ["thing ∞ nN", "thing -2 nN"]),
        ([2.0, 3.0], "1/m^0.5", ["thing 2 1/m^0.5", "thing 3 1/m^0.5"]),
        ([5.0, 6.0], "photons", ["thing 5 photons", "thing 6 photons"]),
        ([0.25, 0.5], "", ["thing 0.25", "thing 0.5"]),
        ([-1e-3, 0.0], "rad", ["thing -0.0573°", "thing 0°"]),
        ([1e-9, 2e-6], "m2", ["thing 0.001 mm²", "thing 2 mm²"]),
    ],
)
def test_values_of_an_axis(values: list[float], unit: str, texts: list[str]) -> None:
    """All values of an axis are in one unit, with digits that tell them apart."""
    axis = coordinate(values, unit)
    how = column_of(axis)
    assert [how.text(value) for value in values] == texts


def test_a_stranger_s_words() -> None:
    """A variable without words is named by its own name; with words, by those, also from a file."""
    plain = xr.DataArray([1e-6], dims="step", name="my_own_length", attrs={"units": "m"})
    assert column_of(plain).read()[0] == "my own length [µm]"
    titled = plain.assign_attrs(short_name="length of mine")
    assert column_of(titled).read()[0] == "length of mine [µm]"
    scaled = (titled * 1.23456789).drop_attrs().assign_attrs(titled.attrs)
    assert column_of(scaled).read(si=True) == ("length of mine [m]", ["1.23457e-06"])


def test_axes_of_equal_words_are_told_apart() -> None:
    """Two radii of a study name the table that they are in; other axes do not."""
    names = {"kernel.radius": "radius", "indenter.radius": "radius", "kernel.tension": "tension"}
    axes = {
        key: Coordinate(np.empty(1), {"long_name": words, "short_name": words})
        for key, words in names.items()
    }
    tell_apart(axes)
    assert [axis.attributes["short_name"] for axis in axes.values()] == [
        "radius of the kernel",
        "radius of the indenter",
        "tension",
    ]


def test_the_label_of_an_expression_has_no_wrong_unit() -> None:
    """A force over a modulus is not in newtons, though xarray keeps the unit of the force."""
    table = xr.Dataset(
        {"force": ("step", [1e-6, 2e-6], {"units": "N"})}, attrs={"configuration": "{}"}
    )
    assert axis_of("force", None, table) == Axis("force", "N")
    assert axis_of("force / 3", None, table) == Axis("force / 3", as_given=True)
    assert axis_of("force", "pull [N]", table) == Axis("pull [N]", as_given=True)


def test_a_label_has_no_endless_number() -> None:
    """More than 99 digits are no format of a number."""
    data = xr.Dataset({"force": ((), 0.5)}, attrs={"configuration": "{}"})
    assert label("{force:.2f} N", data, (), data).words == "0.50 N"
    assert label("{force:.999f} N", data, (), data).words == "{force:.999f} N"
