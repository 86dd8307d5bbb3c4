__all__: list[str]

from .derived import as_array as as_array
from .derived import header as header
from .path import has_interaction as has_interaction
from .path import has_path as has_path
from .path import has_times as has_times
from .path import label_of_step as label_of_step
from .result import Result as Result
from .result import load as load
from .runs import StoredRuns as StoredRuns
from .storage import read as read
from .storage import table as table
from .storage import write as write
from .wording import column_of as column_of
from .wording import is_periodic as is_periodic
