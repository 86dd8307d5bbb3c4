"""What a rule is, and where it is asked."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

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


def broken(rules: Iterable[Rule], component: object, case: Case) -> str:
    """Return the first rule that a component breaks, with what breaks it; nothing if it keeps all.

    Exceptions that the component raises are attributed to it.
    """
    for rule in rules:
        with errors_attributed_to(component), np.errstate(all="ignore"):
            violation = rule(component, case)
        if violation:
            return f"{rule.__name__}: {violation}; required: {required(rule)}"
    return ""


def required(rule: Callable[..., object]) -> str:
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
