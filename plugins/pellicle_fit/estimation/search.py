"""Searches for the least χ² from many starts at once (Levenberg 1944; Marquardt 1963)."""

from __future__ import annotations

from enum import Enum
from typing import Any, NamedTuple, Protocol

import numpy as np

from pellicle.arrays import Array, Mask

_MOST, _TRIES = 80, 3
"""Most steps of a search, and trials of the damping of one."""
_DAMPING, _ROUGHLY = 1e-5, 1e-3
"""Damping of the first step, of a search to the end and of a rough one."""
_LEAST, _LARGEST, _SHORT = 1e-9, 1e6, 1e-7
"""Least and largest damping, and the one below which a step is undamped."""
_EASED, _STIFFENED = 0.1, 4.0
"""Least factor of the damping after a step that gains, and the factor after one that does not."""
_HOPE = 2.0
"""How much more than an undamped step a search may gain, where χ² bends."""
_STALLED = 4
"""Steps that have to gain as many falls."""
_FALL, _ROUGH_FALL = 1e-5, 3e-2
"""Fall of χ² that is left at the end of a search, to the end and rough."""
_SHARE, _ROUGH_SHARE = 1e-10, 1e-4
"""The same over χ²."""


class Ending(Enum):
    """How a search ended."""

    CONVERGED = "no step would gain more"
    GIVEN_UP = "it was not going to come below its goal"
    STALLED = "its steps gained next to nothing, as in a valley without end"
    OUT_OF_STEPS = "it took as many steps as it may"
    UNBALANCED = "forces do not balance where it began"
    LOW_ENOUGH = "its χ² was as low as it had to be"


class Minimum(NamedTuple):
    """A minimum of χ²."""

    at: Array
    """Coordinates."""
    squares: tuple[float, ...]
    """χ² of each curve, then of each term of what is weighed.

    Their sum is an upper bound where the search did not converge.
    """
    ending: Ending = Ending.CONVERGED

    @property
    def chi_squared(self) -> float:
        """χ²."""
        return sum(self.squares)


class LeastSquares(Protocol):
    """Terms whose squares are summed, as functions of coordinates of shape (k, coordinates)."""

    @property
    def limits(self) -> Array:
        """Least and greatest coordinates, of shape (2, coordinates)."""

    def trials(self, at: Array) -> Any:
        """Return trials of coordinates."""

    def derivatives(self, at: Array, trials: Any) -> Array:
        """Return the derivatives of the terms of trials, of shape (k, coordinates, terms)."""

    def squares(self, terms: Array) -> tuple[float, ...]:
        """Return sums of the squares of terms."""


def descend(
    problem: LeastSquares,
    starts: Array,
    held: Mask | None = None,
    *,
    steps: int = 0,
    goal: float = np.inf,
    fall: float = _FALL,
    rivals: bool = False,
    enough: float = 0.0,
) -> list[Minimum]:
    """Return the minima of χ² near k starts, where coordinates that are ``held`` stay.

    With a number of ``steps``, roughly.  A search ends where a step without damping, which a valley
    does not hide, would gain less than a ``fall``; one that is not going to come below a ``goal``
    is given up, as is one of ``rivals`` not below the best, and one below ``enough`` is done.  The
    limits are kept by projection.
    """
    held = np.zeros(starts.shape, dtype=bool) if held is None else held
    low, high = problem.limits
    at = np.where(held, starts, np.clip(starts, low, high))
    fall, share = (_ROUGH_FALL, _ROUGH_SHARE) if steps else (fall, _SHARE)
    trials = problem.trials(at)
    cost = cost_of(trials.terms)
    damping, eye = np.full(len(at), _ROUGHLY if steps else _DAMPING), np.eye(at.shape[1])
    left = np.flatnonzero(np.isfinite(cost) & ~held.all(axis=1))
    past: list[Array] = []
    endings = np.full(len(at), Ending.CONVERGED, dtype=object)
    endings[left] = Ending.OUT_OF_STEPS
    endings[~np.isfinite(cost)] = Ending.UNBALANCED
    for number in range(steps or _MOST):
        if not left.size:
            break
        here, now = at[left], trials.of(left)
        new = problem.derivatives(here, now)
        gradient = (new @ now.terms[:, :, None])[:, :, 0]
        normal = new @ new.transpose(0, 2, 1)
        at_limit = ((here <= low) & (gradient > 0)) | ((here >= high) & (gradient < 0))
        stuck = held[left] | at_limit
        size = np.diagonal(normal, axis1=1, axis2=2)
        # What is stuck has neither a gradient nor a share in the others' steps.
        scale = np.where(stuck | (size <= 0), 0.0, 1 / np.sqrt(np.maximum(size, 1e-300)))
        normal = normal * scale[:, :, None] * scale[:, None, :] + eye * (scale == 0)[:, :, None]
        steep = scale * gradient
        most = np.sum(steep * _solved(normal + _LEAST * eye, steep), axis=1)
        going = np.arange(left.size)
        ended = np.zeros(left.size, dtype=bool)
        for _ in range(_TRIES):
            rows = left[going]
            move = -_solved(normal[going] + damping[rows, None, None] * eye, steep[going])
            to = np.clip(at[rows] + scale[going] * move, low, high)
            to = np.where(held[rows], at[rows], to)
            others = problem.trials(to)
            cost_there = cost_of(others.terms)
            gain = cost[rows] - cost_there
            better = gain > 0
            taken = np.flatnonzero(better)
            at[rows[taken]], cost[rows[taken]] = to[taken], cost_there[taken]
            trials.put(rows[taken], others.of(taken))
            # Nielsen's rule: a step that gains what was foretold is followed by a longer one.
            foretold = -np.sum(move * steep[going], axis=1)
            foretold += damping[rows] * np.sum(move**2, axis=1)
            ratio = np.clip(gain / np.maximum(foretold, 1e-300), 0.0, 1.0)
            factor = np.where(better, np.maximum(_EASED, 1 - (2 * ratio - 1) ** 3), _STIFFENED)
            damping[rows] = np.maximum(factor * damping[rows], _LEAST)
            little = share * cost[rows] + fall
            ends = (most[going] <= little) | (damping[rows] > _LARGEST)
            ends |= better & (gain <= little) & (damping[rows] <= _SHORT)
            endings[rows[ends]] = Ending.CONVERGED
            if number > 0 or rivals:
                least = min(goal, float(cost.min())) if rivals else goal
                hopeless = ~ends & (cost[rows] - _HOPE * np.maximum(most[going], gain) > least)
                endings[rows[hopeless]] = Ending.GIVEN_UP
                ends |= hopeless
            ended[going[ends]] = True
            going = going[~better & ~ends]
            if not going.size:
                break
        low_enough = cost[left] < enough
        endings[left[low_enough]] = Ending.LOW_ENOUGH
        ended |= low_enough
        past.append(cost.copy())
        if number >= _STALLED:
            stalled = ~ended & (past[number - _STALLED][left] - cost[left] < _STALLED * fall)
            endings[left[stalled]] = Ending.STALLED
            ended |= stalled
        left = left[~ended]
    squares = map(problem.squares, trials.terms)
    return [Minimum(*of) for of in zip(at, squares, endings, strict=True)]


def _solved(matrices: Array, sides: Array) -> Array:
    return np.asarray(np.linalg.solve(matrices, sides[:, :, None])[:, :, 0])


def cost_of(terms: Array) -> Array:
    """Return χ² of trials, infinite where forces do not balance."""
    cost = np.einsum("kn,kn->k", terms, terms)
    return np.where(np.isfinite(cost), cost, np.inf)
