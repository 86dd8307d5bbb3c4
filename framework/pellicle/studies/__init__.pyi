__all__: list[str]

from .runner import RunTask as RunTask
from .runner import planned as planned
