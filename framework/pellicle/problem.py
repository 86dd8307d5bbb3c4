"""The contact problem and its solutions, for plugins; see `pellicle.numerics`."""

from pellicle.numerics.contact_stiffness import Stiffness as Stiffness
from pellicle.numerics.contact_stiffness import measure_stiffness as measure_stiffness
from pellicle.numerics.equilibrium import Equilibrium as Equilibrium
from pellicle.numerics.equilibrium import measure as measure
from pellicle.numerics.equilibrium import round_off as round_off
from pellicle.numerics.problem import Depth as Depth
from pellicle.numerics.problem import Force as Force
from pellicle.numerics.problem import Problem as Problem
from pellicle.numerics.problem import height_scale as height_scale
