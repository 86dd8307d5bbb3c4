__all__: list[str]

from .convolution import Float as Float
from .convolution import blocks as blocks
from .convolution import convolve as convolve
from .convolution import row_blocks as row_blocks
from .convolution import shared as shared
from .grid_transfer import highest as highest
from .grid_transfer import prolong as prolong
from .operators import FreeOperator as FreeOperator
from .operators import HasClosedForm as HasClosedForm
from .operators import HasCompliance as HasCompliance
from .operators import HasMeanCompliance as HasMeanCompliance
from .operators import Operator as Operator
from .operators import PeriodicOperator as PeriodicOperator
from .operators import checked_call as checked_call
from .operators import displacement as displacement
from .operators import make_operator as make_operator
from .operators import mean_compliance as mean_compliance
