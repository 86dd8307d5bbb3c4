"""What every component keeps: it is configuration, code, schema and provenance in one object."""

import json
import pickle
from typing import Any

import jsonschema
import pytest
from pydantic import ValidationError

import pellicle as pl
from pellicle.components import FAMILIES, Component
from pellicle.plugins import registry

RUN: dict[str, Any] = {
    "grid": {"points": 13, "size": "1 mm", "boundary": "free"},
    "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": "10 um"},
}
PLACES = {"correction": "corrections", "output": "outputs"}
"""Fields of a run that hold lists of components, by family; the others are named as the family."""


@pytest.fixture(scope="module")
def schema() -> jsonschema.Draft202012Validator:
    """Return a validator of run files."""
    made = pl.schema()
    jsonschema.Draft202012Validator.check_schema(made)
    return jsonschema.Draft202012Validator(made)


def table(component: Component) -> dict[str, Any]:
    """Return the component as a file would hold it."""
    return json.loads(component.model_dump_json(exclude_none=True))


def run_with(component: Component, **more: Any) -> dict[str, Any]:
    """Return a run file with the component in its place."""
    given = table(component) | more
    if component.family in PLACES:
        return RUN | {PLACES[component.family]: [given]}
    return RUN | {component.family: given}


def test_nothing_installed_is_broken() -> None:
    """Every entry point loads and no two plugins claim one name."""
    assert registry().broken == ()
    assert registry().clashes == {}


def test_every_component_has_an_example(examples: dict[str, dict[str, Any]]) -> None:
    """Each type that pellicle registers has its fields in examples.py, and no other has."""
    own = {
        (family, type_)
        for family, members in registry().components.items()
        for type_, registered in members.items()
        if registered.origin.distribution == "pellicle"
    }
    assert {(family, type_) for family, members in examples.items() for type_ in members} == own


def test_is_frozen(component: Component) -> None:
    """No field can be changed, so that a configuration cannot change under a run."""
    for name in type(component).model_fields:
        with pytest.raises(ValidationError, match="frozen"):
            setattr(component, name, getattr(component, name))


def test_pickles(component: Component) -> None:
    """A copy by pickle, as a worker gets it, is equal and of equal hash."""
    copy = pickle.loads(pickle.dumps(component))
    assert type(copy) is type(component)
    assert copy == component
    assert hash(copy) == hash(component)


def test_round_trip(component: Component) -> None:
    """What is written into a result makes the same component again."""
    base = FAMILIES[component.family]
    assert registry().make(base, table(component)) == component
    assert registry().make(base, component.model_dump()) == component
    assert registry().make(base, component) is component


def test_example_is_valid_by_the_schema(
    component: Component,
    examples: dict[str, dict[str, Any]],
    schema: jsonschema.Draft202012Validator,
) -> None:
    """The schema accepts the component as it is written by hand and as it is dumped."""
    if component.family == "executor":
        pytest.skip("belongs to a study, not to a run")
    schema.validate(run_with(component))
    type_ = component.model_dump()["type"]
    by_hand = {"type": type_, **examples[component.family][type_]}
    key = PLACES.get(component.family)
    schema.validate(RUN | ({key: [by_hand]} if key else {component.family: by_hand}))


def test_schema_refuses_what_the_component_refuses(
    component: Component, schema: jsonschema.Draft202012Validator
) -> None:
    """An editor marks an unknown field and an unknown type."""
    if component.family == "executor":
        pytest.skip("belongs to a study, not to a run")
    assert not schema.is_valid(run_with(component, nonsense=1))
    assert not schema.is_valid(run_with(component, type="nonsense"))


def test_docstring_starts_with_a_sentence(component: Component) -> None:
    """The first line, which users see in a table, is short and ends with a period."""
    line = (type(component).__doc__ or "").partition("\n")[0]
    assert 0 < len(line) <= 100
    assert line.endswith(".")


def test_every_field_is_described(component: Component) -> None:
    """Each parameter says what it is, and one with a dimension names its SI unit."""
    for name, its in type(component).model_fields.items():
        if name == "type":
            continue
        assert its.description
        unit = component.model_json_schema()["properties"].get(name, {}).get("unit")
        if unit:
            assert f"[{unit}]" in its.description


def test_unknown_field_is_refused(component: Component) -> None:
    """A field that does not exist is named, and nothing is made."""
    given = table(component) | {"nonsense": 1}
    with pytest.raises(pl.ConfigError, match="nonsense: is not a field here"):
        registry().make(FAMILIES[component.family], given)
