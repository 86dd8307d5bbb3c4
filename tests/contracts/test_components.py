"""What holds of everything that is registered; the kit checks each component on its own."""

from typing import Annotated, Any

import jsonschema
import pytest
from pydantic import create_model

from pellicle.components import Component, FromRegistry
from pellicle.components.installed import registry
from pellicle.config.json_schema import model_schema


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
