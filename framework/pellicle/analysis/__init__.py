"""Analysis of contact: functions of the fields of one load step and of their grid.

Fields are arrays of the grid's shape (nx, ny), such as ``result.dataset["contact"][-1]``; the grid
is ``result.grid``. On a free boundary there is no contact beyond the domain; on a periodic one
opposite edges are neighbours.
"""

from __future__ import annotations

from .distribution import Distribution, distribution
from .ellipse import Ellipse, ellipse
from .extrapolation import Extrapolation, extrapolate
from .patches import Patches, coordination, patches
from .perimeter import perimeter
from .spectrum import Spectrum, spectrum

__all__ = [
    "Distribution",
    "Ellipse",
    "Extrapolation",
    "Patches",
    "Spectrum",
    "coordination",
    "distribution",
    "ellipse",
    "extrapolate",
    "patches",
    "perimeter",
    "spectrum",
]
