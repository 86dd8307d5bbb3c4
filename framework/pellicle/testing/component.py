"""How contract rules are asked, and those that components of all families keep."""

from __future__ import annotations

import importlib
import json
import pickle
import tomllib
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import ArrayLike

from pellicle.components import Component
from pellicle.components.installed import registry
from pellicle.components.rules import CHEAP, Case, requirement_of
from pellicle.components.rules.rule import difference
from pellicle.components.rules.rule import rules_of as rules_of
from pellicle.errors import PellicleError
from pellicle.plugins.origins import GROUP
from pellicle.plugins.registry import InstalledComponent, checked_type, family_of
from pellicle.units import parts_of, quantity_of

Rule = Callable[..., str | None]
"""A function of a component that raises, or returns what is wrong, if the component breaks it."""


def keep(rules: Iterable[Rule], component: Any, *arguments: Any) -> None:
    """Call each rule; raise AssertionError with class, rule and violation of the first broken."""
    for rule in rules:
        cause = None
        try:
            # Formulas may overflow; what that leads to is a violation or harmless.
            with np.errstate(all="ignore"):
                violation = rule(component, *arguments)
        except AssertionError as error:
            violation = str(error)
        except Exception as error:
            violation, cause = f"{type(error).__name__}: {error}", error
        if violation:
            raise AssertionError(
                f"{type(component).__name__} breaks the rule {rule.__name__}\n"
                f"required: {requirement_of(rule)}\n"
                f"violation: {violation}"
            ) from cause


def require(holds: bool | np.bool_, message: str) -> None:
    """Raise AssertionError with a message unless a condition holds, under ``python -O`` too."""
    if not holds:
        raise AssertionError(message)


def require_close(actual: ArrayLike, expected: ArrayLike, name: str, **allowed: float) -> None:
    """Raise AssertionError with the largest difference if two arrays differ; see `difference`."""
    violation = difference(actual, expected, name, **allowed)
    require(not violation, violation)


def check(
    component: object,
    base: type[Component],
    rules: list[Rule],
    *arguments: Any,
    cases: Iterable[Case] = (),
) -> None:
    """Check the rules of all components, then those of the family of a base class.

    Of these, the rules that need no run are asked in each of the ``cases``, the others with
    ``arguments``. Rules that need an installed plugin come last, so that the others can be checked
    without it.
    """
    keep([is_an_instance], component, base)
    keep(RULES, component)
    for case in cases:
        keep(CHEAP[base.family], component, case)
    keep(rules, component, *arguments)
    keep([is_registered, goes_through_the_registry], component)


def is_an_instance(component: object, base: type[Component]) -> None:
    """The check of a family takes an instance of a component of that family."""
    if isinstance(component, type):
        raise AssertionError(
            f"{component.__name__} is a class; pass an instance: {component.__name__}(…)"
        )
    name = f"{base.__module__.partition('.')[0]}.{base.__name__}"
    require(isinstance(component, base), f"{component!r}, which is not a {name}")


def class_can_be_registered(component: Component) -> None:
    """The class has one type, a docstring, descriptions, a JSON schema and all methods."""
    try:
        checked_type(type(component))
    except PellicleError as error:
        raise AssertionError(str(error)) from None


def numbers_have_units(component: Component) -> None:
    """A float field is a Quantity, of unit "1" for a pure number."""
    for name, info in type(component).model_fields.items():
        quantity = quantity_of(info)
        require(
            quantity is not None or float not in parts_of(info.annotation),
            f'the field {name} is a bare float; annotate it with Quantity("SI unit") or one of '
            "pellicle.units, such as Length",
        )


def is_frozen_and_closed(component: Component) -> None:
    """No field can be set under a run, and an unknown field is an error, not ignored."""
    config = type(component).model_config
    require(config.get("frozen") is True, "fields can be set; leave model_config frozen")
    require(
        config.get("extra") == "forbid",
        'unknown fields are accepted; leave model_config extra="forbid"',
    )


def pickles(component: Component) -> None:
    """A pickled copy, as workers get it, is equal and has an equal hash."""
    copy = pickle.loads(pickle.dumps(component))
    require(type(copy) is type(component) and copy == component, f"{copy!r} of {component!r}")
    require(hash(copy) == hash(component), "the hash of the copy differs")


def goes_through_files(component: Component) -> None:
    """The component written as JSON, and that as TOML, reproduces the component."""
    again = type(component)(**tomllib.loads(tomli_w.dumps(_table(component))))
    require(again == component, f"{again!r} of {component!r}")


def _table(component: Component) -> dict[str, Any]:
    table: dict[str, Any] = json.loads(component.model_dump_json(exclude_none=True))
    return table


def is_registered(component: Component) -> None:
    """An installed plugin registers the class under its type."""
    family, type_ = component.family, _table(component)["type"]
    module, name = type(component).__module__, type(component).__name__
    try:
        registered = registry().find(family, type_)
    except PellicleError as error:
        raise AssertionError(
            f"{error}\nIf the plugin is yours, its pyproject.toml needs\n"
            f'    [project.entry-points.{GROUP}]\n    "{family}.{type_}" = "{module}:{name}"\n'
            "and the package has to be installed again: pip install -e ."
        ) from None
    require(
        registered is type(component),
        f"{type_!r} is {registered.__module__}.{registered.__qualname__}, not this class of "
        f"{module}; give yours another type, or import it under the name in the entry point",
    )


def goes_through_the_registry(component: Component) -> None:
    """The registry reproduces a component from its table, and returns a component unchanged."""
    base = family_of(type(component))
    for table in (_table(component), component.model_dump()):
        again = registry().make(base, table)
        require(again == component, f"{again!r} of {component!r}")
    require(registry().make(base, component) is component, "a component is copied")


RULES: list[Rule] = [
    class_can_be_registered,
    numbers_have_units,
    is_frozen_and_closed,
    pickles,
    goes_through_files,
]


def kit_of(base: type[Component]) -> Callable[[Component], None] | None:
    """Return ``check_FAMILY`` of the package of a family's base class; None if it has none."""
    name = f"{base.__module__.partition('.')[0]}.testing"
    module = importlib.import_module(name) if find_spec(name) else None
    return getattr(module, f"check_{base.family}", None)


def verdict_on_examples(registered: InstalledComponent) -> tuple[bool, str]:
    """Return whether the examples of a component keep its contract, and in words how far.

    Without examples only what registration requires of the class has been checked.
    """
    base = family_of(registered.component)
    kit = kit_of(base)
    if kit is None or not registered.examples:
        lack = "examples" if kit else f"checks of the family {base.family!r}"
        return True, f"class rules only: there are no {lack}"
    for number, example in enumerate(registered.examples, start=1):
        try:
            kit(registered.component(**example))
        except Exception as error:
            return False, f"example {number}: {error}"
    return True, "keeps its contract"
