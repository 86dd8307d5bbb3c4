"""The contact problem, for plugins: the contents of `pellicle.numerics.problem`."""

from pellicle.numerics.problem import Depth as Depth
from pellicle.numerics.problem import Equilibrium as Equilibrium
from pellicle.numerics.problem import Force as Force
from pellicle.numerics.problem import Problem as Problem
from pellicle.numerics.problem import Stiffness as Stiffness
from pellicle.numerics.problem import height_scale as height_scale
from pellicle.numerics.problem import measure as measure
from pellicle.numerics.problem import measure_stiffness as measure_stiffness
from pellicle.numerics.problem import round_off as round_off
