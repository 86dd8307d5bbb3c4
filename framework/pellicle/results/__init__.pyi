__all__: list[str]

from .derived import DERIVED as DERIVED
from .derived import as_array as as_array
from .derived import configuration_of as configuration_of
from .derived import derive as derive
from .derived import header as header
from .derived import names as names
from .path import FEW_CELLS as FEW_CELLS
from .path import has_interaction as has_interaction
from .path import has_path as has_path
from .path import has_times as has_times
from .path import label_of_step as label_of_step
from .result import Result as Result
from .result import load as load
from .runs import StoredRuns as StoredRuns
from .runs import axes_of as axes_of
from .runs import progress_of as progress_of
from .runs import runs_of as runs_of
from .storage import read as read
from .storage import table as table
from .storage import write as write
from .wording import column_of as column_of
from .wording import is_log_spaced as is_log_spaced
from .wording import is_ordered as is_ordered
from .wording import is_periodic as is_periodic
from .wording import is_seed as is_seed
