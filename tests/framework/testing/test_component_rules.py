"""For each rule of all components: a component that breaks it, and only it, by a little.

The built-in components, which break none, are checked in tests/contracts.
"""

import threading
import tomllib
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, ClassVar, Literal, Self

import pytest
from pydantic import ConfigDict, Field, SerializationInfo, model_serializer, model_validator

import pellicle as pl
from pellicle import ConfigError
from pellicle.config import explain
from pellicle.plugins import registry
from pellicle.testing import component as component_rules
from pellicle.units import Length
from tests.framework.testing.mutants import base, complaint

Paraboloid: Any = base("indenter", "paraboloid")


class NoDocstring(Paraboloid):
    type: Literal["no_docstring"] = "no_docstring"


NoDocstring.__doc__ = None


class Unfinished(Paraboloid):
    """Shape without a full stop"""  # noqa: D400

    type: Literal["unfinished"] = "unfinished"


class Wishful(Paraboloid):
    """Shape of a library that nobody has."""

    libraries: ClassVar[tuple[str, ...]] = ("pellicle-no-such-library",)


class NoType(pl.AreaCorrection):
    """Correction that has no type."""

    def area(self, contact: Any, spacing: Any) -> float:
        """Return the count [m²]."""
        return float(contact.sum() * spacing[0] * spacing[1])


class NoDescription(Paraboloid):
    """Paraboloid with a field that nobody explains."""

    type: Literal["no_description"] = "no_description"
    offset: Length = 1.0


class BareFloat(Paraboloid):
    """Paraboloid with a number of no unit."""

    type: Literal["bare_float"] = "bare_float"
    offset: Annotated[float | None, Field(description="some length [m]")] = None


class UnitNotTold(Paraboloid):
    """Paraboloid whose description hides a unit."""

    type: Literal["unit_not_told"] = "unit_not_told"
    offset: Annotated[Length | None, Field(description="some length")] = None


class Thawed(Paraboloid):
    """Paraboloid whose fields can be set."""

    model_config = ConfigDict(frozen=False)
    type: Literal["thawed"] = "thawed"

    def __hash__(self) -> int:
        return hash(self.radius)


class Unpicklable(Paraboloid):
    """Paraboloid that stays at home."""

    type: Literal["unpicklable"] = "unpicklable"

    def __getstate__(self) -> Any:
        return threading.Lock()


class Forgetful(Paraboloid):
    """Paraboloid that is written without what it was given."""

    type: Literal["forgetful"] = "forgetful"

    @model_serializer
    def _wrong(self) -> dict[str, Any]:
        return {"type": "forgetful", "radius": 2 * self.radius}


class Holey(Paraboloid):
    """Paraboloid with a list that TOML cannot hold."""

    type: Literal["holey"] = "holey"
    marks: Annotated[tuple[int | None, ...], Field(description="numbers, or none")] = (1, None)


class Hospitable(Paraboloid):
    """Paraboloid whose schema has room for more than it takes."""

    model_config = ConfigDict(json_schema_extra={"additionalProperties": True})
    type: Literal["hospitable"] = "hospitable"


class TwoFaced(Paraboloid):
    """Paraboloid that is another as a Python table than as JSON."""

    type: Literal["two_faced"] = "two_faced"

    @model_serializer
    def _wrong(self, info: SerializationInfo) -> dict[str, Any]:
        factor = 2 if info.mode == "python" else 1
        return {"type": "two_faced", "radius": factor * self.radius}


class Tied(Paraboloid):
    """Paraboloid of two radii whose units give both the same example."""

    type: Literal["tied"] = "tied"
    outer: Annotated[Length, Field(description="radius beyond the flat [m]")]

    @model_validator(mode="after")
    def _check_radii(self) -> Self:
        if self.outer <= self.radius:
            raise ConfigError("has to exceed radius", "outer")
        return self


class Agreeing(Tied):
    """Paraboloid of two radii with examples that agree."""

    type: Literal["agreeing"] = "agreeing"  # type: ignore[assignment]
    outer: Annotated[Length, Field(examples=["1 cm"], description="radius beyond the flat [m]")]


class Welcoming(Paraboloid):
    """Paraboloid that takes any field."""

    model_config = ConfigDict(extra="ignore")
    type: Literal["welcoming"] = "welcoming"


class Stranger(Paraboloid):
    """Paraboloid that no plugin registers."""

    type: Literal["stranger"] = "stranger"


class Usurper(Paraboloid):
    """Paraboloid under a name that is taken."""

    type: Literal["paraboloid"] = "paraboloid"


GENERAL: dict[str, tuple[Callable[[], Any], str]] = {
    "a class": (lambda: Paraboloid, "is_an_instance"),
    "another family": (lambda: base("kernel", "half_space")(reduced_modulus=1.0), "is_an_instance"),
    "no docstring": (partial(NoDocstring, radius=1e-3), "class_can_be_registered"),
    "no description": (partial(NoDescription, radius=1e-3), "class_can_be_registered"),
    "no full stop": (partial(Unfinished, radius=1e-3), "docstring_starts_with_a_sentence"),
    "bare float": (partial(BareFloat, radius=1e-3), "numbers_have_units"),
    "unit not told": (partial(UnitNotTold, radius=1e-3), "numbers_have_units"),
    "not frozen": (partial(Thawed, radius=1e-3), "is_frozen"),
    "no pickle": (partial(Unpicklable, radius=1e-3), "pickles"),
    "other JSON": (partial(Forgetful, radius=1e-3), "goes_through_json"),
    "no TOML": (partial(Holey, radius=1e-3), "goes_through_toml"),
    "other schema": (partial(Hospitable, radius=1e-3), "schema_tells_the_fields"),
    "no such library": (partial(Wishful, radius=1e-3), "libraries_are_installed"),
    "no such example": (partial(Tied, radius=1e-3, outer=1e-2), "takes_its_example"),
    "unknown fields": (partial(Welcoming, radius=1e-3), "unknown_field_is_refused"),
    "not registered": (partial(Stranger, radius=1e-3), "is_registered"),
    "type is taken": (partial(Usurper, radius=1e-3), "is_registered"),
}


def test_each_rule_has_a_mutant() -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    rules = {rule.__name__ for rule in component_rules.RULES} | {"is_an_instance", "is_registered"}
    assert rules == {rule for _, rule in GENERAL.values()}


@pytest.mark.parametrize("name", GENERAL)
def test_general_rule_is_checked(name: str) -> None:
    """What is wrong with a component of any family is caught by the rule that says so."""
    make, rule = GENERAL[name]
    assert f"breaks the rule {rule}\n" in complaint("indenter", make())


def test_an_example_is_printed_only_if_it_makes_the_component(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where fields are tied their units give no example; examples that agree are printed."""
    ours = registry()
    more = {
        component.model_fields["type"].default: replace(
            ours.components["indenter"]["paraboloid"],
            component=component,
            type=component.model_fields["type"].default,
        )
        for component in (Tied, Agreeing)
    }
    changed = replace(ours, components={**ours.components, "indenter": more})
    monkeypatch.setattr(explain, "registry", lambda: changed)
    (tied,) = explain.explanations("tied", {})
    assert tomllib.loads(tied.example) == {}
    assert "outer: has to exceed radius" in tied.example
    (agreeing,) = explain.explanations("agreeing", {})
    table = tomllib.loads(agreeing.example)["indenter"]
    assert Agreeing(**table).outer == 1e-2


def test_the_example_of_a_prescription_is_one_of_its_values() -> None:
    """The example of a pure number has no unit."""

    class Share(base("prescription", "contact_area")):  # type: ignore[misc]
        """Share of the domain in contact."""

        unit: ClassVar[str] = "1"

    entry = replace(registry().components["prescription"]["contact_area"], component=Share)
    (value,) = explain.example_table(entry)["contact_area"]
    assert Share.quantity()(value) > 0


def test_the_registry_makes_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """A component that is installed, and another when it has been a table, is caught."""
    ours = registry()
    mine = replace(ours.components["indenter"]["paraboloid"], component=TwoFaced, type="two_faced")
    more = {**ours.components["indenter"], "two_faced": mine}
    changed = replace(ours, components={**ours.components, "indenter": more})
    monkeypatch.setattr(component_rules, "registry", lambda: changed)
    message = complaint("indenter", TwoFaced(radius=1e-3))
    assert "breaks the rule goes_through_the_registry\n" in message


def test_a_class_of_no_type_is_named() -> None:
    """A class that cannot be registered is told what it lacks."""
    assert 'NoType needs a field: type: Literal["…"] = "…"' in complaint("correction", NoType())
