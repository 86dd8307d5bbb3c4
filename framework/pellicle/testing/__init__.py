"""The contracts as tests: one call checks a component against the contract of its family.

Each function takes a component, made as a user would make it, and raises an AssertionError that
says which rule is broken and how. The same calls test pellicle's own components. Nothing here needs
a test framework; under pytest a plain function is enough::

    def test_contract():
        check_kernel(Graded(reduced_modulus="10 kPa", length="0.1 mm", exponent=0.5))

The rules of a family are the other functions of its module; ``docs/families.md`` lists them all.
A family that a plugin brings has its check in the package of its base class, made of `check`.
"""

from .component import check as check
from .component import keep as keep
from .component import rules_of as rules_of
from .corrections import check_correction as check_correction
from .executors import check_executor as check_executor
from .indenters import check_indenter as check_indenter
from .interactions import check_interaction as check_interaction
from .kernels import check_kernel as check_kernel
from .loads import check_load as check_load
from .outputs import check_output as check_output
from .prescriptions import check_prescription as check_prescription
from .solvers import check_solver as check_solver
