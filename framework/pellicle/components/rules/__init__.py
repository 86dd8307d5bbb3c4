"""The rules of contracts that need no run.

The kit asks them over cases of its own, ``pellicle plugins --check`` over the examples of a
component, and a run, before it starts, of components that pellicle does not ship.
"""

from . import kernels
from .rule import Case as Case
from .rule import Rule as Rule
from .rule import broken as broken
from .rule import required as required

CHEAP: dict[str, tuple[Rule, ...]] = {"kernel": kernels.RULES}
"""By family; a family without an entry has only rules that need a run."""
