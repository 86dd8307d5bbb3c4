"""Check a contract rule by rule up to the first broken rule; requirements on arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pellicle.components.rules import required
from pellicle.components.rules.comparison import difference
from pellicle.components.rules.rule import rules_of as rules_of

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
                f"required: {required(rule)}\n"
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
