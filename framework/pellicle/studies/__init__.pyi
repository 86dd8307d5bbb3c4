__all__: list[str]

from .runner import RunTask as RunTask
from .runner import from_toml as from_toml
from .runner import plan_runs as plan_runs
from .runner import warn_of_scale as warn_of_scale
