"""Check a contract rule by rule up to the first broken rule; requirements on arrays."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array

Rule = Callable[..., None]
"""A function of a component that raises if the component breaks the rule in its docstring."""


def rules_of(module: str) -> list[Rule]:
    """Return the rules of a module, which are all of its public functions, in their order."""
    return [
        value
        for name, value in vars(sys.modules[module]).items()
        if inspect.isfunction(value)
        and value.__module__ == module
        and not name.startswith(("_", "check_"))
    ]


def keep(rules: Iterable[Rule], component: Any, *arguments: Any) -> None:
    """Call each rule; raise AssertionError with class, rule and violation of the first broken."""
    for rule in rules:
        try:
            rule(component, *arguments)
        except Exception as error:
            own = isinstance(error, AssertionError)
            message = str(error) if own else f"{type(error).__name__}: {error}"
            text = " ".join((inspect.getdoc(rule) or "").split())
            raise AssertionError(
                f"{type(component).__name__} breaks the rule {rule.__name__}\n"
                f"required: {text}\n"
                f"violation: {message}"
            ) from (None if own else error)


def require(holds: bool | np.bool_, message: str) -> None:
    """Raise AssertionError with a message unless a condition holds, under ``python -O`` too."""
    if not holds:
        raise AssertionError(message)


def require_close(
    actual: ArrayLike,
    expected: ArrayLike,
    name: str,
    *,
    relative: float = 0.0,
    absolute: float = 0.0,
) -> None:
    """Raise AssertionError with the index of the largest difference if two arrays differ."""
    actual, expected = np.asarray(actual), np.asarray(expected)
    require(
        actual.shape == expected.shape,
        f"{name} is of shape {actual.shape}; expected {expected.shape}",
    )
    with np.errstate(invalid="ignore"):
        error = np.abs(actual - expected)
        allowed = absolute + relative * np.abs(expected)
    # A share of an infinite value would allow any difference.
    differs = ~((actual == expected) | (np.isfinite(error) & (error <= allowed)))
    if not differs.any():
        return
    size = np.where(differs, np.nan_to_num(error, nan=np.inf), -1.0)
    at = np.unravel_index(np.argmax(size), size.shape)
    where = f" at index {tuple(map(int, at))}" if at else ""
    raise AssertionError(
        f"{name} is {float(actual[at]):.10g}{where}; expected {float(expected[at]):.10g} within "
        f"{float(allowed[at]):.1e}; {int(differs.sum())} of {differs.size} values differ"
    )


def require_vectorised(
    function: Callable[[Array], Array],
    argument: Array,
    name: str,
    *,
    relative: float = 0.0,
    of_largest: float = 0.0,
) -> None:
    """Require an array of 24 floats, each of which depends on its own argument only."""
    single = [np.ravel(function(value.copy()))[0] for value in np.split(argument, argument.size)]
    for shape in ((24,), (4, 6), (2, 3, 4)):
        values = function(argument.reshape(shape).copy())
        require(
            isinstance(values, np.ndarray) and values.dtype == np.float64,
            f"{name} is {type(values).__name__} of {getattr(values, 'dtype', 'no')} dtype",
        )
        require_close(
            values,
            np.reshape(single, shape),
            f"{name} for an argument of shape {shape}",
            relative=relative,
            absolute=of_largest * float(np.abs(single).max()),
        )


def require_pure(function: Callable[[Array], Array], argument: Array, name: str) -> None:
    """Require that a function leaves its argument unchanged and, called again, returns the same."""
    passed = argument.copy()
    first = np.array(function(passed))
    require_close(passed, argument, f"after {name}, its argument")
    require_close(function(passed), first, f"the second {name}")
