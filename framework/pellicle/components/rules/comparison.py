"""What is wrong with arrays and functions of arrays, in words; nothing if they are right."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array


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


def not_vectorised(
    function: Callable[[Array], Array], argument: Array, name: str, *, relative: float
) -> str:
    """Return why a function of 24 floats is no array of floats that depend each on its own one."""
    single = [np.ravel(function(value.copy()))[0] for value in np.split(argument, argument.size)]
    for shape in ((24,), (4, 6), (2, 3, 4)):
        values = function(argument.reshape(shape).copy())
        if not (isinstance(values, np.ndarray) and values.dtype == np.float64):
            return f"{name} is {type(values).__name__} of {getattr(values, 'dtype', 'no')} dtype"
        words = f"{name} for an argument of shape {shape}"
        if differs := difference(values, np.reshape(single, shape), words, relative=relative):
            return differs
    return ""


def not_pure(function: Callable[[Array], Array], argument: Array, name: str) -> str:
    """Return how a function changes its argument, or its value when it is called again."""
    passed = argument.copy()
    first = np.array(function(passed))
    return difference(passed, argument, f"after {name}, its argument") or difference(
        function(passed), first, f"the second {name}"
    )
