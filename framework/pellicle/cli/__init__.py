"""The command line, one file for each command; it only parses and prints.

What a command of a plugin may use is listed here. Heavy imports are inside the commands, so that
``pellicle --help`` answers at once.
"""

from .plot import Format as Format
from .printing import BAD_INPUT as BAD_INPUT
from .printing import INTERRUPTED as INTERRUPTED
from .printing import NOT_CONVERGED as NOT_CONVERGED
from .printing import InPart as InPart
from .printing import echo as echo
from .printing import print_json as print_json
from .printing import print_table as print_table
