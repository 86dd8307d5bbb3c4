"""The contracts as tests: one call checks a component against the contract of its family.

Each function takes a component, made as a user would make it, and raises an AssertionError that
says which rule is broken and how. The same calls test pellicle's own components. Nothing here needs
a test framework; under pytest a plain function is enough::

    def test_contract():
        check_kernel(Graded(reduced_modulus="10 kPa", length="0.1 mm", exponent=0.5))
"""

from .corrections import check_correction
from .executors import check_executor
from .indenters import check_indenter
from .interactions import check_interaction
from .kernels import check_kernel
from .outputs import check_output
from .prescriptions import check_prescription
from .solvers import check_solver

__all__ = [
    "check_correction",
    "check_executor",
    "check_indenter",
    "check_interaction",
    "check_kernel",
    "check_output",
    "check_prescription",
    "check_solver",
]
