"""The table of a layered kernel: units, paths of nested fields, messages, studies, schema."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

import pellicle as pl

TOML = """
[grid]
points = 16
size = "0.4 mm"
[kernel]
type = "layered"
layers = [
    { youngs_modulus = "1 MPa", poissons_ratio = 0.3, thickness = "5 um" },
    { reduced_modulus = "10 kPa", poissons_ratio = 0.5, thickness = "0.1 mm" },
]
substrate = { youngs_modulus = "3 kPa", poissons_ratio = 0.4 }
[indenter]
type = "paraboloid"
radius = "1 mm"
[loading]
depth = "10 um"
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Return the file of a run on two layers."""
    path = tmp_path / "layers.toml"
    path.write_text(TOML, encoding="utf-8")
    return path


def changed(file: Path, *changes: str) -> dict[str, Any]:
    """Return the table of the kernel after changes as by ``--set``."""
    table: dict[str, Any] = pl.Run.from_toml(file, changes).kernel.model_dump(exclude_none=True)
    return table


def test_nested_values_are_in_si(file: Path) -> None:
    """Units are converted in layers and substrate; either modulus may be given."""
    first, second = changed(file)["layers"]
    assert first == {"youngs_modulus": 1e6, "poissons_ratio": 0.3, "thickness": 5e-6}
    assert second == {"reduced_modulus": 1e4, "poissons_ratio": 0.5, "thickness": 1e-4}
    assert changed(file)["substrate"] == {"youngs_modulus": 3e3, "poissons_ratio": 0.4}


def test_nested_fields_can_be_set(file: Path) -> None:
    """Layers count from 0, and the substrate can be replaced as a whole."""
    assert changed(file, 'kernel.layers.1.thickness="2 mm"')["layers"][1]["thickness"] == 2e-3
    assert changed(file, 'kernel.substrate.youngs_modulus="1 GPa"')["substrate"] == {
        "youngs_modulus": 1e9,
        "poissons_ratio": 0.4,
    }
    assert changed(file, "kernel.substrate=rigid")["substrate"] == "rigid"


def test_a_study_varies_a_nested_field(file: Path) -> None:
    """An axis may be a field of one layer, which the run then may leave out."""
    data = tomllib.loads(TOML)
    del data["kernel"]["layers"][0]["thickness"]
    axis = {"kernel.layers.0.thickness": ["1 um", "10 um"]}
    study = data | {"study": {"vary": axis}}
    tables = [point.run.kernel.model_dump() for point in pl.Study.from_mapping(study).points]
    assert [table["layers"][0]["thickness"] for table in tables] == [1e-6, 1e-5]
    schema = Draft202012Validator(pl.json_schema())
    schema.validate(study)
    assert not schema.is_valid(data)


@pytest.mark.parametrize(
    ("path", "value", "valid"),
    [
        ("substrate", "rigid", True),
        ("substrate", "stiff", False),
        ("substrate", {"reduced_modulus": "1 kPa", "poissons_ratio": 0.2}, True),
        ("substrate", {"reduced_modulus": "1 kPa"}, False),
        ("layers", [], False),
        ("layers", [{"youngs_modulus": 1, "poissons_ratio": 0.1, "thickness": 0}], False),
        ("layers", [{"youngs_modulus": 1, "poissons_ratio": 0.1, "thickness": 1}], True),
    ],
)
def test_the_schema_knows_the_nested_table(path: str, value: Any, valid: bool) -> None:
    """An editor marks what a run refuses."""
    data = tomllib.loads(TOML)
    data["kernel"][path] = value
    assert Draft202012Validator(pl.json_schema()).is_valid(data) == valid
