"""χ² of one or more curves under an explanation, as a function of its open quantities."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from pellicle.arrays import Array

from .curve import Curve
from .effect import Fitted, Sizes, Weighed
from .explanation import Explanation
from .long_memory import differenced

_STEP = 1e-6
"""Step of derivatives by differences, in coordinates of the order of 1."""
_SEARCHES = (("dogbox", 12), ("trf", 400))
"""Optimisers in the order in which they are tried, and their largest numbers of steps."""
_TOLERANCE, _ROUGHLY = 1e-8, 1e-4
ROUGH = 20
"""Steps of a search that tells whether a start is worth another."""
_HALVING = ((4, 2), (16, 1))
"""Steps from all starts that are left, and how many of the best are kept."""
_BEFORE = 1.0
"""How far before the first row a contact may lie, over the range of positions."""
_DECADES = 6.0
"""How far a logarithm may go from the size of its quantity."""
MODULUS, CONTACT_POINT = "reduced_modulus", "contact_point"


class Slot(NamedTuple):
    """A coordinate of a search: an open quantity, of one curve unless it is shared."""

    name: str
    part: int
    """Which part of the explanation has it: 0 the solid, then the effects."""
    curve: int | None
    """The first curve that it belongs to; None if all share it."""
    quantity: Fitted
    scale: float
    """What a coordinate of 1 stands for, or a logarithm of 0, in SI."""

    @property
    def full_name(self) -> str:
        """The name, of further curves with their number."""
        return f"{self.name}_{self.curve}" if self.curve else self.name

    def value(self, coordinate: float) -> float:
        """Return the value in SI."""
        return float(np.exp(coordinate) if self.quantity.log else coordinate) * self.scale

    def coordinate(self, value: float) -> float:
        """Return the coordinate of a value in SI."""
        if self.quantity.log:
            return float(np.log(max(value, 1e-300) / self.scale))
        return value / self.scale


class Minimum(NamedTuple):
    """A minimum of χ²."""

    at: Array
    """Coordinates."""
    chi_squared: float
    """An upper bound of it where the search did not end, in a valley without end."""


@dataclass(frozen=True, eq=False)
class Objective:
    """χ² = Σ (recorded − measured)²/noise², and a term for each quantity that is weighed.

    The modulus that it varies is the one at the end of the loading, which explanations with and
    without relaxation share, and not E* of the law of relaxation.
    """

    explanation: Explanation
    curves: tuple[Curve, ...]
    noise: tuple[float, ...]
    """Standard deviation of the force of each curve [N]."""
    sizes: Sizes
    """Orders of magnitude, in which coordinates are counted."""
    memory: tuple[float, ...] = ()
    """Exponent d of each curve whose noise has a power that falls as f^(−2d); 0 or none if white.

    The noise is then that of fractional differences.
    """
    loading_time: float = 1.0
    """Time from first touch to the end of the loading [s]."""

    @cached_property
    def slots(self) -> tuple[Slot, ...]:
        """The coordinates, in order."""
        owners = {"all": [None], "curve": range(len(self.curves)), "indenter": {*self.beads}}
        return tuple(
            Slot(name, part, curve, quantity, self.sizes.of(quantity.unit))
            for part, component in enumerate(self.explanation.parts)
            for name, quantity in component.open.items()
            for curve in owners[quantity.scope]
        )

    @cached_property
    def beads(self) -> list[int]:
        """The first curve with the indenter of each curve."""
        indenters = [curve.indenter for curve in self.curves]
        return [indenters.index(indenter) for indenter in indenters]

    def index(self, name: str) -> int | None:
        """Return the number of the first coordinate of a quantity; None if it is not open."""
        return next((k for k, slot in enumerate(self.slots) if slot.name == name), None)

    @cached_property
    def limits(self) -> Array:
        """Least and greatest coordinates, of shape (2, coordinates)."""
        known: dict[str, tuple[float, float]] = {}
        for effect in self.explanation.effects:
            known |= effect.limits(self.sizes)
        ends = []
        for slot in self.slots:
            q, reach = slot.quantity, 10**_DECADES
            low = next((end for end in (q.at_least, q.above) if end is not None), -np.inf)
            high = next((end for end in (q.at_most, q.below) if end is not None), np.inf)
            if slot.name == CONTACT_POINT and slot.curve is not None:
                curve = self.curves[slot.curve]
                # A free cantilever may be bent, if the force before contact is one.
                bent = np.array([0.0, curve.shallow_force / (curve.stiffness or np.inf)])
                low = float(curve.position.min() + bent.min() - _BEFORE * curve.span)
                high = float(curve.position.max() + bent.max())
            elif q.log:
                low, high = slot.scale / reach, slot.scale * reach
            low, high = known.get(slot.name, (low, high))
            ends.append((slot.coordinate(low), slot.coordinate(high)))
        return np.array(ends).reshape(-1, 2).T

    def acts(self, slot: Slot, curve: int) -> bool:
        """Return whether a coordinate is of a curve."""
        owner = self.beads[curve] if slot.quantity.scope == "indenter" else curve
        return slot.curve in (None, owner)

    def known(self, at: Array, curve: int) -> Explanation:
        """Return the explanation of a curve with values of its open quantities."""
        values: list[dict[str, float]] = [{} for _ in self.explanation.parts]
        for slot, coordinate in zip(self.slots, at, strict=True):
            if self.acts(slot, curve):
                values[slot.part][slot.name] = slot.value(coordinate)
        pairs = zip(self.explanation.effects, values[1:], strict=True)
        effects = tuple(effect.at(known) for effect, known in pairs)
        known = Explanation(self.explanation.solid, effects)
        if MODULUS in values[0]:
            values[0][MODULUS] /= known.relaxed(self.loading_time)
        return Explanation(known.solid.at(values[0]), effects)

    def forces(self, at: Array) -> list[Array]:
        """Return the force [N] of each curve that the explanation records."""
        return [self.known(at, i).force(curve) for i, curve in enumerate(self.curves)]

    def terms(self, at: Array, known: Mapping[int, Array] | None = None) -> list[Array]:
        """Return (recorded − measured)/noise of each curve, and the terms of what is weighed.

        Of some curves they may be known.
        """
        terms = []
        for i, (curve, noise) in enumerate(zip(self.curves, self.noise, strict=True)):
            if (term := (known or {}).get(i)) is None:
                force = self.known(at, i).force(curve)
                term = curve.weights * (force - curve.force) / noise
                if self.memory and self.memory[i]:
                    term = differenced(term, self.memory[i])
            terms.append(term)
        for slot, coordinate in zip(self.slots, at, strict=True):
            given = getattr(self.explanation.parts[slot.part], slot.name)
            if isinstance(given, Weighed):
                terms.append(np.array([(slot.value(coordinate) - given) / given.deviation]))
        return terms

    def chi_squared(self, at: Array) -> float:
        """Return χ²."""
        return float(np.sum(np.concatenate(self.terms(at)) ** 2))

    def criterion(self, chi_squared: float) -> float:
        """Return Akaike's criterion, less a constant of the curves."""
        effects = self.explanation.effects
        searched = sum(effect.searched(curve) for effect in effects for curve in self.curves)
        return chi_squared + 2 * (len(self.slots) + searched)

    def jacobian(self, at: Array, free: Sequence[int], here: list[Array] | None = None) -> Array:
        """Return the derivatives of the residuals by some coordinates, from differences.

        ``here`` are the terms at the coordinates, where they are known.
        """
        here, columns = here or self.terms(at), []
        for k in free:
            step = _STEP if at[k] + _STEP <= self.limits[1][k] else -_STEP
            moved = at.copy()
            moved[k] += step
            # A quantity of one curve leaves the others as they are.
            same = {i: here[i] for i in range(len(self.curves)) if not self.acts(self.slots[k], i)}
            change = np.concatenate(self.terms(moved, same)) - np.concatenate(here)
            columns.append(change / step)
        return np.column_stack(columns)

    def deviations(self, at: Array) -> Array:
        """Return the Cramér–Rao bound of each coordinate; infinite if it is not determined."""
        jacobian = self.jacobian(at, range(at.size))
        variances = np.diag(np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-14))
        return np.where(variances > 0, np.sqrt(np.abs(variances)), np.inf)

    def minimise(self, start: Array, held: Sequence[int] = (), *, steps: int = 0) -> Minimum:
        """Return the minimum of χ² near a start, where the coordinates ``held`` stay.

        With a number of ``steps``, roughly.
        """
        free = [k for k in range(len(self.slots)) if k not in held]
        low, high = (ends[free] for ends in self.limits)

        def full(some: Array) -> Array:
            at = np.array(start, dtype=float)
            at[free] = some
            return at

        at = np.clip(np.asarray(start, dtype=float)[free], low, high)
        if not free:
            return Minimum(full(at), self.chi_squared(full(at)))
        # Derivatives are asked for where the residuals were last.
        terms = lru_cache(maxsize=1)(lambda some: self.terms(full(np.frombuffer(some))))
        tolerance = _ROUGHLY if steps else _TOLERANCE
        # Away from the limits the latter is quicker.
        for method, most in ((_SEARCHES[-1][0], steps),) if steps else _SEARCHES:
            found = least_squares(
                lambda some: np.concatenate(terms(some.tobytes())),
                at,
                lambda some: self.jacobian(full(some), free, terms(some.tobytes())),
                (low, high),
                method=method,
                max_nfev=most,
                xtol=tolerance,
                ftol=tolerance,
                gtol=tolerance,
            )
            at = found.x
            if found.success:
                break
        return Minimum(full(at), 2 * float(found.cost))

    def best(
        self, starts: Iterable[Array], idle: tuple[float, float] = (np.inf, np.inf)
    ) -> Minimum:
        """Return the least minimum from several starts: few steps of all, more of the best.

        One whose χ² is then in an ``idle`` range is not sought to the end.
        """
        left = list(starts)
        for steps, kept in _HALVING:
            minima = [self.minimise(start, steps=steps) for start in left]
            minima.sort(key=lambda minimum: minimum.chi_squared)
            left = [minimum.at for minimum in minima[:kept]]
        low, high = idle
        return minima[0] if low < minima[0].chi_squared < high else self.minimise(left[0])

    def values(self, at: Array) -> dict[tuple[str, int | None], float]:
        """Return values in SI by name, and curve of what is not shared."""
        pairs = zip(self.slots, at, strict=True)
        return {(slot.name, slot.curve): slot.value(c) for slot, c in pairs}

    def at_values(self, known: dict[tuple[str, int | None], float]) -> Array:
        """Return coordinates of values, such as those of another explanation; NaN where unknown."""
        values = [known.get((slot.name, slot.curve), np.nan) for slot in self.slots]
        return np.array([s.coordinate(v) for s, v in zip(self.slots, values, strict=True)])
