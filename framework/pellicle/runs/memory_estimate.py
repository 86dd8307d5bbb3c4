"""The peak memory that a run needs, estimated before it starts."""

from __future__ import annotations

from pellicle.config.gradient import HEIGHTS
from pellicle.config.run import Run

from .relaxation import history_arrays

# Peak memory in arrays of the grid's shape, eight bytes per cell, measured on Linux with glibc.
# The indenter, and the operator with its transforms, which are padded on a free boundary.
_OPERATOR = {"free": 9.0, "periodic": 4.75}
# The same on a line of cells along x, whose transforms are twice as long and need tables.
_LINE = 14.0
# An interaction adds eight iterates of three fields, from which the next one is extrapolated, and
# the fields of two iterations.
_STICKS = 39.0
# A load step in the result: pressure, displacement and gap, and a byte per cell for the contact.
_STEP = 3 + 1 / 8
# The same step in the compressed file that is assembled in memory. Blocks that the solver has freed
# and that malloc keeps are too small for it.
_SERIALISED = 2.6
# Arrays above this size [bytes] are given back when they are freed; of smaller ones malloc keeps
# up to three.
_GIVEN_BACK = 2**25
_HEAP = 3
# Buffers and Python's own objects [bytes].
_FIXED = 1e6


def memory_of(run: Run) -> float:
    """Return the estimated peak memory of a run [bytes], without that of the libraries.

    The peak occurs in the last solve, when earlier steps and their file are in memory too. The size
    of the contact is unknown, so full contact is assumed, which takes up to a third more memory
    than a small contact.
    """
    grid, solver = run.grid, run.solver
    cells = grid.points[0] * grid.points[1]
    operator = _LINE if grid.points[1] == 1 else _OPERATOR[grid.boundary]
    iterating = 0.0 if run.load else solver.arrays(grid) + (_STICKS if run.interaction else 0.0)
    history = history_arrays(run)
    records = (_STEP + _SERIALISED) * (run.steps - 1)
    if run.load and run.load.varying_field:
        # The tractions of all steps but the first, which has the place of an indenter.
        records += run.steps - 1
    for path in run.gradient or ():
        # Two fields of each step, or the derivative of the operator.
        records += 4.0 * run.steps if path == HEIGHTS else operator
    heap = _HEAP if 8 * cells < _GIVEN_BACK else 0
    return _FIXED + 8 * cells * (operator + iterating + history + records + heap)
