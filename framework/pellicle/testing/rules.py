"""Check a contract rule by rule up to the first broken rule; requirements on arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.components.rules import required
from pellicle.components.rules.comparison import difference, not_pure, not_vectorised
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
    _require_nothing(difference(actual, expected, name, **allowed))


def require_vectorised(
    function: Callable[[Array], Array], argument: Array, name: str, **allowed: float
) -> None:
    """Require an array of 24 floats, each of which depends on its own argument only."""
    _require_nothing(not_vectorised(function, argument, name, **allowed))


def require_pure(function: Callable[[Array], Array], argument: Array, name: str) -> None:
    """Require that a function leaves its argument unchanged and, called again, returns the same."""
    _require_nothing(not_pure(function, argument, name))


def _require_nothing(violation: str) -> None:
    require(not violation, violation)
