"""How a contract is checked: rules in a row, and one message for the first that is broken."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

Rule = Callable[..., None]
"""A function of a component that raises if the sentence of its docstring does not hold."""


def keep(rules: Iterable[Rule], component: Any, *arguments: Any) -> None:
    """Call each rule with the component and ``arguments``.

    Raises
    ------
    AssertionError
        A rule is broken; names the class, the rule and what was found.
    """
    for rule in rules:
        try:
            rule(component, *arguments)
        except Exception as error:
            own = isinstance(error, AssertionError)
            said = str(error) if own else f"{type(error).__name__}: {error}"
            asked = " ".join((inspect.getdoc(rule) or "").split())
            raise AssertionError(
                f"{type(component).__name__} breaks the rule {rule.__name__}\n"
                f"asked: {asked}\n"
                f"found: {said}"
            ) from (None if own else error)


def require(kept: bool | np.bool_, found: str) -> None:
    """Raise AssertionError that says what was found, unless a rule is kept."""
    if not kept:
        raise AssertionError(found)


def require_close(
    found: ArrayLike,
    expected: ArrayLike,
    what: str,
    *,
    relative: float = 0.0,
    absolute: float = 0.0,
) -> None:
    """Raise AssertionError with the worst place where two arrays differ by more than is allowed."""
    found, expected = np.asarray(found), np.asarray(expected)
    require(
        found.shape == expected.shape,
        f"{what} is of shape {found.shape}; expected {expected.shape}",
    )
    # One that is not finite differs from everything.
    wrong = ~(np.abs(found - expected) <= absolute + relative * np.abs(expected))
    if not wrong.any():
        return
    error = np.where(wrong, np.abs(found - expected), -1.0)
    at = np.unravel_index(np.argmax(np.nan_to_num(error, nan=np.inf)), error.shape)
    where = f" at index {tuple(map(int, at))}" if at else ""
    allowed = absolute + relative * abs(float(expected[at]))
    raise AssertionError(
        f"{what} is {float(found[at]):.10g}{where}; expected {float(expected[at]):.10g} within "
        f"{allowed:.1e}; {int(wrong.sum())} of {wrong.size} values differ"
    )
