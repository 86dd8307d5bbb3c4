"""Cases of known truth that plugins register."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from pellicle.results.result import Result


@dataclass(frozen=True)
class Case:
    """A case of known truth: one row of ``pellicle validate``."""

    name: str
    """What is solved, e.g. ``"Hertz sphere: force"``."""
    configuration: dict[str, Any]
    """The run, as a TOML file would say it."""
    computed: Callable[[Result], float]
    """Takes the quantity out of the result, SI."""
    expected: float
    """Its true value, SI."""
    unit: str
    """Of both, for the table."""
    tolerance: float
    """Relative error that is allowed."""
    source: str
    """Where the true value comes from: author, year."""


Suite = Callable[[], Iterable[Case]]
"""Makes cases, when somebody wants to see them solved."""
