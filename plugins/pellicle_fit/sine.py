"""A sine of a measured curve: what stands in the rows of a dwell beside its slow course."""

from __future__ import annotations

from typing import NamedTuple


class Sine(NamedTuple):
    """An oscillation of one frequency about a state of the contact, in SI."""

    frequency: float
    """f [Hz]."""
    amplitude: float
    """Of the position of the tip [m]."""
    stiffness: complex
    """K′ + iK″ [N/m]: force over position of the tip, a cantilever's bending subtracted."""
    deviation: float
    """Standard deviation of K′, and of K″ [N/m], from the noise."""
    position: float
    """Mean position of the tip [m]."""
    force: float
    """Mean force [N]."""
    time: float
    """Mean time [s]."""
    first: int
    """First row of the file, from 1."""
    last: int
