"""What the tests of bad input share: the start file, and the command line's answer to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

START = """
title = "bad input"
[grid]
points = 16
size = "0.4472 mm"
boundary = "free"
[kernel]
type = "tensed_membrane"
reduced_modulus = "10 kPa"
tension = "1 N/m"
[indenter]
type = "paraboloid"
radius = "1 mm"
[loading]
depth = ["10 um", "20 um"]
[solver]
type = "conjugate_gradient"
tolerance = 1e-6
[[corrections]]
type = "yastrebov"
[[outputs]]
type = "hdf5"
"""


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
