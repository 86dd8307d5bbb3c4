"""Rules of a contract: where they are asked, and how they tell that arrays differ."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pellicle.checks import errors_attributed_to
from pellicle.components.kernel import Kernel
from pellicle.grid import Grid


class Case(NamedTuple):
    """The grid on which a component is asked, from which tolerances follow."""

    grid: Grid
    kernel: Kernel | None = None
    """The kernel beside an interaction; None for a law as it is, without a grid."""


Rule = Callable[[Any, Case], str]
"""Return what breaks the rule, and nothing if it is kept; its docstring says what is required."""


def first_violation(rules: Iterable[Rule], component: object, case: Case) -> str:
    """Return the first rule that a component breaks, with what breaks it; nothing if it keeps all.

    Exceptions that the component raises are attributed to it.
    """
    for rule in rules:
        with errors_attributed_to(component), np.errstate(all="ignore"):
            violation = rule(component, case)
        if violation:
            return f"{rule.__name__}: {violation}; required: {requirement_of(rule)}"
    return ""


def requirement_of(rule: Callable[..., object]) -> str:
    """Return what a rule requires."""
    return " ".join((inspect.getdoc(rule) or "").split())


def rules_of(module: str) -> list[Callable[..., Any]]:
    """Return the rules of a module, which are all of its public functions, in their order."""
    return [
        value
        for name, value in vars(sys.modules[module]).items()
        if inspect.isfunction(value)
        and value.__module__ == module
        and not name.startswith(("_", "check_"))
    ]


def difference(
    actual: ArrayLike,
    expected: ArrayLike,
    name: str,
    *,
    relative: float = 0.0,
    absolute: float = 0.0,
) -> str:
    """Return the largest difference of two arrays, with its index, if they are not close."""
    actual, expected = np.asarray(actual), np.asarray(expected)
    if actual.shape != expected.shape:
        return f"{name} is of shape {actual.shape}; expected {expected.shape}"
    with np.errstate(invalid="ignore"):
        error = np.abs(actual - expected)
        allowed = absolute + relative * np.abs(expected)
    # A share of an infinite value would allow any difference.
    differs = ~((actual == expected) | (np.isfinite(error) & (error <= allowed)))
    if not differs.any():
        return ""
    size = np.where(differs, np.nan_to_num(error, nan=np.inf), -1.0)
    at = np.unravel_index(np.argmax(size), size.shape)
    where = f" at index {tuple(map(int, at))}" if at else ""
    return (
        f"{name} is {float(actual[at]):.10g}{where}; expected {float(expected[at]):.10g} within "
        f"{float(allowed[at]):.1e}; {int(differs.sum())} of {differs.size} values differ"
    )
