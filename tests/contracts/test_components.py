"""What holds of everything that is registered, and that each keeps its contract, by the kit."""

import math
from typing import Annotated, Any

import jsonschema
import numpy as np
import pytest
from pydantic import create_model

import pellicle as pl
from pellicle import Run, testing
from pellicle.components import Component, FromRegistry
from pellicle.components.installed import FAMILIES, registry
from pellicle.config.json_schema import model_schema
from pellicle.plugins.registry import family_of
from pellicle.runs.runner import solve
from pellicle.testing.component import kit_of, require_close


@pytest.fixture(scope="module")
def schemas() -> dict[str, jsonschema.Draft202012Validator]:
    """Return a validator of each family's tables, as a run or a study has them."""

    def validator(family: str, base: Any) -> jsonschema.Draft202012Validator:
        table = create_model(family, it=(Annotated[base, FromRegistry()], ...))
        return jsonschema.Draft202012Validator(model_schema(table))

    return {
        family: validator(family, base)
        for family, base in registry().families.items()
        if registry().components[family]
    }


def test_nothing_installed_is_broken() -> None:
    """Every entry point loads and no two plugins claim one name."""
    assert registry().broken == ()
    assert registry().clashes == {}


def test_schema_takes_what_the_component_takes(
    component: Component,
    examples: dict[str, dict[str, Any]],
    schemas: dict[str, jsonschema.Draft202012Validator],
) -> None:
    """The schema accepts the component as it is written by hand and as it is dumped."""
    table = component.model_dump(mode="json", exclude_none=True)
    schemas[component.family].validate({"it": table})
    by_hand = examples[component.family][table["type"]]
    schemas[component.family].validate({"it": {"type": table["type"], **by_hand}})


def test_schema_refuses_what_the_component_refuses(
    component: Component, schemas: dict[str, jsonschema.Draft202012Validator]
) -> None:
    """An editor marks an unknown field and an unknown type."""
    table = component.model_dump(mode="json", exclude_none=True)
    assert not schemas[component.family].is_valid({"it": table | {"nonsense": 1}})
    assert not schemas[component.family].is_valid({"it": table | {"type": "nonsense"}})


def test_keeps_its_contract(component: Component) -> None:
    """One call checks all that is asked of a component."""
    check = kit_of(family_of(type(component)))
    assert check is not None
    check(component)


def test_each_family_has_a_check() -> None:
    """The kit has a function for each family, named after it, and no others."""
    named = {name for name in vars(testing) if name.startswith("check_")}
    assert named == {f"check_{family}" for family in FAMILIES}
    assert all(map(kit_of, registry().families.values()))


def test_a_skin_of_little_tension_keeps_the_contract() -> None:
    """The closed form of an elastocapillary length of 2 pm is right to eight digits only."""
    testing.check_kernel(pl.kernel("tensed_membrane", reduced_modulus="1 GPa", tension="1 mN/m"))


def test_infinite_values_agree_with_their_equals_only() -> None:
    """Infinity is close to itself, and to no number, however large the allowed share."""
    require_close([math.inf, -math.inf, 1.0], [math.inf, -math.inf, 1.0], "the gap", relative=0.1)
    for actual, expected in ((1.0, math.inf), (-math.inf, math.inf), (math.inf, 1.0)):
        with pytest.raises(AssertionError, match=f"the gap is {actual:g}.*expected {expected:g}"):
            require_close([actual], [expected], "the gap", relative=0.1)
    with pytest.raises(AssertionError, match="the gap is nan"):
        require_close([math.nan], [math.nan], "the gap")


def test_result_has_the_periodic_area() -> None:
    """On a periodic grid a contact has the same corrected area wherever the domain is cut."""

    def areas(shift: float) -> tuple[float, float]:
        x = np.arange(24)[:, None] + shift
        heights = np.cos(2 * np.pi * x / 24) + np.cos(2 * np.pi * np.arange(24) / 24)
        run = Run(
            grid={"points": 24, "size": 1e-3, "boundary": "periodic"},
            kernel={"type": "half_space", "reduced_modulus": 1e4},
            indenter={"type": "heights", "values": heights, "unit": "1 um"},
            loading={"mean_pressure": 10.0},
            corrections=[{"type": "yastrebov"}],
        )
        data = solve(run).dataset
        return data["contact_area"].item(), data["contact_area_yastrebov"].item()

    (cells, inside), (cells_across, across) = areas(12), areas(0)
    assert cells == cells_across
    assert inside < cells
    assert across == pytest.approx(inside, rel=1e-12)
