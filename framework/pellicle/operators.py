"""Operators, for plugins: the contents of `pellicle.numerics.operators`."""

from pellicle.arrays import Array as Array
from pellicle.numerics.operators import Float as Float
from pellicle.numerics.operators import FreeOperator as FreeOperator
from pellicle.numerics.operators import HasClosedForm as HasClosedForm
from pellicle.numerics.operators import HasCompliance as HasCompliance
from pellicle.numerics.operators import HasMeanCompliance as HasMeanCompliance
from pellicle.numerics.operators import Operator as Operator
from pellicle.numerics.operators import PeriodicOperator as PeriodicOperator
from pellicle.numerics.operators import checked_call as checked_call
from pellicle.numerics.operators import displacement as displacement
from pellicle.numerics.operators import make_operator as make_operator
from pellicle.numerics.operators import mean_compliance as mean_compliance
