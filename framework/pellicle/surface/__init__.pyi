__all__: list[str]

from .convolution import Float as Float
from .convolution import blocks as blocks
from .convolution import convolve as convolve
from .convolution import in_threads as in_threads
from .convolution import row_blocks as row_blocks
from .from_kernel import HasClosedForm as HasClosedForm
from .from_kernel import HasMeanCompliance as HasMeanCompliance
from .from_kernel import HasSymbol as HasSymbol
from .from_kernel import checked_call as checked_call
from .from_kernel import displacement as displacement
from .from_kernel import mean_compliance as mean_compliance
from .from_kernel import operator_of as operator_of
from .grid_transfer import highest as highest
from .grid_transfer import prolong as prolong
from .operators import Operator as Operator
from .operators import along_axes as along_axes
