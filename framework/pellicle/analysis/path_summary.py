"""A path of load steps with an interaction: where contact is lost and gained, and its work."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import nan
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pellicle.arrays import Array, Mask


class Leg(NamedTuple):
    """Steps of a path between two turns, both turns included."""

    steps: slice
    direction: Literal["approach", "retraction"]


@dataclass(frozen=True)
class PathSummary:
    """The events on a path of load steps; NaN for those that the path does not contain.

    Events are known to a step: the true depth lies within the given accuracy of the stated one.
    """

    pull_off: float = nan
    """Lowest force [N] on the path, if it is negative and the path retracts beyond it."""
    pull_off_depth: float = nan
    """Depth [m] of the step of lowest force."""
    pull_off_radius: float = nan
    """Contact radius [m] at the step of lowest force."""
    pull_off_step: float = nan
    """Number of the step of lowest force, counted from 1."""
    pull_off_accuracy: float = nan
    """Error [N] of the force at that step, if it is known."""
    detach: float = nan
    """Depth [m] of the last step in contact before contact is first lost."""
    detach_force: float = nan
    """Force [N] at that step."""
    detach_step: float = nan
    """Number of that step, counted from 1."""
    detach_accuracy: float = nan
    """Distance in depth [m] from that step to the next, in which contact is lost."""
    jump_in: float = nan
    """Depth [m] of the first step in contact after one out of contact."""
    jump_in_force: float = nan
    """Force [N] at that step."""
    jump_in_step: float = nan
    """Number of that step, counted from 1."""
    jump_in_accuracy: float = nan
    """Distance in depth [m] from the step before, in which contact is gained."""
    work: float = nan
    """∫F dδ [J] over the path by the trapezoidal rule; for a closed loop the energy lost in it."""
    work_accuracy: float = nan
    """Uncertainty of the work [J] from steps in which contact is lost or gained: Σ|ΔF Δδ|/2."""
    dissipated_energy: float = nan
    """Work less the change of the energy between the ends of the path [J]."""


def legs(depth: ArrayLike) -> list[Leg]:
    """Return the parts of a path in which the depth [m] grows (approach) or falls (retraction).

    Neighbouring legs share the step at which the path turns. Steps at the depth of the one before
    belong to its leg. There is one leg at least, unless the path is empty.
    """
    values = np.asarray(depth, dtype=float)
    if not values.size:
        return []
    # Whether the depth grows in each interval between steps; a hold is as before it.
    signs = np.sign(np.diff(values))
    moving = np.flatnonzero(signs)
    rises = np.ones(max(signs.size, 1), dtype=bool)
    if moving.size:
        last = np.searchsorted(moving, np.arange(signs.size), side="right") - 1
        rises = signs[moving[np.maximum(last, 0)]] > 0
    turns = np.flatnonzero(rises[1:] != rises[:-1]) + 1
    ends = [0, *turns.tolist(), values.size - 1]
    return [
        Leg(slice(first, last + 1), "approach" if rises[first] else "retraction")
        for first, last in pairwise(ends)
    ]


def path_summary(
    depth: ArrayLike,
    force: ArrayLike,
    contact_radius: ArrayLike,
    energy: ArrayLike | None = None,
    converged: ArrayLike | None = None,
    force_error: ArrayLike | None = None,
) -> PathSummary:
    """Return where a path of load steps pulls hardest, loses and gains contact, and its work.

    The indenter is out of reach before the first step, so a path that begins in contact has no
    jump-in there.

    The steps in order have δ [m], F [N], negative where the indenter is pulled, and the radius of
    the circle that has the contact area [m], 0 out of contact; each of shape (n,). Without their
    ``energy``, elastic and of the interaction [J], the dissipated energy is NaN, and without a
    ``force_error`` [N] the accuracy of the pull-off is. Steps that did not converge are left out,
    and work and dissipated energy are NaN if there are any.
    """
    columns = [np.asarray(values, dtype=float) for values in (depth, force, contact_radius)]
    good = np.ones(columns[0].shape, bool) if converged is None else np.asarray(converged, bool)
    whole = bool(good.all()) and bool(good.size)
    delta, load, radius = (column[good] for column in columns)
    numbers = np.flatnonzero(good) + 1
    in_contact = radius > 0
    summary = {
        **_pull_off(delta, load, radius, numbers),
        **_change("detach", delta, load, in_contact, numbers),
        **_change("jump_in", delta, load, in_contact, numbers),
    }
    if whole:
        changes = np.diff(in_contact)
        work = float(np.sum((load[1:] + load[:-1]) / 2 * np.diff(delta)))
        jumps = np.abs(np.diff(load) * np.diff(delta))[changes]
        summary |= {"work": work, "work_accuracy": float(jumps.sum()) / 2}
        if energy is not None:
            ends = np.asarray(energy, dtype=float)
            summary["dissipated_energy"] = work - float(ends[-1] - ends[0])
    if force_error is not None and "pull_off" in summary:
        step = int(summary["pull_off_step"]) - 1
        summary["pull_off_accuracy"] = float(np.asarray(force_error, dtype=float)[step])
    return PathSummary(**summary)


def _pull_off(
    depth: Array, force: Array, radius: Array, numbers: NDArray[np.int64]
) -> dict[str, float]:
    """Return the lowest force of all retractions, unless the path ends or turns there."""
    retracted = [
        step
        for leg in legs(depth)
        if leg.direction == "retraction"
        for step in range(leg.steps.start, leg.steps.stop)
    ]
    if not retracted:
        return {}
    lowest = retracted[int(np.argmin(force[retracted]))]
    beyond = np.flatnonzero(depth[lowest:] != depth[lowest])
    goes_on = beyond.size > 0 and depth[lowest + beyond[0]] < depth[lowest]
    if force[lowest] >= 0 or not goes_on:
        return {}
    return {
        "pull_off": float(force[lowest]),
        "pull_off_depth": float(depth[lowest]),
        "pull_off_radius": float(radius[lowest]),
        "pull_off_step": float(numbers[lowest]),
    }


def _change(
    name: str, depth: Array, force: Array, contact: Mask, numbers: NDArray[np.int64]
) -> dict[str, float]:
    """Return depth, force, step and accuracy of the first loss or gain of contact."""
    lost = name == "detach"
    changes = np.flatnonzero((contact[:-1] == lost) & (contact[1:] != lost))
    if not changes.size:
        return {}
    before = int(changes[0])
    step = before if lost else before + 1
    return {
        name: float(depth[step]),
        f"{name}_force": float(force[step]),
        f"{name}_step": float(numbers[step]),
        f"{name}_accuracy": float(abs(depth[before + 1] - depth[before])),
    }
