"""What the tests of the kit share: built-in classes to break, and what the kit says of a mutant."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from pellicle import testing
from pellicle.plugins import registry


def base(family: str, type_: str) -> Any:
    """Return the class of a built-in component."""
    return registry().components[family][type_].component


def complaint(family: str, component: Any) -> str:
    """Return what the kit says of a component."""
    with pytest.raises(AssertionError) as caught:
        getattr(testing, f"check_{family}")(component)
    return str(caught.value)


def check_mutant(family: str, mutant: Any, rule: str) -> None:
    """Check that the kit names the class, the rule, the requirement and the violation."""
    message = complaint(family, mutant)
    first, demand, finding = message.split("\n")[:3]
    assert first.startswith(f"{type(mutant).__name__} breaks the rule ")
    assert first.split()[-1] == rule, message
    assert demand.startswith("required: ")
    assert len(finding) > len("violation: ")


def check_base(family: str, component: Any) -> None:
    """Check that a component breaks nothing but that no plugin registers it."""
    message = complaint(family, component)
    assert "breaks the rule is_registered\n" in message
    assert f'"{family}.broken" = "' in message
    assert "pip install -e ." in message


def rules_of(family: str, monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Return the names of the rules of a family, without those of all components."""
    rules: set[str] = set()

    def collect(component: object, family: str, own: Any, *arguments: Any) -> None:
        rules.update(rule.__name__ for rule in own)

    monkeypatch.setattr(sys.modules[f"pellicle.testing.{family}s"], "check", collect)
    getattr(testing, f"check_{family}")(None)
    return rules
