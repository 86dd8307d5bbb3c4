"""Operators and what they need of a kernel, for plugins; see `pellicle.numerics`."""

from pellicle.arrays import Array as Array
from pellicle.numerics.kernel_calls import HasClosedForm as HasClosedForm
from pellicle.numerics.kernel_calls import HasCompliance as HasCompliance
from pellicle.numerics.kernel_calls import HasMeanCompliance as HasMeanCompliance
from pellicle.numerics.kernel_calls import checked_call as checked_call
from pellicle.numerics.kernel_calls import mean_compliance as mean_compliance
from pellicle.numerics.operators import Float as Float
from pellicle.numerics.operators import FreeOperator as FreeOperator
from pellicle.numerics.operators import Operator as Operator
from pellicle.numerics.operators import PeriodicOperator as PeriodicOperator
from pellicle.numerics.operators import displacement as displacement
from pellicle.numerics.operators import make_operator as make_operator
