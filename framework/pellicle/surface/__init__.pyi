__all__: list[str]

from .convolution import convolve as convolve
from .grid_transfer import highest as highest
from .grid_transfer import prolong as prolong
from .kernel_calls import HasClosedForm as HasClosedForm
from .kernel_calls import HasCompliance as HasCompliance
from .kernel_calls import HasMeanCompliance as HasMeanCompliance
from .kernel_calls import checked_call as checked_call
from .kernel_calls import mean_compliance as mean_compliance
from .operators import Float as Float
from .operators import FreeOperator as FreeOperator
from .operators import Operator as Operator
from .operators import PeriodicOperator as PeriodicOperator
from .operators import displacement as displacement
from .operators import make_operator as make_operator
from .sharing import blocks as blocks
from .sharing import row_blocks as row_blocks
from .sharing import shared as shared
