"""The primal–dual active set method on nested grids, with a preconditioner for the contact."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.components import Monitor
from pellicle.contact import (
    Adhesive,
    Depth,
    Problem,
    Progress,
    Solution,
    State,
    Stop,
    first_guess,
    with_force,
)

from .adhesion import AdhesionSolver, refusal_of
from .adhesive_response import with_zone
from .bending.few_cells import MOST_CELLS, solved_on_few_cells
from .bending.relaxation import relax_locally
from .contact_cg import SIGN_CERTAINTY, STRICT_SIGN_CERTAINTY, InnerSolution, inner_solve
from .nested_grids import coarse_start
from .preconditioner import OnContact, Preconditioner
from .scaling import ScaledSolver

# A start is used if its error is at most this share of the height range; correcting a worse one
# along the contact edge takes longer than solving on the coarser grids first.
_CLOSE: Final = 0.05
# With bending stiffness, an inner solve ends for local relaxation when the gap has fallen to this
# share.
_REDUCTION: Final = 0.1
# Cells of a prolonged contact with a gap above this share of the height range are released: on a
# surface that is rough at the size of a cell they are pits, which the coarse grid cannot resolve.
_PIT: Final = 0.4
# With bending stiffness, a cell joins the contact if it penetrates by this share of the deepest
# penetration or more: a cell that joins lifts its neighbours.
_DEEPEST: Final = 0.5
# A local relaxation that leaves a larger error than before, above this share of the height range,
# is rejected.
_DIVERGED: Final = 0.5
# Outer iterations without progress after which contacts of few cells are treated as all others.
_EXACT_STAGNATION: Final = 5
# Outer iterations without progress after which the solve is abandoned.
_STAGNATION: Final = 30
# Local relaxation is switched off after this many outer iterations without fewer misclassified
# cells.
_RELAXATION_STAGNATION: Final = 10


@dataclass(frozen=True)
class ContactHistory:
    """The contacts since the number of misclassified cells was least, to detect cycles."""

    contacts: frozenset[bytes] = frozenset()
    """The contacts, packed into bits."""
    fewest: float = np.inf
    """Least number of misclassified cells."""
    returns: int = 0
    """Number of times that an earlier contact recurred; `contacts` is then cleared."""

    @property
    def makes_progress(self) -> bool:
        """Whether the last outer iteration left fewer misclassified cells than any before."""
        return len(self.contacts) <= 1 and self.returns == 0

    def after(self, contact: Mask, misclassified: int) -> ContactHistory:
        """Return the history after an inner solve on a contact with its misclassified cells."""
        packed = np.packbits(contact).tobytes()
        if misclassified < self.fewest:
            return ContactHistory(frozenset({packed}), misclassified)
        if packed in self.contacts:
            return ContactHistory(frozenset({packed}), self.fewest, self.returns + 1)
        return replace(self, contacts=self.contacts | {packed})


@dataclass(frozen=True)
class _Iterate:
    problem: Problem
    trial: Array
    """Pressure from which the next inner solve starts [Pa]; it may be tensile."""
    displacement: Array
    """The displacement under ``trial`` [m]."""
    u_minus_f: Array
    """The displacement minus the profile on the cells of the contact [m]."""
    on_contact: OnContact
    """Preconditioner on the contact of the next inner solve."""
    scale: float
    """Height range of the indenter in contact [m]."""
    error: float
    """max(|gap| under pressure, penetration) of ``trial`` [m]."""
    history: ContactHistory
    progress: Progress
    """Progress of the error over `scale` and of the least number of misclassified cells."""
    may_relax: bool
    """False once local relaxation has led away from the solution."""

    @property
    def bends(self) -> bool:
        """Whether bending dominates the stiffness at the size of a cell."""
        return self.on_contact.preconditioner.bends


class ActiveSet(ScaledSolver):
    """Solver whose number of operator applications hardly grows with the grid or the tension.

    The contact is first computed on coarser grids. In each outer iteration an inner solve finds
    the pressure, of either sign, that closes the gap on the contact; cells with tensile pressure
    leave the contact and cells that penetrate join it (Hintermüller, Ito & Kunisch 2002), until no
    cell is misclassified. This differs from the textbook method in four points:

    1. An inner solve ends as soon as it is certain which cells are misclassified. Cells of
       uncertain sign stay as they are, so that an inexact solve does not scatter the contact.
    2. The pressure of cells that leave is transferred to those around them.
    3. With bending stiffness the state of one cell decides that of the next ones, and cells change
       sides together in a local relaxation.
    4. When a contact recurs, one cell at a time changes sides (Murty 1974) until fewer cells are
       misclassified than ever before.
    """

    type: Literal["active_set"] = "active_set"
    examples = ({"tolerance": 1e-09},)

    def refuses(self, problem: Problem) -> str:
        """Return why it cannot solve with a law; "" for one that attracts, and less the wider."""
        return refusal_of(problem.law) if isinstance(problem, Adhesive) else ""

    def solve(self, problem: Problem, start: State | None, monitor: Monitor) -> Solution:
        """Return the solution of a load step; with a law by `AdhesionSolver`."""
        if isinstance(problem, Adhesive):
            adhesion = AdhesionSolver(tolerance=self.tolerance, max_iterations=self.max_iterations)
            return adhesion.solve(problem, start, monitor)
        return super().solve(problem, start, monitor)

    def begin(self, problem: Problem, start: State | None) -> _Iterate:
        """Return the iterate of the last step if it is close, else that of a coarser grid."""
        preconditioner = Preconditioner(problem.operator)
        if start is not None and start.contact.any():
            state = _iterate(problem, preconditioner.on(start.contact), start.wall)
            if state.error <= _CLOSE * state.scale:
                return state
        from_coarse = coarse_start(self, problem)
        pressure = first_guess(problem) if from_coarse is None else from_coarse.wall
        state = _iterate(problem, preconditioner.on(pressure > 0), pressure)
        return state if from_coarse is None else _without_pits(problem, state)

    def step(self, problem: Problem, state: _Iterate) -> _Iterate:
        """Return the iterate after one outer iteration."""
        goal = self.tolerance / 2 * state.scale
        if state.bends and (after := _of_few_cells(problem, state, goal)):
            return after
        # Loose solves are cheap as long as they leave fewer misclassified cells. With bending
        # stiffness they only prepare a local relaxation.
        relaxes = state.bends and state.may_relax
        loose = state.history.makes_progress and (relaxes or not state.bends)
        inner = inner_solve(
            problem,
            state.on_contact,
            state.trial,
            state.displacement,
            goal,
            certainty=SIGN_CERTAINTY if loose else STRICT_SIGN_CERTAINTY,
            reduction=_REDUCTION if loose and relaxes else 0.0,
            u_minus_f=state.u_minus_f,
        )
        history = state.history.after(state.on_contact.contact, inner.misclassified.size)
        if not inner.misclassified.size:
            if state.bends:
                # The same contact again, with a smaller gap, is not a cycle.
                history = ContactHistory(returns=state.history.returns)
            return _iterate(problem, state.on_contact, inner.pressure, history, state)
        if state.bends and (after := _after_relaxation(problem, state, inner, history, goal)):
            return after
        on_contact = _changed(problem, state, inner, history)
        trial = on_contact.transfer(inner.pressure, out=inner.pressure)
        # This frees an array while the next displacement is computed.
        del inner
        return _iterate(problem, on_contact, trial, history, state)

    def residual(self, problem: Problem, state: _Iterate) -> float:
        """Return max(|gap| in contact, penetration outside) over the height range in contact."""
        return state.error / state.scale

    def pressure(self, state: _Iterate) -> Array:
        """Return ``trial`` without its tensile part, scaled to the prescribed force if any [Pa]."""
        if state.trial.min() >= 0:
            return state.trial
        return with_force(state.problem, np.maximum(state.trial, 0))

    def terminate(self, problem: Problem, state: _Iterate) -> Stop | None:
        """Return `Stop.STALLED` if neither error nor number of misclassified cells falls any more.

        The error alone is not enough: a contact with one row of misclassified cells may have a
        larger error than one that is wrong everywhere.
        """
        return Stop.STALLED if state.progress.stagnant >= _STAGNATION else None

    def response(self, problem: Problem, state: State, monitor: Monitor) -> Array:
        """Return dp/dδ [Pa/m] with the contact fixed, by the same inner solves."""
        contact = state.contact
        unit = 1 / problem.operator.unit
        operator = problem.operator.scaled(unit)
        on_contact = Preconditioner(operator).on(contact)
        goal = self.tolerance / 2

        def closing(lifted: Array) -> Array:
            """Return the pressure that moves the contact from the displacement ``lifted`` to 1."""
            profile = np.where(contact, -lifted, -np.inf)
            punch = Problem(problem.grid, operator, profile, Depth(1.0))
            pressure, displacement = np.zeros(contact.shape), np.zeros(contact.shape)
            error, before, iteration = 1.0, np.inf, 0
            # Each solve leaves a gap that single precision cannot resolve, so it is repeated.
            while goal < error < before / 2:
                monitor(iteration, error / self.tolerance)
                pressure = inner_solve(
                    punch, on_contact, pressure, displacement, goal, certainty=np.inf
                ).pressure
                displacement = operator(pressure)
                missed = profile[contact] + 1.0 - displacement[contact]
                error, before = float(np.abs(missed).max()), error
                iteration += 1
            return pressure

        if not isinstance(problem, Adhesive):
            return closing(np.zeros(contact.shape)) * unit
        gap = problem.operator(state.pressure) - problem.profile - state.depth
        acting = problem.attraction(gap, contact)

        def following(opened: Array) -> Array:
            return acting.change(opened) / unit

        return with_zone(operator, acting.zone, following, closing, goal) * unit


def _of_few_cells(problem: Problem, state: _Iterate, goal: float) -> _Iterate | None:
    """Return the iterate that is exact on a contact of few cells; None for all others."""
    contact, preconditioner = state.on_contact.contact, state.on_contact.preconditioner
    if state.on_contact.cells.size > MOST_CELLS or state.progress.stagnant >= _EXACT_STAGNATION:
        return None
    gap, _ = problem.gap(state.displacement, contact)
    column = preconditioner.column
    pressure = solved_on_few_cells(problem, column, contact, state.trial, gap, goal)
    if pressure is None:
        return None
    return _iterate(problem, preconditioner.on(pressure > 0), pressure, state.history, state)


def _after_relaxation(
    problem: Problem,
    state: _Iterate,
    inner: InnerSolution,
    history: ContactHistory,
    goal: float,
) -> _Iterate | None:
    """Return the iterate after local relaxation; None once that helps no more."""
    ends = history.returns > 0 or len(history.contacts) > _RELAXATION_STAGNATION
    if ends or not state.may_relax or not inner.pressure.any():
        return None
    settled, forces = relax_locally(problem, state.on_contact, inner, goal)
    on_contact = state.on_contact.preconditioner.on(settled)
    trial = on_contact.transfer(forces)
    if not trial.sum() > 0:
        return None
    after = _iterate(problem, on_contact, trial, history, state)
    if after.error <= max(state.error, _DIVERGED * after.scale):
        return after
    # The inner solve on the same contact is continued instead.
    after = _iterate(problem, state.on_contact, inner.pressure, state.history, state)
    return replace(after, may_relax=False)


def _without_pits(problem: Problem, state: _Iterate) -> _Iterate:
    """Return the iterate of a prolonged pressure without the cells that are pits.

    If heights vary from cell to cell, the contact of a coarser grid covers pits too. Under force
    control they are kept, since the force may be large enough to close them.
    """
    if problem.prescribed == "force":
        return state
    on_contact = state.on_contact
    gap, _ = problem.gap(state.displacement, on_contact.contact)
    pits = (gap > _PIT * state.scale) & (gap * on_contact.preconditioner.stiffest > state.trial)
    retained = on_contact.contact & ~pits
    if not retained.any() or retained.sum() == on_contact.cells.size:
        return state
    on_contact = on_contact.preconditioner.on(retained)
    return _iterate(problem, on_contact, on_contact.transfer(state.trial))


def _changed(
    problem: Problem, state: _Iterate, inner: InnerSolution, history: ContactHistory
) -> OnContact:
    """Return the contact after changing the misclassified cells, or one of them in a cycle."""
    contact, cells = state.on_contact.contact, inner.misclassified
    if history.returns > (1 if state.bends else 0):
        cells = cells[:1]
    elif state.bends:
        gap = problem.gap(inner.displacement, contact)[0].ravel()[cells]
        joins = ~contact.ravel()[cells]
        deepest = float(gap.min(initial=0.0, where=joins))
        cells = cells[~joins | (gap <= _DEEPEST * deepest)]
    changed = contact.copy()
    changed.ravel()[cells] ^= True
    return state.on_contact.preconditioner.on(changed)


def _iterate(
    problem: Problem,
    on_contact: OnContact,
    trial: Array,
    history: ContactHistory | None = None,
    before: _Iterate | None = None,
) -> _Iterate:
    """Return the iterate of a pressure [Pa], scaled to the prescribed force if any.

    The pressure is 0 off the contact. It is overwritten, and so is the displacement of the iterate
    ``before``, which is not used any more.
    """
    history = history or ContactHistory()
    trial = with_force(problem, trial, out=trial)
    cells, width = on_contact.cells, trial.shape[1]
    u_minus_f, lowest = np.empty(cells.size), [np.inf]

    def measure(displacement: Array, rows: slice) -> None:
        above = displacement[rows] - problem.profile[rows]
        lowest.append(float(above.min()))
        first, last = np.searchsorted(cells, (rows.start * width, rows.stop * width))
        u_minus_f[first:last] = above.ravel().take(cells[first:last] - rows.start * width)

    displacement = before.displacement if before else None
    displacement = problem.operator(trial, out=displacement, visit=measure)
    pressed, inside = cells, u_minus_f
    loaded = trial.ravel()[cells] != 0
    if not loaded.all():
        pressed, inside = cells[loaded], u_minus_f[loaded]
    depth = problem.depth(inside)
    error = max(float(np.abs(inside - depth).max(initial=0.0)), depth - min(lowest))
    scale = problem.height_scale(pressed, depth, float(trial.sum()))
    progress = before.progress if before else Progress()
    return _Iterate(
        problem=problem,
        trial=trial,
        displacement=displacement,
        u_minus_f=u_minus_f,
        on_contact=on_contact,
        scale=scale,
        error=error,
        history=history,
        progress=progress.after(error / scale, history.fewest),
        may_relax=before is None or before.may_relax,
    )
