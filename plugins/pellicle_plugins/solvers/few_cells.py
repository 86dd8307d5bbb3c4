"""The solution on a contact of few cells under a skin with bending stiffness, by elimination."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array, Cells, Mask
from pellicle.contact import Problem, dilated, with_force

# Cells in contact up to which this takes less time than local relaxation.
MOST_CELLS: Final = 160
# Cells around the contact that may join it; others that penetrate join in the next solve.
_RINGS: Final = 2
# Changes of single cells per cell in contact after which round-off counts as the reason.
_CHANGES: Final = 10


def solved_on_few_cells(
    problem: Problem, column: Array, contact: Mask, trial: Array, gap: Array, margin: float
) -> Array | None:
    """Return the pressure [Pa] that solves the contact problem on some cells; None if it fails.

    A stiff plate rests on a few single cells, each of which decides on the others. So the problem
    is solved on the contact, the cells around it and those that penetrate, by the active set method
    of Lawson & Hanson (1974, chapter 23): the cells under pressure are solved for by Gaussian
    elimination; the first to become tensile leaves, or else the one that penetrates deepest joins.

    ``column`` is the displacement [m] of all cells under 1 Pa on the first one, ``trial`` a
    pressure of either sign [Pa] and ``gap`` its gap [m]; cells below −``margin`` [m] may join.
    """
    joined = np.flatnonzero(contact & (trial > 0))
    if not 0 < joined.size <= MOST_CELLS or 2 * joined.size > trial.size:
        return None
    may_join = (dilated(contact, cells=_RINGS) | (gap < -margin)) & np.isfinite(problem.profile)
    cells = np.flatnonzero(may_join)
    unit = float(column[0, 0])
    system = _System(problem, column / unit, cells, unit)
    pressed = with_force(problem, np.maximum(trial, 0)).ravel()[cells]
    joined = np.flatnonzero(pressed > 0)
    for _ in range(_CHANGES * joined.size):
        if joined.size > 2 * MOST_CELLS:
            break
        goal = system.solve(joined)
        if goal is None:
            return None
        values, depth = goal
        if values.min(initial=1.0) > 0:
            pressed = np.zeros_like(pressed)
            pressed[joined] = values
            displacement = system.matrix(slice(None), joined) @ values
            gap = displacement - system.profile - depth
            gap[joined] = 0
            deepest = int(np.argmin(gap))
            if gap[deepest] >= -margin / unit:
                pressure = np.zeros(trial.shape)
                pressure.ravel()[cells] = pressed
                return pressure
            joined = np.append(joined, deepest)
            continue
        before = pressed[joined]
        tensile = np.flatnonzero(values <= 0)
        lengths = before[tensile] / (before[tensile] - values[tensile])
        length = float(lengths.min())
        pressed[joined] = before + length * (values - before)
        leaving = tensile[lengths <= length]
        pressed[joined[leaving]] = 0
        joined = np.delete(joined, leaving)
    return None


class _System:
    """The linear systems of the pressure on some of the cells, in units of a displacement."""

    def __init__(self, problem: Problem, column: Array, cells: Cells, unit: float) -> None:
        self._column = column
        self._i, self._j = np.divmod(cells, column.shape[1])
        self.profile = problem.profile.ravel()[cells] / unit
        self._depth = problem.value / unit
        self._total = None
        if problem.prescribed == "force":
            self._total = problem.value / problem.grid.cell_area

    def matrix(self, rows: NDArray[np.int64] | slice, columns: NDArray[np.int64]) -> Array:
        """Return the displacement of some cells by the pressure of others."""
        i = np.abs(self._i[rows][:, None] - self._i[columns])
        j = np.abs(self._j[rows][:, None] - self._j[columns])
        matrix: Array = self._column[i, j]
        return matrix

    def solve(self, joined: NDArray[np.int64]) -> tuple[Array, float] | None:
        """Return the pressure that closes the gap on cells, and the depth; None if singular."""
        number = joined.size
        matrix = self.matrix(joined, joined)
        right = self.profile[joined]
        if self._total is None:
            right = right + self._depth
        else:
            matrix = np.pad(matrix, (0, 1), constant_values=1.0)
            matrix[:number, number] = -1
            matrix[number, number] = 0
            right = np.append(right, self._total)
        try:
            solution = np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(solution).all():
            return None
        depth = self._depth if self._total is None else float(solution[number])
        return solution[:number], depth
