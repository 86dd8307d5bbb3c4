"""Validation cases with known results, which plugins register."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from pellicle.results.result import Result


@dataclass(frozen=True)
class Case:
    """A run with one known quantity: one row of ``pellicle validate``."""

    name: str
    """Name of the case, e.g. ``"Hertz sphere: force"``."""
    configuration: dict[str, Any]
    """The run as a TOML file would have it."""
    computed: Callable[[Result], float]
    """Returns the computed quantity of the result, SI."""
    expected: float
    """Its true value, SI."""
    unit: str
    """Unit of both values, for the table."""
    tolerance: float
    """Allowed relative error."""
    source: str
    """Source of the true value: author, year."""


Suite = Callable[[], Iterable[Case]]
"""Returns the cases of a plugin; called only when they are to be solved."""
