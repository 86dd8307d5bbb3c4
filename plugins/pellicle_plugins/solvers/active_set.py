"""Nested grids, a primal–dual active set, and a preconditioner that knows the contact's edge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from pellicle import hookimpl
from pellicle.components import Monitor, Solver
from pellicle.errors import ConfigError
from pellicle.operators import Array
from pellicle.problem import Problem
from pellicle.transfer import prolong

from .guess import first_guess, with_force
from .inner_solve import Inner, inner_solve
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
# Looks without progress after which round-off is taken to be all that is left of the error.
_PATIENCE: Final = 30
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
    def gets_on(self) -> bool:
        """Whether the last look found fewer wrong cells than any before."""
        return len(self.contacts) <= 1 and self.returns == 0

    def after(self, contact: NDArray[np.bool_], wrong: int) -> History:
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

    def begin(self, problem: Problem, start: Array | None) -> _State:
        """Return the state of the last step's pressure, or of the solution on a coarser grid."""
        preconditioner = Preconditioner(problem.operator)
        if start is not None and start.any():
            state = _measured(problem, start, preconditioner.on(start > 0), preconditioner)
            if state.error <= _CLOSE * state.scale:
                return state
        start = self._cold_start(problem)
        return _measured(problem, start, preconditioner.on(start > 0), preconditioner)

    def step(self, problem: Problem, state: _State) -> _State:
        """Return the state after one inner solve and one look at the contact."""
        goal = self.tolerance / 2 * state.scale
        # Loose solves are quick as long as they lead to fewer wrong cells.
        loose = state.history.gets_on
        found = inner_solve(
            problem,
            state.on_contact,
            state.start,
            state.displacement,
            goal,
            doubt=_DOUBT if loose else _DEEP_DOUBT,
            reduction=_REDUCTION if loose and state.on_contact.bends else 0.0,
        )
        history = state.history.after(state.on_contact.contact, found.wrong.size)
        on_contact, start = _next(problem, state, found, history, goal)
        return _measured(problem, start, on_contact, state.preconditioner, history)

    def residual(self, problem: Problem, state: _State) -> float:
        """Return max(|gap| in contact, penetration outside) over the height range in contact."""
        return state.error / state.scale

    def pressure(self, state: _State) -> Array:
        """Return the pressure of a state."""
        return state.pressure

    def patience(self, problem: Problem) -> int:
        """Return how many looks may bring no progress, as while a contact goes round."""
        return _PATIENCE

    def merits(self, problem: Problem, state: _State) -> tuple[float, ...]:
        """Return the least number of cells found wrong.

        A contact that is wrong by a row of cells errs by more than one that is wrong everywhere.
        """
        return (state.history.fewest,)

    def punch_pressure(
        self, problem: Problem, contact: NDArray[np.bool_], monitor: Monitor
    ) -> Array:
        """Return the pressure per depth [Pa/m] under a flat punch, by the same inner solves."""
        profile = np.where(contact, 0.0, -np.inf)
        unit = 1 / problem.operator.unit
        operator = problem.operator.scaled(unit)
        flat = replace(
            problem, operator=operator, profile=profile, prescribed="depth", value=1.0
        )
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

    def _cold_start(self, problem: Problem) -> Array:
        if max(problem.grid.shape) > _COARSEST:
            try:
                coarse = problem.coarsened()
            except ConfigError:
                # A thin incompressible layer is rigid under cells much wider than it is thick.
                return first_guess(problem)
            if coarse.touches:
                tolerance = max(self.tolerance, _COARSE_TOLERANCE)
                solver = self.model_copy(update={"tolerance": tolerance})
                found = solver.solve(coarse, None, lambda iteration, excess: None)
                pressure = prolong(found.pressure, problem.grid.shape)
                # A coarse cell may hang over the rim of the indenter.
                pressure *= np.isfinite(problem.profile)
                if pressure.any():
                    return pressure
        return first_guess(problem)


def _next(
    problem: Problem, state: _State, found: Inner, history: History, margin: float
) -> tuple[OnContact, Array]:
    """Return the contact to try next and what to start from on it [Pa].

    Cells penetrate where they do by more than ``margin`` [m].
    """
    if not found.wrong.size:
        return state.on_contact, found.pressure
    preconditioner, contact = state.preconditioner, state.on_contact.contact
    if (
        preconditioner.bends
        and found.pressure.any()
        and history.returns == 0
        and len(history.contacts) <= _SETTLING
    ):
        settled, forces = relaxed(problem, preconditioner.settling, state.on_contact, found, margin)
        on_settled = preconditioner.on(settled)
        start = on_settled.moved(forces)
        if start.sum() > 0:
            return on_settled, start
    one = history.returns > (1 if preconditioner.bends else 0)
    changed = contact.copy()
    changed.ravel()[found.wrong[: 1 if one else None]] ^= True
    on_changed = preconditioner.on(changed)
    return on_changed, on_changed.moved(found.pressure)


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
    return _State(
        problem=problem,
        start=start,
        displacement=displacement,
        on_contact=on_contact,
        scale=problem.height_scale(pressed, depth, float(start.sum())),
        error=max(inside, -float(gap.min(initial=0.0))),
        preconditioner=preconditioner,
        history=history,
    )


@hookimpl
def register_solvers(register: Callable[[type[Solver]], None]) -> None:
    """Register the solver."""
    register(ActiveSet)
