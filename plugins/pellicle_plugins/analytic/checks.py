"""Argument checks shared by the analytic solutions."""

from __future__ import annotations

import math

from pellicle.errors import ConfigError


def positive(**values: float) -> None:
    """Raise unless every named value is finite and positive."""
    for name, value in values.items():
        if not (math.isfinite(value) and value > 0):
            raise ConfigError(f"must be finite and positive, got {value!r}", name)


def not_negative(**values: float) -> None:
    """Raise unless every named value is finite and at least zero."""
    for name, value in values.items():
        if not (math.isfinite(value) and value >= 0):
            raise ConfigError(f"must be finite and not negative, got {value!r}", name)


def exactly_one(**values: float | None) -> str:
    """Return the name of the only value given, and raise unless there is one."""
    given = [name for name, value in values.items() if value is not None]
    if len(given) != 1:
        raise ConfigError(f"give exactly one of {', '.join(values)}; got {given or 'none'}")
    return given[0]
