"""Contact with a traction across the gap, followed along a path."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.contact import Adhesive, Law, Problem, State, Stop, first_guess

from .adhesive_round import Round
from .anderson import RoundRecord, extrapolate_rounds, is_convex
from .contact_cg import SIGN_CERTAINTY, inner_solve
from .nested_grids import coarse_start
from .preconditioner import OnContact, Preconditioner
from .scaling import ScaledSolver

# The gap on the contact is closed to this share of the error of the tractions, or of the tolerance.
_CONTACT_SHARE: Final = 0.05
# Rounds whose tractions are extrapolated.
_MEMORY: Final = 8
# Bounds of the factor on the shift of the fronts; the latter is also its most growth in a round.
_LEAST_GAIN: Final = 1 / 16
_GREATEST_GAIN: Final = 2.0
# The greatest factor where the state is unstable, and its growth while the contact stays the same:
# with 2, of zones of one cell a round ends where the lattice holds the front.
_UNSTABLE_GAIN: Final = 256.0
_FASTER_SAME: Final = 4.0
# Rise of the energy in a round, over the work of adhesion of the cells along the front, above which
# it is made again with half the shift. Without this, lines that nearly meet fill.
_RISE: Final = 0.3
# Rounds without progress after which it may not rise at all with the residual.
_IDLE: Final = 2
# Set changes after which the next round begins, whose tractions move the contact anyway; a shift of
# the fronts is one. With 2 a step on a rough surface takes half as many applications again.
_CHANGES: Final = 3
# Rounds without a smaller residual after which the solve is abandoned.
_STAGNATION: Final = 60
# Gaps at which a law is asked whether it attracts, and the relative rounding error of tractions.
_GAPS: Final = 2001
_ROUNDING: Final = 1e-12


def refusal_of(law: Law) -> str:
    """Return why `AdhesionSolver` cannot solve with a law; "" if it can.

    That the energy falls in each round takes an attraction that is strongest at a closed gap and
    does not grow with the gap.
    """
    gaps = np.linspace(0.0, 1.01 * law.cutoff(), _GAPS)
    traction = law.traction(gaps)
    change = np.diff(traction)
    worst = int(np.argmin(change))
    if traction[0] < 0 and change[worst] >= -_ROUNDING * law.strength():
        return ""
    return (
        f"cannot solve with {law.name}: traction(gap) goes from {traction[worst]:.6g} Pa at "
        f"{gaps[worst]:.3g} m to {traction[worst + 1]:.6g} Pa at {gaps[worst + 1]:.3g} m; it has "
        "to attract, < 0, most at a closed gap, and less the wider the gap"
    )


class AdhesionSolver(ScaledSolver):
    """Solver of problems with a law, for `ActiveSet`.

    In each round the hard contact under given tractions t across the gap is closed by the inner
    solves of `ActiveSet`; then t is replaced by what the law exerts at the gap that results. For an
    attraction that decays with the gap the round is a step of the concave–convex procedure (Yuille
    & Rangarajan 2003): the energy falls in every round, so the state follows the start down to the
    next minimum. Two things make it fast:

    1. Shifting the edge of a contact costs little energy, so rounds alone would move it slowly,
       and the slower the longer the wave along the edge. The shift is estimated from the missed
       tractions with the stiffness of a crack front, see `Front`.
    2. While the contact stays the same, rounds are linear, and their tractions are extrapolated
       (Anderson 1965).
    """

    def begin(self, problem: Problem, start: State | None) -> Round:
        """Return the round from the last state; without one, from that of a coarser grid."""
        if not isinstance(problem, Adhesive):
            raise TypeError(f"{type(problem).__name__} has no law")
        preconditioner = Preconditioner(problem.operator)
        if start is not None and start.is_loaded:
            traction = start.pressure - start.wall
            return self._closed(problem, preconditioner.on(start.contact), start.wall, traction)
        # Without the law, a depth closes cells only beyond the first touch.
        lowest = float(problem.profile.max())
        closes = problem.prescribed == "force" or problem.value > -lowest
        coarse = coarse_start(self, problem) if closes else None
        if coarse:
            pressure, contact = coarse.pressure, coarse.wall > 0
        else:
            pressure = np.zeros(problem.grid.shape)
            if closes and problem.prescribed == "depth":
                pressure = first_guess(problem.without_law)
            contact = pressure > 0
        # Cells of the undeformed surface that just touch the indenter are in contact.
        touches = problem.prescribed == "force" or problem.value == -lowest
        contact |= touches & (problem.profile == lowest)
        gap, _ = problem.gap(problem.operator(pressure), contact)
        traction = problem.attraction(gap, contact).traction
        wall = np.where(contact, np.maximum(pressure - traction, 0.0), 0.0)
        return self._closed(problem, preconditioner.on(contact), wall, traction)

    def step(self, problem: Problem, state: Round) -> Round:
        """Return the next round."""
        traction, missed, wall = extrapolate_rounds(
            [*state.on_this_contact, state.record], state.contact
        )
        following, contact = traction + missed, state.contact
        on_contact, changes = state.on_contact, _CHANGES
        # On springs a front has no stiffness, and a shift would leave the minimum of each cell.
        if state.front.length and not problem.operator.is_bed:
            following, contact = state.front.move_front(following, missed, state.gain)
        following = np.clip(following, -state.problem.law.strength(), 0.0)
        if not np.array_equal(contact, state.contact):
            on_contact, changes = on_contact.preconditioner.on(contact), _CHANGES - 1
        # The contact takes up what the change of the tractions lifts.
        wall = on_contact.transfer(wall + traction - following)
        wall[~contact] = 0.0
        after = self._closed(state.problem, on_contact, wall, following, state, changes)
        if state.gain > _LEAST_GAIN and _has_risen(state, after):
            return replace(state, gain=max(0.5 * state.gain, _LEAST_GAIN))
        return replace(after, gain=_gain(state, after))

    def residual(self, problem: Problem, state: Round) -> float:
        """Return the largest of gap, penetration and missed traction, each relative."""
        return state.residual

    def pressure(self, state: Round) -> Array:
        """Return the traction on the surface [Pa]."""
        return state.wall + state.traction

    def state(self, state: Round) -> State:
        """Return traction, wall pressure and depth."""
        return State(state.wall + state.traction, np.maximum(state.wall, 0.0), state.depth)

    def terminate(self, problem: Problem, state: Round) -> Stop | None:
        """Return why the rounds end above the tolerance."""
        if problem.prescribed == "force" and not state.contact.any():
            return Stop.PULLED_OFF
        return Stop.STALLED if state.progress.stagnant >= _STAGNATION else None

    def _closed(
        self,
        problem: Adhesive,
        on_contact: OnContact,
        wall: Array,
        traction: Array,
        before: Round | None = None,
        changes: int = _CHANGES,
    ) -> Round:
        """Return the round that closes the contact under a traction, after ``changes`` at most."""
        goal, hard = self._goal(problem, before), problem.without_law
        contact = on_contact.contact
        settled = False
        for _ in range(changes):
            balanced = _with_wall_force(problem, contact, on_contact.transfer(wall), traction)
            if balanced is None:
                nothing = np.zeros(problem.grid.shape)
                released = on_contact.preconditioner.on(nothing > 0)
                return _finished(problem, released, nothing, nothing, nothing, before)
            wall = balanced
            displacement = problem.operator(wall + traction)
            wall, displacement, error, misclassified = inner_solve(
                hard, on_contact, wall, displacement, goal, certainty=SIGN_CERTAINTY
            )
            if not misclassified.size and error > 1.01 * goal:
                continue
            if settled := not misclassified.size:
                break
            contact = contact.copy()
            contact.ravel()[misclassified] ^= True
            on_contact = on_contact.preconditioner.on(contact)
        state = _finished(problem, on_contact, wall, traction, displacement, before, settled)
        if state.residual > self.tolerance:
            return state
        # An inner solve changes the displacement in single precision.
        del state
        displacement = problem.operator(wall + traction, out=displacement)
        return _finished(problem, on_contact, wall, traction, displacement, before, settled)

    def _goal(self, problem: Adhesive, before: Round | None) -> float:
        """Return the gap [m] to which a round closes: the less, the less the last one missed."""
        law = problem.law
        goal = 0.01 * law.cutoff()
        if before is None:
            return goal
        size = float(np.abs(before.missed).max(where=~before.contact, initial=0.0))
        goal = min(goal, _CONTACT_SHARE * size * law.cutoff() / law.strength())
        return max(goal, _CONTACT_SHARE * self.tolerance * before.scale)


def _finished(
    problem: Adhesive,
    on_contact: OnContact,
    wall: Array,
    traction: Array,
    displacement: Array,
    before: Round | None,
    settled: bool = True,
) -> Round:
    contact = on_contact.contact
    gap, depth = problem.gap(displacement, contact)
    acting = problem.attraction(gap, contact)
    state = Round(problem, on_contact, wall, traction, displacement, gap, depth, acting, settled)
    if before is None:
        return state
    history: tuple[tuple[Mask, RoundRecord], ...] = ()
    # A cell that just touches may leave the contact and return, where earlier rounds are of use.
    is_other = not np.array_equal(contact, before.contact)
    if settled and before.settled and (is_other or is_convex(before.record, state.record, contact)):
        history = (*before.history, (before.contact, before.record))[-_MEMORY:]
    return replace(
        state, history=history, progress=before.progress.after(state.residual, state.energy)
    )


def _has_risen(before: Round, after: Round) -> bool:
    """Return whether the energy has risen, because a shift or an extrapolation went wrong.

    That of a round which is not settled is not exact, and may rise a little.
    """
    if before.settled and after.settled and after.progress.stagnant >= _IDLE:
        energy_has_risen = after.energy_if_closed > before.energy_if_closed
        return energy_has_risen and after.residual > before.residual
    front = before.front.length / max(before.problem.grid.spacing)
    return after.energy - before.energy > _RISE * (front / before.gap.size)


def _gain(before: Round, after: Round) -> float:
    """Return the factor on the next shift of the fronts, from where this round should have ended.

    The missed tractions along the step fall linearly with its length on a smooth front, to 0 at the
    length at which the energy is least.
    """
    if after.on_this_contact:
        return 1.0
    step = after.traction - before.traction
    one, other = (float((step * part.missed).sum()) for part in (before, after))
    if other >= one > 0:
        # Past a stable position the energy falls ever faster, however slowly at first.
        same = np.array_equal(before.contact, after.contact)
        return min((_FASTER_SAME if same else _GREATEST_GAIN) * before.gain, _UNSTABLE_GAIN)
    best = one / (one - other) if one > 0 else _GREATEST_GAIN
    return float(
        np.clip(before.gain * np.clip(best, 0.5, _GREATEST_GAIN), _LEAST_GAIN, _GREATEST_GAIN)
    )


def _with_wall_force(problem: Problem, contact: Mask, wall: Array, traction: Array) -> Array | None:
    """Return the wall pressure scaled such that force control has its force; None if it pulls."""
    if problem.prescribed == "depth":
        return wall
    wanted = problem.value / problem.grid.cell_area - float(traction.sum())
    if not wanted > 0 or not contact.any():
        return None
    total = float(wall.sum())
    return wall * (wanted / total) if total > 0 else contact * (wanted / contact.sum())
