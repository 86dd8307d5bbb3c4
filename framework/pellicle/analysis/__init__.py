"""Analysis of contact: functions of the fields of one load step and of their grid, or of a path.

Fields are arrays of the grid's shape (nx, ny), such as ``result.dataset["contact"][-1]``; the grid
is ``result.grid``. On a free boundary there is no contact beyond the domain; on a periodic one
opposite edges are neighbours.
"""

from .distribution import Distribution as Distribution
from .distribution import distribution as distribution
from .extrapolation import Extrapolation as Extrapolation
from .extrapolation import extrapolate as extrapolate
from .oscillation import Oscillation as Oscillation
from .oscillation import oscillations as oscillations
from .path_summary import Leg as Leg
from .path_summary import PathSummary as PathSummary
from .path_summary import legs as legs
from .path_summary import path_summary as path_summary
from .ridge import Ridge as Ridge
from .ridge import ridge as ridge
from .shape import Ellipse as Ellipse
from .shape import Patches as Patches
from .shape import coordination as coordination
from .shape import ellipse as ellipse
from .shape import patches as patches
from .shape import perimeter as perimeter
from .shape import steepest as steepest
from .spectrum import Spectrum as Spectrum
from .spectrum import spectrum as spectrum
