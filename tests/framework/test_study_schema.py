"""The JSON schema of a study file: what varies may be left out, and nothing else is let through."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

import pellicle as pl
from tests.small_run import RUN

STUDIES = Path(__file__).parents[2] / "docs/studies"
COATED: dict[str, Any] = {
    "type": "coated",
    "tension": 1.0,
    "substrate": {"type": "bonded_layer", "reduced_modulus": 1e4, "thickness": 1e-3},
}


@pytest.fixture(scope="module")
def schema() -> Draft202012Validator:
    """Return what checks a file by the schema."""
    Draft202012Validator.check_schema(pl.json_schema())
    return Draft202012Validator(pl.json_schema())


def without(path: str) -> dict[str, Any]:
    """Return the run without one of its entries."""
    *tables, last = path.split(".")
    table = deepcopy(RUN)
    del (table[tables[0]] if tables else table)[last]
    return table


@pytest.mark.parametrize(
    ("path", "values"),
    [
        ("kernel.tension", ["1 N/m", "2 N/m"]),
        ("indenter.radius", {"start": "1 mm", "stop": "2 mm", "num": 3}),
        ("grid.points", [16, 32]),
        ("kernel.reduced_modulus", ["1 kPa", "10 kPa"]),
        ("kernel", [RUN["kernel"]]),
        ("loading", [{"depth": "1 um"}, {"force": "1 uN"}]),
    ],
)
def test_what_varies_may_be_left_out(
    path: str, values: object, schema: Draft202012Validator
) -> None:
    """A required entry is missing where an axis gives it, as in a study that can be made."""
    data = without(path) | {"study": {"vary": {path: values}}}
    assert pl.Study.from_mapping(data).points
    schema.validate(data)
    alone = without(path)
    assert not schema.is_valid(alone)


def test_what_varies_in_a_component_of_a_component(schema: Draft202012Validator) -> None:
    """A field of a kernel in a kernel may be left out too, in a study only."""
    data = RUN | {"kernel": COATED}
    axis = {"kernel.substrate.poissons_ratio": [0.3, 0.4]}
    study = data | {"study": {"vary": axis}}
    assert pl.Study.from_mapping(study).points
    schema.validate(study)
    assert not schema.is_valid(data)


@pytest.mark.parametrize(
    "change",
    [
        {"kernel": COATED | {"substrate": {"type": "half_space", "reduced_modulus": -1}}},
        {"study": {"executor": {"type": "dusk"}}},
        {"study": {"colour": "red"}},
        {"study": {"derived": {"s": 1}}},
    ],
)
def test_still_rejects(change: dict[str, Any], schema: Draft202012Validator) -> None:
    """Unknown types, keys and values are refused in a study as in a run."""
    study = {"vary": {"kernel.tension": ["1 N/m", "2 N/m"]}} | change.get("study", {})
    schema.validate(RUN | {"study": {"vary": {"kernel.tension": [1.0]}}})
    assert not schema.is_valid(RUN | change | {"study": study})
