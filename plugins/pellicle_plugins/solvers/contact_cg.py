"""The linear problem on a fixed contact: the pressure that closes the gap."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.numerics.problem import Problem

from .preconditioner import Cells, OnContact
from .products import dot

# A solve ends when no more cells are in doubt, for each that is certain to be wrong.
_DOUBTS: Final = 0.3
# One iteration does not tell what the next may change.
_LEAST: Final = 2
# No solve shrinks the error by more than this: the operator is applied in single precision, which
# has no more digits, and the next solve starts from a displacement in double.
_SINGLE: Final = 1e-5
# Iterations without a smaller error after which round-off is taken to be all that is left of it.
_PATIENCE: Final = 50


class Inner(NamedTuple):
    """What an inner solve found."""

    pressure: Array
    """Of either sign [Pa]; 0 off the contact."""
    displacement: Array
    """To the digits of single precision in what has changed [m]."""
    error: float
    """max |gap| on the contact [m]."""
    wrong: Cells
    """Flat index, ascending, of each cell of the contact that pulls or other that penetrates."""


def inner_solve(
    problem: Problem,
    preconditioner: OnContact,
    pressure: Array,
    displacement: Array,
    goal: float,
    *,
    doubt: float,
    reduction: float = 0.0,
) -> Inner:
    """Return the pressure on a contact whose gap is nearly closed, and where the contact is wrong.

    Preconditioned conjugate gradients, with a prescribed force in the space of pressures that keep
    it. They go on until the error is at ``goal`` [m] or has shrunk to the share ``reduction``, or
    until nearly all cells that pull or penetrate are certain to, which is when later iterations
    would have to change them by more than ``doubt`` times what the last one did; never, if that is
    infinite. All vectors are on the cells of the contact, but the displacement, which tells where
    else the surface penetrates.

    The operator is applied in single precision, in less than half of the time: to solve again for
    what is left recovers all digits (iterative refinement; Wilkinson 1963). Under a skin that bends
    it is applied in double: a gap that single precision does not see is a pressure above those
    whose sign is sought.
    """
    cells = preconditioner.cells
    signs = _Signs(problem, cells, doubt)
    if not cells.size:
        nothing = np.zeros(problem.grid.shape)
        return Inner(nothing, nothing, 0.0, signs.all(np.zeros(0), nothing, goal))
    search = _Search(preconditioner, keeps_force=problem.prescribed == "force")
    whole = np.zeros(problem.grid.shape, dtype=np.float64 if preconditioner.bends else np.float32)
    displacement = displacement.copy()
    pressed = pressure.ravel()[cells]
    aloft = displacement.ravel()[cells] - problem.profile.ravel()[cells]
    residual = problem.depth(aloft) - aloft
    del aloft
    uniform = _Uniform.of(problem, cells)
    if uniform:
        level = uniform.level(residual)
        pressed += level
        displacement += level * uniform.displacement
        residual -= level * uniform.inside
    error = search.error(residual)
    goal = max(goal, max(_SINGLE, reduction) * error)
    best, since_best, iteration = np.inf, 0, 0
    wrong = None
    direction = search(residual)
    if uniform:
        direction -= uniform.share(direction)
    descent = dot(residual, direction)
    while descent > 0 and since_best < _PATIENCE:
        mean = float(direction.mean()) if uniform else 0.0
        varying = direction - mean if uniform else direction
        size = float(np.abs(varying).max()) or 1.0
        whole.ravel()[cells] = varying / size
        change = problem.operator(whole)
        if uniform:
            change += (mean / size) * uniform.displacement
        inside = change.ravel()[cells] * size
        curvature = dot(direction, inside)
        if curvature <= 0:
            break
        length = descent / curvature
        change *= length * size
        displacement += change
        inside *= length
        residual -= inside
        direction *= length
        pressed += direction
        error = search.error(residual)
        best, since_best = (error, 0) if error < best else (best, since_best + 1)
        iteration += 1
        if error <= goal:
            break
        if np.isfinite(doubt) and iteration >= _LEAST:
            change -= search.mean(inside)
            wrong = signs.certain(pressed, displacement, goal, direction, change)
            if wrong is not None:
                break
        # On a large contact each of these is as large as the grid.
        del change, inside
        ascent = search(residual)
        if uniform:
            ascent -= uniform.share(ascent)
        before, descent = descent, dot(residual, ascent)
        # The direction was multiplied by its step length.
        direction *= curvature / before * (descent / before)
        direction += ascent
        del ascent
    # The gap is computed next, and the result.
    del residual, direction, whole
    if wrong is None:
        wrong = signs.all(pressed, displacement, max(error, goal))
    pressure = np.zeros(problem.grid.shape)
    pressure.ravel()[cells] = pressed
    return Inner(pressure, displacement, error, np.sort(wrong))


class _Uniform:
    """The uniform pressure on a contact, which hardly moves one that nearly fills its period.

    Where the mean displacement stays 0, u = A·1 on the contact is −A·1 off it: the smaller, the
    fewer cells are off. So weak a direction is solved for exactly, and the search for the others is
    kept conjugate to it (deflation; Nicolaides 1987). From the cells off the contact u has all its
    digits, which single precision would leave in the difference.
    """

    def __init__(self, displacement: Array, cells: Cells) -> None:
        self.displacement = displacement
        """Under 1 Pa on the contact [m]."""
        self.inside = displacement.ravel()[cells]
        """That of each cell of the contact [m]."""
        self._curvature = float(self.inside.sum())

    @classmethod
    def of(cls, problem: Problem, cells: Cells) -> _Uniform | None:
        """Return it for a contact of more than half of all cells at a depth, if there is one."""
        off = problem.profile.size - cells.size
        if problem.prescribed == "force" or problem.operator.fixes_mean or not 0 < off < cells.size:
            return None
        outside = np.ones(problem.grid.shape)
        outside.ravel()[cells] = 0
        uniform = cls(-problem.operator(outside), cells)
        return uniform if uniform._curvature > 0 else None

    def level(self, residual: Array) -> float:
        """Return the uniform pressure [Pa] that closes a gap on the contact in the mean."""
        return float(residual.sum()) / self._curvature

    def share(self, direction: Array) -> float:
        """Return the uniform part by which a direction is not conjugate to a uniform one."""
        return dot(self.inside, direction) / self._curvature


class _Signs:
    """Tells which cells have the wrong sign: in contact those that pull, others that penetrate."""

    def __init__(self, problem: Problem, cells: Cells, doubt: float) -> None:
        self._problem = problem
        self._cells = cells
        self._doubt = doubt
        self._off = np.ones(problem.grid.shape, dtype=bool)
        self._off.ravel()[cells] = False

    def all(self, pressed: Array, displacement: Array, margin: float) -> Cells:
        """Return the flat index of each, from pressures in contact [Pa] and the displacement [m].

        Cells penetrate where they do by more than ``margin`` [m].
        """
        pulls, penetrates, _ = self._wrong(pressed, displacement, margin)
        return np.concatenate([self._cells[pulls], penetrates])

    def certain(
        self, pressed: Array, displacement: Array, margin: float, step: Array, change: Array
    ) -> Cells | None:
        """Return those that later iterations will not change, or None if too many are in doubt.

        ``step`` [Pa] and ``change`` [m] are what the last one changed in pressure and gap.
        """
        pulls, penetrates, gap = self._wrong(pressed, displacement, margin)
        surely = pressed[pulls] < -self._doubt * np.abs(step[pulls])
        deeply = gap < -self._doubt * np.abs(change.ravel()[penetrates])
        certain = np.concatenate([self._cells[pulls[surely]], penetrates[deeply]])
        doubtful = pulls.size + penetrates.size - certain.size
        return certain if certain.size and doubtful <= _DOUBTS * certain.size else None

    def _wrong(
        self, pressed: Array, displacement: Array, margin: float
    ) -> tuple[Cells, Cells, Array]:
        """Return which of the contact pull, the flat index of what penetrates, and its gap."""
        gap = displacement - self._problem.profile
        gap -= self._problem.depth(gap.ravel()[self._cells])
        penetrates = np.flatnonzero((gap < -margin) & self._off)
        return np.flatnonzero(pressed < 0), penetrates, gap.ravel()[penetrates]


class _Search:
    """Search directions on a contact: preconditioned, and free of force if that is prescribed."""

    def __init__(self, preconditioner: OnContact, *, keeps_force: bool) -> None:
        self._preconditioner = preconditioner
        self._keeps_force = keeps_force
        if keeps_force:
            self._lift = preconditioner(np.ones(preconditioner.cells.size))
            self._lift /= float(self._lift.sum())

    def __call__(self, residual: Array) -> Array:
        if not self._keeps_force:
            return self._preconditioner(residual)
        # The mean has no effect but on round-off: single precision must not spend its digits on it.
        # In the preconditioner's precision, it takes half of the memory there.
        closing = (residual - self.mean(residual)).astype(np.float32)
        direction = self._preconditioner(closing)
        direction -= self._lift * float(direction.sum())
        return direction

    def mean(self, gap: Array) -> float:
        """Return by how much the depth makes up for a gap on the contact; 0 if it is given."""
        return float(gap.mean()) if self._keeps_force else 0.0

    def error(self, residual: Array) -> float:
        """Return max |gap| on the contact."""
        mean = self.mean(residual)
        return max(float(residual.max()) - mean, mean - float(residual.min()))
