"""The rules of contracts that need no run.

The kit asks them over cases of its own, ``pellicle plugins --check`` over the examples of a
component, and a run, before it starts, of components that pellicle does not ship.
"""

from . import interactions, kernels
from .rule import Case as Case
from .rule import Rule as Rule
from .rule import first_violation as first_violation
from .rule import requirement_of as requirement_of
from .rule import rules_of

CHEAP: dict[str, list[Rule]] = {
    "kernel": rules_of(kernels.__name__),
    "interaction": rules_of(interactions.__name__),
}
"""By family; a family without an entry has only rules that need a run."""
