"""Inputs are said with their units, and by the names that a file has for them."""

from __future__ import annotations

import json
from typing import Any

import pytest

import pellicle as pl
from pellicle.config.describe import FieldRow, inputs
from pellicle.units import readable

CONFIGURATION: dict[str, Any] = {
    "title": "µ",
    "grid": {"points": [16, 12], "size": ["0.4 mm", "0.3 mm"]},
    "kernel": {
        "type": "coated",
        "tension": "0.2 N/m",
        "substrate": {
            "type": "frictionless_layer",
            "thickness": "0.1 mm",
            "youngs_modulus": 1e4,
            "poissons_ratio": 0.3,
        },
    },
    "indenter": {"type": "cone", "half_angle": "70 degree"},
    "loading": {"depth": {"start": "1 um", "stop": "20 um", "num": 20}},
    "corrections": [{"type": "yastrebov"}],
    "outputs": [{"type": "curves", "published": [{"label": "a", "x": [3, 4], "y": [1, 2]}]}],
}


@pytest.fixture(scope="module")
def table() -> dict[str, FieldRow]:
    """Return the inputs of a run by their names."""
    data = json.loads(pl.Run(**CONFIGURATION).to_json())
    return {entry.name: entry for entry in inputs(data, pl.Run)}


def test_values_have_units(table: dict[str, FieldRow]) -> None:
    """Of components within components and of lists too; a long list is shortened, and says so."""
    for name, value in {
        "grid.points": "16, 12",
        "grid.size": "400, 300 µm",
        "grid.boundary": "free",
        "kernel": "coated",
        "kernel.tension": "200 mN/m",
        "kernel.substrate": "frictionless layer",
        "kernel.substrate.thickness": "100 µm",
        "kernel.substrate.youngs_modulus": "10 kPa",
        "indenter.half_angle": "70°",
        "loading.depth": "1, 2, 3, 4, 5, 6, …, 20 µm (20 values)",
        "solver.tolerance": "1e-08",
        "corrections.0": "Yastrebov",
        "outputs.0.published.0.y": "1, 2",
    }.items():
        assert table[name].value == value


def test_inputs_are_explained(table: dict[str, FieldRow]) -> None:
    """Every one of them says what it means, and components where they come from."""
    assert all(entry.meaning for entry in table.values())
    origin = table["kernel.substrate"].origin
    assert origin is not None
    assert origin.entry_point == "kernel.frictionless_layer"
    assert origin.version == pl.__version__
    components = {"kernel", "kernel.substrate", "indenter", "solver", "corrections.0", "outputs.0"}
    assert {name for name, entry in table.items() if entry.origin} == components


def test_what_nobody_explains_is_there() -> None:
    """A component that is not installed here is listed with its bare numbers."""
    data = {"kernel": {"type": "of_a_stranger", "stiffness": 3.0, "stops": [{"at": 1}]}}
    assert [(entry.name, entry.value, entry.meaning) for entry in inputs(data, pl.Run)] == [
        ("kernel", "of a stranger", ""),
        ("kernel.stiffness", "3", ""),
        ("kernel.stops.0.at", "1", ""),
    ]


@pytest.mark.parametrize(
    ("value", "unit", "words"),
    [
        (0.0, "m", "0 m"),
        (True, "1", "True"),
        ([], "m", ""),
        ("any text", "m", "any text"),
        (12345678, "1", "12345678"),
        ([1e-6, 2e-3], "N", "0.001, 2 mN"),
        # A prefix is raised with the unit that it stands before: 10 nm² is 1e-17 m².
        (1e-8, "m**2", "0.01 mm²"),
        ([1e-12, 4e-12], "m2", "1, 4 µm²"),
        (2e-11, "N*m", "20 pN·m"),
        (9e7, "Pa/m", "90 MPa/m"),
        (3e-24, "m4", "3e-24 m⁴"),
        (5e6, "1/m", "5e+06 1/m"),
    ],
)
def test_readable(value: Any, unit: str, words: str) -> None:
    """Numbers get a prefix; what is no number is as it is."""
    assert readable(value, unit) == words
