"""Figures and pages speak in words and engineering units; a page begins with a sentence."""

import numpy as np
import pytest
import xarray as xr

from pellicle.components import Axis
from pellicle.config.coordinates import Coordinate, tell_apart
from pellicle.results.wording import column_of
from pellicle.variables import VARIABLES
from pellicle_plugins.outputs.base import axis_of, label
from pellicle_plugins.outputs.html_sentences import aim_of_path, sentence_of_study


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


RADII = {"contact_radius": [[1e-6, 6.33e-6], [1e-6, 4.62e-6]], "patches": [[1, 1], [1, 1]]}


def table(**values: list[list[float]]) -> xr.Dataset:
    """Return the table of runs of two tensions and two steps."""
    return xr.Dataset(
        {
            name: (("tension", "step"), np.array(rows), VARIABLES[name].attributes)
            for name, rows in values.items()
        },
        {"tension": ("tension", [0.0, 8e-3], {"units": "N/m"}), "step": [1, 2]},
    )


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (
            {"depth": [[1e-6, 3e-6]] * 2, "force": [[1e-9, 47.6e-9], [1e-9, 118e-9]], **RADII},
            "at depth 3 µm: force 47.6, 118 nN, contact radius 6.33, 4.62 µm.",
        ),
        (
            {"depth": [[1e-6, 3e-6], [1e-6, 2e-6]], "force": [[1e-9, 5e-9]] * 2},
            "at force 5 nN: depth 3, 2 µm.",
        ),
        (
            {"depth": [[1e-6, 3e-6], [1e-6, np.nan]], "force": [[1e-9, 4e-9], [1e-9, np.nan]]},
            "at depth 3 µm: force 4 nN.",
        ),
        (
            {"depth": [[1e-6, 3e-6], [1e-6, 2e-6]], "force": [[1e-9, 5e-9], [1e-9, 6e-9]]},
            "in the last step: depth 3, 2 µm, force 5, 6 nN.",
        ),
    ],
)
def test_a_study_answers_at_what_its_runs_share(
    values: dict[str, list[list[float]]], sentence: str
) -> None:
    """Numbers are those of the last step, in the order of the runs."""
    assert sentence_of_study(table(**values), 2) == f"2 runs with tension 0, 8 mN/m; {sentence}"


def test_many_runs_are_a_range() -> None:
    """More than five numbers are not listed."""
    values = {"depth": [[1e-6, 3e-6]] * 2, "force": [[1e-9, 47.6e-9], [1e-9, 118e-9]]}
    assert "at depth 3 µm: force from 47.6 to 118 nN" in sentence_of_study(table(**values), 6)


def test_without_numbers_there_is_no_sentence() -> None:
    """Runs that all failed are not described."""
    nothing = [[1e-9, np.nan]] * 2
    assert sentence_of_study(table(depth=nothing, force=nothing), 2) == ""


def test_a_path_is_told_by_what_it_was_made_for() -> None:
    """Pull-off has the unit of all forces; of a hold the force before and after it is told."""
    columns = {"time": [0.1, 1, 5], "depth": [1e-6, 2e-6, 2e-6], "force": [1e-9, 9e-9, 4e-9]}
    data = xr.Dataset(
        {name: ("step", np.array(v), VARIABLES[name].attributes) for name, v in columns.items()},
        attrs={"prescribed": "depth"},
    )
    held = aim_of_path(data, {})
    assert (
        held == "Force 9 nN at its peak, after 1 s; force 4 nN at the end of the hold, after 5 s."
    )
    pulled = aim_of_path(data, {"pull_off": -2e-10, "pull_off_depth": -1e-7})
    assert pulled == "Pull-off force -0.2 nN, depth at pull-off -0.1 µm."
    assert aim_of_path(data.isel(step=[0, 1]), {"pull_off": np.nan}) == ""
