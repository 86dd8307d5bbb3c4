"""Argument checks shared by the analytic solutions."""

from __future__ import annotations

import math

from pellicle.errors import ConfigError


def positive(**values: float) -> None:
    """Raise ConfigError unless every named value is finite and positive."""
    for name, value in values.items():
        if not 0 < value < math.inf:
            raise ConfigError(f"must be finite and positive, got {value!r}", name)


def not_negative(**values: float) -> None:
    """Raise ConfigError unless every named value is finite and at least zero."""
    for name, value in values.items():
        if not 0 <= value < math.inf:
            raise ConfigError(f"must be finite and not negative, got {value!r}", name)


def single(**values: float | None) -> tuple[str, float]:
    """Return name and value of the one value that is not None."""
    present = {name: value for name, value in values.items() if value is not None}
    if len(present) != 1:
        raise ConfigError(f"give exactly one of {', '.join(values)}; got {list(present) or 'none'}")
    not_negative(**present)
    return present.popitem()
