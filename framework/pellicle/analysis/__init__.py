"""Analysis of contact: functions of the fields of one load step and of their grid, or of a path.

Fields are arrays of the grid's shape (nx, ny), such as ``result.dataset["contact"][-1]``; the grid
is ``result.grid``. On a free boundary there is no contact beyond the domain; on a periodic one
opposite edges are neighbours.
"""

from __future__ import annotations

from .adhesive_curve import AdhesiveContact, AdhesiveCurve, adhesive_curve
from .distribution import Distribution, distribution
from .ellipse import Ellipse, ellipse
from .extrapolation import Extrapolation, extrapolate
from .oscillation import Oscillation, oscillations
from .patches import Patches, coordination, patches
from .path_summary import Leg, PathSummary, legs, path_summary
from .perimeter import perimeter
from .spectrum import Spectrum, spectrum

__all__ = [
    "AdhesiveContact",
    "AdhesiveCurve",
    "Distribution",
    "Ellipse",
    "Extrapolation",
    "Leg",
    "Oscillation",
    "Patches",
    "PathSummary",
    "Spectrum",
    "adhesive_curve",
    "coordination",
    "distribution",
    "ellipse",
    "extrapolate",
    "legs",
    "oscillations",
    "patches",
    "path_summary",
    "perimeter",
    "spectrum",
]
