__all__: list[str]

from .derived import header as header
from .result import Result as Result
from .result import load as load
from .runs import StoredRuns as StoredRuns
from .storage import read as read
from .storage import table as table
from .storage import write as write
