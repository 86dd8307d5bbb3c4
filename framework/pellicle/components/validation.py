"""Validation cases with known results, which plugins register."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pellicle.errors import ConfigError

if TYPE_CHECKING:
    from pellicle.results import Result


@dataclass(frozen=True)
class Case:
    """A run with one known quantity: one row of ``pellicle validate``."""

    name: str
    """Name of the case, e.g. ``"Hertz sphere: force"``."""
    configuration: dict[str, Any]
    """The run, in the form of a TOML file."""
    computed: Callable[[Result], float]
    """Function that returns the computed quantity from the result, SI."""
    expected: float
    """Its true value, SI; not 0, as the error is relative."""
    unit: str
    """Unit of both values, for the table."""
    tolerance: float
    """Allowed relative error."""
    source: str
    """Source of the true value: author, year."""

    def __post_init__(self) -> None:
        if not self.expected:
            raise ConfigError("0 has no relative error; compare another quantity", "expected")


Suite = Callable[[], Iterable[Case]]
"""Function that returns the cases of a plugin, called only when they are to be solved."""
