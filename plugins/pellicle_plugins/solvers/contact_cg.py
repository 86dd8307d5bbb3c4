"""Conjugate gradients for the pressure that closes the gap on a fixed contact."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array, Cells
from pellicle.contact import Problem, dot
from pellicle.surface import blocks, in_threads, row_blocks

from .preconditioner import OnContact

# Sign-certainty factors: the sign of a cell counts as final if its value exceeds this multiple of
# its last change. The strict one applies after an outer iteration without progress.
SIGN_CERTAINTY: Final = 1.0
STRICT_SIGN_CERTAINTY: Final = 30.0
# A solve ends when the misclassified cells of uncertain sign are at most this share of the others.
_UNCERTAIN: Final = 0.3
# After a single iteration the change of the next one cannot be estimated.
_MIN_ITERATIONS: Final = 2
# Least ratio of errors after and before a solve: the operator is applied in single precision, which
# has no more digits. The next solve starts from a displacement in double precision.
_MAX_REDUCTION: Final = 1e-5
# Iterations without a smaller error after which the remaining error counts as round-off.
_STAGNATION: Final = 50


class InnerSolution(NamedTuple):
    """The result of an inner solve."""

    pressure: Array
    """Pressure of either sign [Pa]; 0 off the contact."""
    displacement: Array
    """Displacement [m]; its change is accurate to single precision."""
    error: float
    """max |gap| on the contact [m]."""
    misclassified: Cells
    """Flat indices, ascending: cells in contact with tensile pressure, others that penetrate."""


def inner_solve(
    problem: Problem,
    preconditioner: OnContact,
    pressure: Array,
    displacement: Array,
    goal: float,
    *,
    certainty: float,
    reduction: float = 0.0,
    u_minus_f: Array | None = None,
) -> InnerSolution:
    """Return the pressure that nearly closes the gap on a contact, and the misclassified cells.

    These are preconditioned conjugate gradients; under force control they keep the force. They end
    when the error is at most ``goal`` [m] or has fallen to the share ``reduction``, or when the
    signs of nearly all misclassified cells are certain: a sign is certain if the value exceeds
    ``certainty`` times its last change. With an infinite ``certainty`` the signs do not matter. All
    vectors are on the cells of the contact except the displacement, which shows where else the
    surface penetrates.

    The operator is applied in single precision, in less than half of the time; solving again for
    the remaining gap recovers all digits (iterative refinement; Wilkinson 1963). Under a skin with
    bending stiffness it is applied in double precision, because a gap that single precision does
    not resolve corresponds to pressures larger than those whose signs are to be determined.

    ``pressure``, which is 0 off the contact, and ``displacement`` are overwritten by the solution,
    and so is ``u_minus_f``, the displacement minus the profile on the contact [m], if it is known.
    """
    cells = preconditioner.cells
    if not cells.size:
        gap, _ = problem.gap(displacement, preconditioner.contact)
        return InnerSolution(pressure, displacement, 0.0, np.flatnonzero(gap < -goal))
    iterate = _Iterate(problem, preconditioner, pressure, displacement, u_minus_f)
    goal = max(goal, max(_MAX_REDUCTION, reduction) * iterate.error)
    misclassified = _conjugated(iterate, goal, certainty)
    if misclassified is None:
        misclassified, _ = iterate.misclassified(max(iterate.error, goal))
    # A start or a guess may be in Fortran order, for which ravel() returns a copy.
    np.put(pressure, cells, iterate.pressure)
    return InnerSolution(pressure, displacement, iterate.error, np.sort(misclassified))


def _conjugated(iterate: _Iterate, goal: float, certainty: float) -> Cells | None:
    """Go along conjugate directions to the goal, or until the misclassified cells are certain.

    Return these; None at the goal, or where the error falls no more.
    """
    least, stagnant, iteration = np.inf, 0, 0
    direction = iterate.directions(iterate.residual)
    descent = dot(iterate.residual, direction)
    while descent > 0 and stagnant < _STAGNATION:
        curvature = iterate.advance(direction, descent)
        if curvature <= 0:
            break
        error = iterate.error
        least, stagnant = (error, 0) if error < least else (least, stagnant + 1)
        iteration += 1
        if error <= goal:
            break
        if np.isfinite(certainty) and iteration >= _MIN_ITERATIONS:
            certain, uncertain = iterate.misclassified(goal, certainty, direction)
            if certain.size and uncertain <= _UNCERTAIN * certain.size:
                return certain
        else:
            iterate.update_displacement()
        ascent = iterate.directions(iterate.residual)
        before, descent = descent, dot(iterate.residual, ascent)
        # The direction was multiplied by its step length.
        direction *= curvature / before * (descent / before)
        direction += ascent
        # On a large contact it is as large as the grid.
        del ascent
    return None


class _Iterate:
    """Pressure, displacement and remaining gap of conjugate gradients on a contact."""

    def __init__(
        self,
        problem: Problem,
        preconditioner: OnContact,
        pressure: Array,
        displacement: Array,
        u_minus_f: Array | None,
    ) -> None:
        self._problem, self._preconditioner = problem, preconditioner
        cells = self._cells = preconditioner.cells
        uniform = self._uniform = _Uniform.of(problem, cells)
        self.directions = _Directions(problem, preconditioner, uniform)
        bends = preconditioner.preconditioner.bends
        self._field = np.zeros(problem.grid.shape, dtype=np.float64 if bends else np.float32)
        self.pressure = pressure.ravel()[cells]
        """On the cells of the contact [Pa]."""
        self._displacement = displacement
        if u_minus_f is None:
            u_minus_f = displacement.ravel()[cells] - problem.profile.ravel()[cells]
        self._depth = problem.depth(u_minus_f)
        self.residual = np.subtract(self._depth, u_minus_f, out=u_minus_f)
        """Minus the gap on the contact [m], but for its mean under force control."""
        self._change: NDArray[Any] | None = None
        """Change of the displacement by the last iteration, over `_factor` [m]; None once added."""
        self._factor, self._depth_change = 1.0, 0.0
        if uniform:
            # The uniform pressure that closes the mean gap on the contact.
            level = float(self.residual.sum()) / uniform.curvature
            self.pressure += level
            displacement += level * uniform.displacement
            self.residual -= level * uniform.inside

    @property
    def error(self) -> float:
        """The largest gap on the contact by magnitude [m]."""
        mean = self.directions.mean(self.residual)
        return max(float(self.residual.max()) - mean, mean - float(self.residual.min()))

    def advance(self, direction: Array, descent: float) -> float:
        """Go along a direction to the least energy, and return ⟨direction, A direction⟩.

        The direction is multiplied by the step length. Nothing changes if the result is not > 0.
        """
        uniform = self._uniform
        mean = float(direction.mean()) if uniform else 0.0
        varying = direction - mean if uniform else direction
        size = max(float(varying.max()), -float(varying.min())) or 1.0
        _scatter(varying, size, self._cells, self._field)
        del varying
        change = self._problem.operator(self._field, out=self._field)
        if uniform:
            change += (mean / size) * uniform.displacement
        inside = _gathered(change, self._cells)
        inside *= size
        curvature = dot(direction, inside)
        if curvature <= 0:
            return curvature
        length = descent / curvature
        inside *= length
        self.residual -= inside
        direction *= length
        self.pressure += direction
        self._depth_change = self.directions.mean(inside)
        self._change, self._factor = change, length * size
        return curvature

    def update_displacement(self) -> None:
        """Add the change of the last iteration to the displacement."""
        in_threads(self._add_change, row_blocks(self._displacement.shape))
        self._change = None

    def _add_change(self, rows: slice) -> None:
        if self._change is not None:
            change = self._change[rows]
            change *= self._factor
            self._displacement[rows] += change

    def misclassified(
        self, margin: float, certainty: float = 0.0, step: Array | None = None
    ) -> tuple[Cells, int]:
        """Return flat indices of misclassified cells of certain sign, and how many are uncertain.

        A cell in contact is misclassified if its pressure is tensile, any other cell if its gap is
        below −``margin`` [m]. ``certainty`` is the sign-certainty factor, and ``step`` the last
        change of the pressure [Pa]; without it all signs are certain. The displacement is up to
        date afterwards.
        """
        profile, displacement = self._problem.profile, self._displacement
        contact, pressure = self._preconditioner.contact, self.pressure
        depth = self._depth - self.directions.mean(self.residual)
        below = np.empty(contact.shape, dtype=bool)

        def mark(rows: slice) -> None:
            self._add_change(rows)
            np.less(displacement[rows] - profile[rows], depth - margin, out=below[rows])
            np.greater(below[rows], contact[rows], out=below[rows])

        in_threads(mark, row_blocks(contact.shape))
        change, self._change = self._change, None
        tensile, penetrating = np.flatnonzero(pressure < 0), np.flatnonzero(below)
        number = tensile.size + penetrating.size
        if change is not None and step is not None:
            tensile = tensile[pressure[tensile] < -certainty * np.abs(step[tensile])]
            gap_change = np.abs(change.ravel()[penetrating] - self._depth_change)
            gap = displacement.ravel()[penetrating] - profile.ravel()[penetrating] - depth
            penetrating = penetrating[gap < -certainty * gap_change]
        certain = np.concatenate([self._cells[tensile], penetrating])
        return certain, number - certain.size


def _scatter(values: Array, unit: float, cells: Cells, field: NDArray[Any]) -> None:
    """Write values over their unit to ``cells`` of a field, and 0 to the others."""
    flat = field.ravel()

    def fill(rows: slice) -> None:
        field[rows] = 0

    def write(block: slice) -> None:
        flat[cells[block]] = values[block] / unit

    in_threads(fill, row_blocks(field.shape))
    in_threads(write, blocks(cells.size))


def _gathered(field: NDArray[Any], cells: Cells) -> NDArray[Any]:
    """Return the values of a field on ``cells``."""
    flat, values = field.ravel(), np.empty(cells.size, field.dtype)

    def read(block: slice) -> None:
        values[block] = flat[cells[block]]

    in_threads(read, blocks(cells.size))
    return values


class _Uniform:
    """The uniform pressure on a contact that nearly fills its period.

    If the mean displacement is 0, a uniform pressure on the contact has the displacement u = A·1_c
    = −A·1_o, with 1_c and 1_o being 1 on and off the contact. It vanishes with the number of cells
    off the contact. So this direction is solved for exactly, and all others are kept conjugate to
    it (deflation; Nicolaides 1987). Computed from the cells off the contact, u has all its digits;
    computed from those on it, single precision would lose them by cancellation.
    """

    def __init__(self, displacement: Array, cells: Cells) -> None:
        self.displacement = displacement
        """Displacement under 1 Pa on the contact [m]."""
        self.inside = displacement.ravel()[cells]
        """The same on the cells of the contact [m]."""
        self.curvature = float(self.inside.sum())

    @classmethod
    def of(cls, problem: Problem, cells: Cells) -> _Uniform | None:
        """Return it under depth control on a contact of more than half of the cells, else None."""
        off = problem.profile.size - cells.size
        if (
            problem.prescribed == "force"
            or problem.operator.has_mean_compliance
            or not 0 < off < cells.size
        ):
            return None
        outside = np.ones(problem.grid.shape)
        outside.ravel()[cells] = 0
        uniform = cls(-problem.operator(outside), cells)
        return uniform if uniform.curvature > 0 else None


class _Directions:
    """Preconditioned search directions on a contact, without net force under force control.

    The spring of an indenter adds a uniform compliance, which enters the preconditioner by the
    formula of Sherman & Morrison (1950). Under force control the preconditioner M becomes P M Pᵀ
    with P = 1 − w 1ᵀ. It is symmetric for every w of sum 1; with w ∝ M 1 it is the limit of a soft
    spring.
    """

    def __init__(
        self, problem: Problem, preconditioner: OnContact, uniform: _Uniform | None
    ) -> None:
        self._preconditioner = preconditioner
        self._uniform = uniform
        self._keeps_force = problem.prescribed == "force"
        spring = problem.operator.deflection(1.0) * preconditioner.preconditioner.stiffest
        self._lift: Array | None = None
        if self._keeps_force:
            self._lift = preconditioner.preconditioner.lift(preconditioner)
        elif spring:
            self._lift = preconditioner(np.ones(preconditioner.cells.size)).astype(np.float64)
            self._lift /= float(self._lift.sum()) + 1 / spring

    def __call__(self, residual: Array) -> Array:
        """Return the preconditioned residual, made free of net force or conjugate to `_Uniform`."""
        mean = 0.0
        if self._keeps_force and self._lift is not None:
            # The mean would also use up digits of single precision.
            mean = dot(self._lift, residual)
        direction = self._preconditioner(residual, mean).astype(np.float64)
        if self._lift is not None:
            total = float(direction.sum())
            lift = self._lift

            def subtract(block: slice) -> None:
                direction[block] -= lift[block] * total

            in_threads(subtract, blocks(direction.size))
        if self._uniform:
            direction -= dot(self._uniform.inside, direction) / self._uniform.curvature
        return direction

    def mean(self, gap: Array) -> float:
        """Return the mean gap on the contact, which a free depth closes; 0 at a given depth."""
        return float(gap.mean()) if self._keeps_force else 0.0
