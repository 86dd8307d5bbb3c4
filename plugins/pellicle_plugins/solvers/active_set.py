"""Nested grids, a primal–dual active set, and a preconditioner that knows the contact's edge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from pellicle import hookimpl
from pellicle.arrays import Array, Mask
from pellicle.components import Monitor, Solver
from pellicle.errors import ConfigError
from pellicle.numerics.grid_transfer import highest, prolong
from pellicle.numerics.problem import Depth, Problem
from pellicle.numerics.solution import Progress, State, Stop

from .contact_cg import Inner, inner_solve
from .initial_guess import first_guess, with_force
from .preconditioner import OnContact, Preconditioner
from .relaxation import relaxed
from .scaling import ScaledSolver

# Coarse grids are solved to this share of the height range: with tension a smaller error than that
# of the grid itself still moves the edge of the contact by several cells.
_COARSE_TOLERANCE: Final = 1e-5
# Grids with no more cells than this along their longer edge are not coarsened.
_COARSEST: Final = 48
# A start with an error above this share of the height range costs more to mend, along the edge of
# the contact, than a solve from the coarser grids.
_CLOSE: Final = 0.05
# What an inner solve counts on later iterations to change, over what the last one did; and where
# the last look did not find fewer cells wrong.
_DOUBT: Final = 1.0
_DEEP_DOUBT: Final = 30.0
# Under a skin that bends a gap that has shrunk to this share is closed as the cells settle.
_REDUCTION: Final = 0.1
# Cells of a coarser grid's contact that lie this share of the height range above the indenter, on a
# surface rough at the size of a cell, are not in contact.
_HANGING: Final = 0.4
# Under a skin that bends a cell joins the contact if it penetrates by this share of the deepest:
# one that joins lifts those around it.
_DEEPEST: Final = 0.5
# Cells that settled have gone astray where the error is above this share of the height range.
_ASTRAY: Final = 0.5
# Outer iterations without progress after which the solve is abandoned.
_STAGNATION: Final = 30
# Where as many looks find no fewer cells wrong, cells are no longer left to settle together.
_SETTLING: Final = 10


@dataclass(frozen=True)
class History:
    """What has been tried since the fewest cells were wrong, to tell when it goes round."""

    contacts: frozenset[bytes] = frozenset()
    """Every contact that there was, packed."""
    fewest: float = np.inf
    """Least number of cells found wrong."""
    returns: int = 0
    """How often a contact came back; then `contacts` begins anew."""

    @property
    def makes_progress(self) -> bool:
        """Whether the last look found fewer wrong cells than any before."""
        return len(self.contacts) <= 1 and self.returns == 0

    def after(self, contact: Mask, wrong: int) -> History:
        """Return it after an inner solve on a contact that found so many cells wrong."""
        packed = np.packbits(contact).tobytes()
        if wrong < self.fewest:
            return History(frozenset({packed}), wrong)
        if packed in self.contacts:
            return History(frozenset({packed}), self.fewest, self.returns + 1)
        return replace(self, contacts=self.contacts | {packed})


@dataclass(frozen=True)
class _State:
    problem: Problem
    start: Array
    """Pressure that the next inner solve starts from [Pa]; it may still pull."""
    displacement: Array
    """What ``start`` makes [m]."""
    on_contact: OnContact
    """Preconditioner of where the next inner solve puts pressure."""
    scale: float
    """Height range of the indenter in contact [m]."""
    error: float
    """max(|gap| under pressure, penetration) of ``start`` [m]."""
    preconditioner: Preconditioner
    history: History
    progress: Progress
    """Of the error over `scale` and of the fewest misclassified cells."""
    relaxes: bool
    """Whether cells may settle together; not once that has led away from the solution."""

    @property
    def settles(self) -> bool:
        """Whether cells settle together: bending decides, and they have not gone astray."""
        return self.preconditioner.bends and self.relaxes

    @property
    def pressure(self) -> Array:
        """``start`` without what pulls, with the force that is prescribed [Pa]."""
        if self.start.min() >= 0:
            return self.start
        return with_force(self.problem, np.maximum(self.start, 0))


class ActiveSet(ScaledSolver):
    """Solver whose operator applications hardly grow with the grid or with the tension.

    The contact is guessed on a coarser grid; an inner solve finds the pressure, of either sign,
    that closes the gap on it; cells that would need suction leave, cells that penetrate join
    (Hintermüller, Ito & Kunisch 2002), and so on until nothing changes. Departures: (1) an inner
    solve ends as soon as it is certain which cells are wrong, and those in doubt stay, so that
    loose solves do not scatter the contact; (2) what pressed on cells that leave goes to those
    around them (see `OnContact.moved`); (3) on a skin that bends, what one cell does decides what
    the next ones do, and they settle together (see `relaxed`); (4) where a contact comes back, one
    cell at a time changes sides (Murty 1974), until fewer are wrong than ever.
    """

    type: Literal["active_set"] = "active_set"

    def begin(self, problem: Problem, start: State | None) -> _State:
        """Return the state of the last step's pressure, or of the solution on a coarser grid."""
        preconditioner = Preconditioner(problem.operator)
        if start is not None and start.contact.any():
            on_start = preconditioner.on(start.contact)
            state = _measured(problem, start.pressure, on_start, preconditioner)
            if state.error <= _CLOSE * state.scale:
                return state
        prolonged = self._prolonged(problem)
        pressure = first_guess(problem) if prolonged is None else prolonged
        state = _measured(problem, pressure, preconditioner.on(pressure > 0), preconditioner)
        return state if prolonged is None else _without_hanging(problem, state)

    def step(self, problem: Problem, state: _State) -> _State:
        """Return the state after one inner solve and one look at the contact."""
        goal = self.tolerance / 2 * state.scale
        # Loose solves are quick as long as they lead to fewer wrong cells. Under a skin that bends
        # they tell what settles, not yet which cells are wrong.
        loose = state.history.makes_progress and (state.settles or not state.preconditioner.bends)
        solved = inner_solve(
            problem,
            state.on_contact,
            state.start,
            state.displacement,
            goal,
            doubt=_DOUBT if loose else _DEEP_DOUBT,
            reduction=_REDUCTION if loose and state.settles else 0.0,
        )
        history = state.history.after(state.on_contact.contact, solved.wrong.size)
        if not solved.wrong.size:
            return _after(problem, state, state.on_contact, solved.pressure, history)
        if (
            state.settles
            and solved.pressure.any()
            and history.returns == 0
            and len(history.contacts) <= _SETTLING
        ):
            relaxed_state = _relaxed(problem, state, solved, history, goal)
            if relaxed_state is not None:
                if relaxed_state.error <= max(state.error, _ASTRAY * relaxed_state.scale):
                    return relaxed_state
                # The same contact once more, solved further.
                again = _after(problem, state, state.on_contact, solved.pressure, state.history)
                return replace(again, relaxes=False)
        on_changed = _changed(problem, state, solved, history)
        pressure = on_changed.moved(solved.pressure)
        # Two arrays less while the next displacement is computed.
        del solved
        return _after(problem, state, on_changed, pressure, history)

    def residual(self, problem: Problem, state: _State) -> float:
        """Return max(|gap| in contact, penetration outside) over the height range in contact."""
        return state.error / state.scale

    def pressure(self, state: _State) -> Array:
        """Return the pressure of a state."""
        return state.pressure

    def terminate(self, problem: Problem, state: _State) -> Stop | None:
        """Return whether the iteration stalls: neither the error nor the misclassified cells fall.

        The error of a contact with a row of misclassified cells may exceed that of one with many.
        """
        return Stop.STALLED if state.progress.stagnant >= _STAGNATION else None

    def response(self, problem: Problem, state: State, monitor: Monitor) -> Array:
        """Return dp/dδ [Pa/m] with the contact fixed, by the same inner solves."""
        contact = state.contact
        profile = np.where(contact, 0.0, -np.inf)
        unit = 1 / problem.operator.unit
        operator = problem.operator.scaled(unit)
        flat = replace(problem, operator=operator, profile=profile, control=Depth(1.0))
        preconditioner = Preconditioner(operator).on(contact)
        goal = self.tolerance / 2
        pressure, displacement = np.zeros(problem.grid.shape), np.zeros(problem.grid.shape)
        error, before, iteration = 1.0, np.inf, 0
        # Each solve leaves what its single precision has no digits for.
        while goal < error < before / 2:
            monitor(iteration, error / self.tolerance)
            pressure = inner_solve(
                flat, preconditioner, pressure, displacement, goal, doubt=np.inf
            ).pressure
            displacement = operator(pressure)
            error, before = float(np.abs(1.0 - displacement[contact]).max()), error
            iteration += 1
        return pressure * unit

    def _prolonged(self, problem: Problem) -> Array | None:
        """Return the pressure [Pa] solved for on a coarser grid, None if that tells nothing."""
        if max(problem.grid.shape) <= _COARSEST:
            return None
        try:
            coarse = problem.coarsened()
        except ConfigError:
            # A thin incompressible layer is rigid under cells much wider than it is thick.
            return None
        if not coarse.touches:
            # The indenter touches with less than half of each coarse cell.
            coarse = replace(coarse, profile=highest(problem.profile, coarse.grid.shape))
        tolerance = max(self.tolerance, _COARSE_TOLERANCE)
        solver = self.model_copy(update={"tolerance": tolerance})
        solution = solver.solve(coarse, None, lambda iteration, residual_ratio: None)
        pressure = prolong(solution.pressure, problem.grid.shape)
        # A coarse cell may hang over the rim of the indenter.
        pressure *= np.isfinite(problem.profile)
        return pressure if pressure.any() else None


def _without_hanging(problem: Problem, state: _State) -> _State:
    """Return the state of a coarser grid's pressure without the cells that hang over the indenter.

    Where heights change from cell to cell, a coarser grid's contact covers pits as well. A
    prescribed force may be high enough for them to touch.
    """
    if problem.prescribed == "force":
        return state
    contact = state.on_contact.contact
    gap = state.displacement - problem.profile
    gap -= problem.depth(gap[contact])
    hangs = gap > _HANGING * state.scale
    hangs &= gap * state.preconditioner.stiffest > state.start
    kept = contact & ~hangs
    if not kept.any() or kept.sum() == contact.sum():
        return state
    on_kept = state.preconditioner.on(kept)
    return _after(problem, state, on_kept, on_kept.moved(state.start), state.history)


def _relaxed(
    problem: Problem, state: _State, solved: Inner, history: History, margin: float
) -> _State | None:
    """Return the state once cells have settled together, None if nothing presses then.

    Cells penetrate where they do by more than ``margin`` [m].
    """
    preconditioner = state.preconditioner
    contact, forces = relaxed(problem, preconditioner.settling, state.on_contact, solved, margin)
    on_contact = preconditioner.on(contact)
    start = on_contact.moved(forces)
    return _after(problem, state, on_contact, start, history) if start.sum() > 0 else None


def _changed(problem: Problem, state: _State, solved: Inner, history: History) -> OnContact:
    """Return the contact once the wrong cells have changed sides, or one of them in a cycle."""
    contact, wrong, bends = state.on_contact.contact, solved.wrong, state.preconditioner.bends
    if history.returns > (1 if bends else 0):
        wrong = wrong[:1]
    elif bends:
        gap = solved.displacement - problem.profile
        gap -= problem.depth(gap[contact])
        joins = ~contact.ravel()[wrong]
        deepest = float(gap.ravel()[wrong].min(initial=0.0, where=joins))
        wrong = wrong[~joins | (gap.ravel()[wrong] <= _DEEPEST * deepest)]
    changed = contact.copy()
    changed.ravel()[wrong] ^= True
    return state.preconditioner.on(changed)


def _after(
    problem: Problem, state: _State, on_contact: OnContact, start: Array, history: History
) -> _State:
    """Return the state after ``state`` with another pressure [Pa] and contact."""
    measured = _measured(problem, start, on_contact, state.preconditioner, history)
    progress = state.progress.after(measured.error / measured.scale, history.fewest)
    return replace(measured, relaxes=state.relaxes, progress=progress)


def _measured(
    problem: Problem,
    start: Array,
    on_contact: OnContact,
    preconditioner: Preconditioner,
    history: History = History(),
) -> _State:
    """Return the state of a pressure [Pa], with the force that is prescribed."""
    start = with_force(problem, start)
    displacement = problem.operator(start)
    pressed = start != 0
    gap = displacement - problem.profile
    depth = problem.depth(gap[pressed])
    gap -= depth
    inside = float(np.abs(gap[pressed]).max(initial=0.0))
    scale = problem.height_scale(pressed, depth, float(start.sum()))
    error = max(inside, -float(gap.min(initial=0.0)))
    return _State(
        problem=problem,
        start=start,
        displacement=displacement,
        on_contact=on_contact,
        scale=scale,
        error=error,
        preconditioner=preconditioner,
        history=history,
        progress=Progress().after(error / scale, history.fewest),
        relaxes=True,
    )


@hookimpl
def register_solvers(register: Callable[[type[Solver]], None]) -> None:
    """Register the solver."""
    register(ActiveSet)
