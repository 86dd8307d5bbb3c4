"""Checks of the values that components return.

If a component breaks its contract they raise a `PluginError` that names the component, the returned
value and the required one. Arguments passed to components are read-only.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from contextlib import contextmanager
from numbers import Real
from traceback import extract_tb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arrays import Array, Dataset
from .errors import ConfigError, PellicleError, PluginError, excerpt


def component_name(component: object) -> str:
    """Return the name of a component for messages, such as ``kernel 'half_space'``."""
    family = getattr(component, "family", "component")
    return f"{family} {getattr(component, 'type_name', type(component).__name__)!r}"


@contextmanager
def errors_attributed_to(component: object) -> Iterator[None]:
    """Name the component and the line of its code in exceptions that it raises."""
    try:
        yield
    except (PellicleError, MemoryError):
        raise
    except Exception as error:
        if getattr(error, "__notes__", ()):
            raise
        home = inspect.getsourcefile(type(component))
        inside = [frame for frame in extract_tb(error.__traceback__) if frame.filename == home]
        line = f" ({home}, line {inside[-1].lineno})" if inside else ""
        error.add_note(f"{component_name(component)} failed{line}")
        raise


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return a view of an array that cannot be written to."""
    view = array.view()
    view.flags.writeable = False
    return view


def read_only_dataset(dataset: Dataset) -> Dataset:
    """Return a dataset that shares the arrays of ``dataset`` and cannot be used to change them."""
    # xarray replaces a view of texts by a writable array; coordinates share one with an index.
    data = {
        name: variable.copy(deep=True).data
        if variable.dtype.kind == "O"
        else read_only(np.asarray(variable.data))
        for name, variable in dataset.data_vars.items()
    }
    coordinates = {name: dataset.variables[name].copy(deep=True) for name in dataset.coords}
    # One by one, each variable would be aligned with all others: nine times as long for 34.
    return dataset.copy(data=data).assign_coords(coordinates)


def real_array(component: object, call: str, value: object, shape: tuple[int, ...]) -> Array:
    """Return the ``value`` that ``call`` of a component returned, as an array of float64.

    Integers are refused: in SI units they are values whose digits were cut off.
    """
    try:
        array = np.asarray(value)
    except ValueError:
        array = np.empty(0, dtype=object)
    is_masked = isinstance(value, np.ma.MaskedArray)
    if is_masked or array.dtype.kind != "f" or array.shape != shape:
        raise PluginError(
            f"{component_name(component)}: {call} returned {_description(value)}; it has to "
            f"return an array of float64 of shape {shape}"
        )
    return array.astype(np.float64, copy=False)


def real_number(component: object, call: str, value: object) -> float:
    """Return the number that ``call`` of a component returned, possibly infinite."""
    number = value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value
    if not isinstance(number, Real) or isinstance(number, bool) or number != number:
        raise PluginError(
            f"{component_name(component)}: {call} returned {_description(value)}; it has to "
            "return a real number"
        )
    return float(number)


def _description(value: object) -> str:
    if isinstance(value, np.ndarray):
        kind = "a masked array" if isinstance(value, np.ma.MaskedArray) else "an array"
        return f"{kind} of {value.dtype} of shape {value.shape}"
    return excerpt(value)


def whole_number(value: object, unit: str) -> int:
    """Return a positive whole number, such as of cells; messages call its unit ``unit``."""
    number = (
        value.item() if isinstance(value, np.generic | np.ndarray) and value.ndim == 0 else value
    )
    if not isinstance(number, int) or isinstance(number, bool) or not 1 <= number <= 10**9:
        raise ValueError(
            f"{excerpt(value)} is not allowed; give a whole number of {unit}, 1 to 10⁹"
        )
    return number


def checked_threads(threads: object) -> int | None:
    """Return a number of threads, or None for the default."""
    try:
        return None if threads is None else whole_number(threads, "threads")
    except ValueError as error:
        raise ConfigError(f"{error}, or None for the default", "threads") from None
