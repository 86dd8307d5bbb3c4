"""For each rule of all components: a component that breaks it, and only it, by a little.

The built-in components, which break none, are checked in tests/contracts.
"""

import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, ClassVar, Literal

import pytest
from pydantic import ConfigDict, Field, SerializationInfo, model_serializer

import pellicle as pl
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
