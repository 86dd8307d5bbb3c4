"""What the tests of bad input share: the command line's answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """What the command line did."""

    exit_code: int
    stdout: str
    message: str
    """All of stderr."""


Cli = Callable[..., Outcome]


def says(message: str, *words: str) -> None:
    """Check that a message holds all words and none of pydantic's."""
    for word in words:
        assert word in message, f"{word!r} is not in: {message}"
    assert "Input should" not in message
    assert "validation" not in message
