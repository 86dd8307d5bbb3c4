"""Calls of components: one function for each method that the framework calls.

Arguments of components are read-only. Returned values are checked against the contract, at a cost
far below that of the call. `pellicle.surface` calls kernels in the same way.
"""

from .correction import corrected_area
from .indenter import profile_of
from .kernel import branches_of, instantaneous
from .output import files_of, require_files
from .prescription import check_value, report_of, target_of
from .solver import check_solver, response_of, solution_of

__all__ = [
    "branches_of",
    "check_solver",
    "check_value",
    "corrected_area",
    "files_of",
    "instantaneous",
    "profile_of",
    "report_of",
    "require_files",
    "response_of",
    "solution_of",
    "target_of",
]
