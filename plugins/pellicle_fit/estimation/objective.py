"""χ² of one or more curves under an explanation, as a function of its open quantities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle import registry
from pellicle.arrays import Array
from pellicle_fit.dynamic import misfits
from pellicle_fit.effect import Records, Responds, Weighed
from pellicle_fit.explanation import Balance, columns_are_rows

from .coordinates import CONTACT_POINT, Coordinates, Slot
from .long_memory import fractional_differences
from .search import Minimum, descend

_STEP = 1e-6
"""Step of derivatives by differences, in coordinates of the order of 1."""


class Trials(NamedTuple):
    """Trials of coordinates of shape (k, coordinates)."""

    terms: Array
    """(recorded − measured)/noise of all curves, then the terms of what is weighed, (k, terms).

    These are those of quantities that are given with a deviation, and of sines.

    NaN where forces do not balance.
    """
    balances: tuple[Balance, ...]
    """Forces and depths of each curve, of shape (k, n)."""

    def of(self, rows: NDArray[Any]) -> Trials:
        """Return some of the trials."""
        balances = (Balance(*(part[rows] for part in balance)) for balance in self.balances)
        return Trials(self.terms[rows], tuple(balances))

    def put(self, rows: NDArray[Any], others: Trials) -> None:
        """Put others in the places of some."""
        self.terms[rows] = others.terms
        for mine, other in zip(self.balances, others.balances, strict=True):
            for part, new in zip(mine, other, strict=True):
                part[rows] = new


def _of_shape(part: Array, shape: tuple[int, int]) -> Array:
    return part if part.shape == shape else np.array(np.broadcast_to(part, shape))


@dataclass(frozen=True, eq=False)
class Objective(Coordinates):
    """χ² = Σ (recorded − measured)²/noise², and a term for each quantity that is weighed."""

    noise: tuple[float, ...]
    """Standard deviation of the force of each curve [N]."""
    memory: tuple[float, ...] = ()
    """Exponent d of each curve whose noise has a power that falls as f^(−2d); 0 or none if white.

    The noise is then that of fractional differences.
    """

    def forces(self, at: Array) -> list[Array]:
        """Return the force [N] of each curve that the explanation records."""
        return [self.known(at, i).force(curve) for i, curve in enumerate(self.curves)]

    def trials(self, at: Array) -> Trials:
        """Return trials of coordinates of shape (k, coordinates)."""
        terms, balances = [], []
        for i, curve in enumerate(self.curves):
            shape = (len(at), curve.force.size)
            balance_of_curve = self.known(at, i).balance(curve, together=self.takes_columns)
            balance = Balance(*(_of_shape(part, shape) for part in balance_of_curve))
            terms.append(self._term(balance.recorded - curve.force, i))
            balances.append(balance)
        for k, slot, weighed in self._weighed:
            values = np.array([slot.value(coordinate) for coordinate in at[:, k]])
            terms.append((values[:, None] - weighed) / weighed.deviation)
        terms.append(self._of_sines(at))
        return Trials(np.concatenate(terms, axis=1), tuple(balances))

    def _term(self, difference: Array, i: int) -> Array:
        """Return differences of the forces of a curve [N], of shape (k, n), over its noise."""
        term = self.curves[i].weights * difference / self.noise[i]
        if self.memory and self.memory[i]:
            term = fractional_differences(term.T, self.memory[i]).T
        return np.asarray(term)

    def _of_sines(self, at: Array) -> Array:
        """Return terms of sines of all curves, two of each, of shape (k, terms)."""
        terms = [np.empty((len(at), 0))]
        for i, curve in enumerate(self.curves):
            if not curve.sines:
                continue
            if self.takes_columns:
                own = misfits(self.known(at, i), curve)
            else:
                own = np.array([misfits(self.known(row, i), curve) for row in at])
            off = np.broadcast_to(own, (len(at), len(curve.sines)))
            terms += [off.real, off.imag]
        return np.concatenate(terms, axis=1)

    @cached_property
    def _weighed(self) -> list[tuple[int, Slot, Weighed]]:
        """Coordinates of what is weighed, and its values."""
        parts = self.explanation.parts
        inputs = [(k, s, getattr(parts[s.part], s.name)) for k, s in enumerate(self.slots)]
        return [entry for entry in inputs if isinstance(entry[2], Weighed)]

    def derivatives(self, at: Array, trials: Trials) -> Array:
        """Return the derivatives of the terms of trials, of shape (k, coordinates, terms)."""
        slopes = np.zeros((*at.shape, trials.terms.shape[1]))
        steps = np.where(at + _STEP <= self.limits[1], _STEP, -_STEP)
        end = 0
        for i, (curve, balance) in enumerate(zip(self.curves, trials.balances, strict=True)):
            of_instrument, touches, others = self._kinds[i]
            begin, end = end, end + curve.force.size
            for some in filter(None, (of_instrument, others)):
                moved = np.repeat(at, len(some), axis=0)
                step = steps[:, some].ravel()
                moved[np.arange(step.size), np.tile(some, len(at))] += step
                near = Balance(*(np.repeat(part, len(some), axis=0) for part in balance))
                known = self.known(moved, i)
                if some is of_instrument:
                    forces = known.recorded(near.force, curve)
                else:
                    forces = known.beside(curve, near, together=self.takes_columns)
                rates = self._term((forces - near.recorded) / step[:, None], i)
                slopes[:, some, begin:end] = rates.reshape(len(at), len(some), -1)
            if touches:
                shift = _STEP * self.slots[touches[0]].scale
                forces = self.known(at, i).recorded(balance.force - shift * balance.rate, curve)
                slopes[:, touches[0], begin:end] = self._term(
                    (forces - balance.recorded) / _STEP, i
                )
        for number, (k, slot, weighed) in enumerate(self._weighed):
            move = [slot.value(x + _STEP) - slot.value(x - _STEP) for x in at[:, k]]
            slopes[:, k, end + number] = np.array(move) / (2 * _STEP * weighed.deviation)
        if any(curve.sines for curve in self.curves):
            here, end = self._of_sines(at), end + len(self._weighed)
            for k in range(at.shape[1]):
                moved = at + steps[:, [k]] * np.eye(at.shape[1])[k]
                slopes[:, k, end:] = (self._of_sines(moved) - here) / steps[:, [k]]
        return slopes

    @cached_property
    def takes_columns(self) -> bool:
        """Whether trials are computed together; where an effect is a stranger's, that is tried."""
        own = registry().own.issuperset(map(type, self.explanation.effects))
        return own or columns_are_rows(self.explanation, self.curves[0])

    @cached_property
    def _kinds(self) -> list[tuple[list[int], list[int], list[int]]]:
        """Coordinates of each curve: of its instrument, of its contact point, and all others.

        The former move what is recorded and no balance; a contact point moves depths of the base
        and nothing else.
        """
        kinds_of_curves = []
        responds, together = self.explanation.of(Responds), self.takes_columns
        # What is recorded of a path without a load is in the path that a memory sees.
        remembers = any(not effect.balances for effect in responds)
        for curve, acting in zip(self.curves, self._acting, strict=True):
            kinds: tuple[list[int], list[int], list[int]] = [], [], []
            for k in acting:
                part = self.explanation.parts[self.slots[k].part]
                alone = isinstance(part, Records) and type(part).stiffness is Records.stiffness
                bound = curve.stiffness is not None and (remembers or curve.touch is not None)
                is_record = alone and not bound
                is_touch = self.slots[k].name == CONTACT_POINT and not responds
                kinds[0 if together and is_record else 1 if together and is_touch else 2].append(k)
            kinds_of_curves.append(kinds)
        return kinds_of_curves

    def terms(self, at: Array) -> Array:
        """Return the terms of coordinates; if forces do not balance, it is a ConvergenceError."""
        (terms,) = self.trials(np.asarray(at)[None]).terms
        if not np.isfinite(terms).all():
            self.forces(at)
        return np.asarray(terms)

    def squares(self, terms: Array) -> tuple[float, ...]:
        """Return χ² of each curve, then of each term of what is weighed."""
        ends = np.cumsum([curve.force.size for curve in self.curves])
        parts = np.split(terms, [*ends, *range(ends[-1] + 1, terms.size)])
        return tuple(float(part @ part) for part in parts if part.size)

    def chi_squared(self, at: Array) -> float:
        """Return χ²."""
        return float(np.sum(self.terms(at) ** 2))

    def criterion(self, chi_squared: float) -> float:
        """Return Akaike's criterion, less a constant of the curves."""
        effects = self.explanation.effects
        searched = sum(effect.searched(curve) for effect in effects for curve in self.curves)
        return chi_squared + 2 * (len(self.slots) + searched)

    def jacobian(self, at: Array, free: Sequence[int]) -> Array:
        """Return the derivatives of the terms by some coordinates, of shape (terms, free)."""
        at = np.asarray(at)[None]
        return np.asarray(self.derivatives(at, self.trials(at))[0][[*free]].T)

    def deviations(self, at: Array) -> Array:
        """Return the Cramér–Rao bound of each coordinate; infinite if it is not determined."""
        jacobian = self.jacobian(at, range(at.size))
        variances = np.diag(np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-14))
        return np.where(variances > 0, np.sqrt(np.abs(variances)), np.inf)

    @cached_property
    def coarse(self) -> Objective:
        """χ² of a few means, unless no mean stands for rows."""
        if any(self.memory) or any(effect.jumps for effect in self.explanation.effects):
            return self
        return replace(self, curves=tuple(curve.coarse for curve in self.curves))

    def minimise(self, start: Array, held: Sequence[int] = (), *, steps: int = 0) -> Minimum:
        """Return the minimum of χ² near a start, where the coordinates ``held`` stay.

        With a number of ``steps``, roughly.  If forces do not balance there, it is a
        ConvergenceError.
        """
        stays = np.isin(np.arange(len(self.slots)), [*held])
        (minimum,) = descend(self, np.asarray(start, dtype=float)[None], stays[None], steps=steps)
        if not np.isfinite(minimum.chi_squared):
            self.forces(minimum.at)
        return minimum
