__all__: list[str]

from .attraction import Attraction as Attraction
from .caveats import Caveat as Caveat
from .caveats import Status as Status
from .equilibrium import AdhesiveEquilibrium as AdhesiveEquilibrium
from .equilibrium import Equilibrium as Equilibrium
from .equilibrium import Stiffness as Stiffness
from .equilibrium import measure as measure
from .equilibrium import measure_stiffness as measure_stiffness
from .equilibrium import round_off as round_off
from .initial_guess import dot as dot
from .initial_guess import first_guess as first_guess
from .initial_guess import with_force as with_force
from .law import GapLaw as GapLaw
from .law import Law as Law
from .masks import dilate as dilate
from .problem import Adhesive as Adhesive
from .problem import Depth as Depth
from .problem import Force as Force
from .problem import Problem as Problem
from .problem import Traction as Traction
from .problem import Unilateral as Unilateral
from .problem import height_scale as height_scale
from .solution import Progress as Progress
from .solution import Solution as Solution
from .solution import State as State
from .solution import Stop as Stop
