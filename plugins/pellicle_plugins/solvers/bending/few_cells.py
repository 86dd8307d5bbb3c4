"""The solution on a contact of few cells under a skin with bending stiffness, as least squares."""

from __future__ import annotations

from typing import Final

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.contact import Problem, dilate, with_force

# Cells in contact up to which this takes less time than local relaxation, and cells that may join.
MOST_CELLS: Final = 160
_MOST_CANDIDATES: Final = 400
# Cells around the contact that may join it.
_RINGS: Final = 2
# Compliance that a given force adds to a cell, over its own, and steps until the force is kept:
# each leaves less than 1e-3 of the error. Of 1e4 round-off would remain.
_ADDED: Final = 1e3
_STEPS: Final = 5


def solved_on_few_cells(
    problem: Problem, column: Array, contact: Mask, trial: Array, gap: Array, margin: float
) -> Array | None:
    """Return the pressure [Pa] that solves the contact problem on some cells; None if it fails.

    A stiff plate rests on a few single cells, each of which decides on the others. So the problem
    is solved on the contact, the cells around it and those that penetrate most; others join in the
    next solve. With A = L Lᵀ its energy ½⟨p, A p⟩ − ⟨f + δ, p⟩ is ½|Lᵀ p − L⁻¹(f + δ)|² but for a
    constant, whose least value for p ≥ 0 is that of Lawson & Hanson (1974, chapter 23). A given
    force is kept by the method of multipliers (Hestenes 1969).

    ``column`` is the displacement [m] of all cells under 1 Pa on the first one, ``trial`` a
    pressure of either sign [Pa] and ``gap`` its gap [m]; cells below −``margin`` [m] may join.
    """
    from scipy.linalg import LinAlgError, cholesky, solve_triangular
    from scipy.optimize import nnls

    pressed = np.count_nonzero(contact & (trial > 0))
    if not pressed or 2 * pressed > trial.size:
        return None
    may_join = (dilate(contact, cells=_RINGS) | (gap < -margin)) & np.isfinite(problem.profile)
    cells = np.flatnonzero(may_join)
    if cells.size > _MOST_CANDIDATES:
        nearest = np.where(contact, -np.inf, gap).ravel()[cells]
        cells = np.sort(cells[np.argpartition(nearest, _MOST_CANDIDATES)[:_MOST_CANDIDATES]])
    unit, (i, j) = float(column[0, 0]), np.divmod(cells, trial.shape[1])
    apart = [index[:, None] - index for index in (i, j)]
    # Without mirrors they count from the first to the second cell, on the period.
    mirrored = problem.operator.has_mirrors
    rows, columns = (
        np.abs(d) if mirrored else d % n for d, n in zip(apart, trial.shape, strict=True)
    )
    matrix = column[rows, columns] / unit
    height, depth = problem.profile.ravel()[cells] / unit, problem.value / unit
    added, steps = 0.0, 1
    if problem.prescribed == "force":
        total, added, steps = problem.value / problem.grid.cell_area, _ADDED, _STEPS
        depth = added * total
    pressure = np.zeros(trial.shape)
    try:
        root = cholesky(matrix + added, lower=True)
        for _ in range(steps):
            least, _ = nnls(root.T, solve_triangular(root, height + depth, lower=True))
            if added:
                depth += added * (total - float(least.sum()))
    except (LinAlgError, RuntimeError):
        return None
    pressure.ravel()[cells] = least
    return with_force(problem, pressure) if least.any() else None
