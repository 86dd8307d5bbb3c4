"""Coordinates of a search: the open quantities of an explanation of curves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle_fit.contact.curve import BEFORE, Curve
from pellicle_fit.effect import Fitted, Responds, Sizes
from pellicle_fit.explanation import Explanation

_DECADES = 6.0
"""How far a logarithm may go from the size of its quantity."""
MODULUS: Final = "reduced_modulus"
CONTACT_POINT: Final = "contact_point"


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


@dataclass(frozen=True, eq=False)
class Coordinates:
    """Open quantities of an explanation, in orders of magnitude of the curves.

    The modulus is the one at the end of the loading, which explanations with and without relaxation
    share, and not E* of the law of relaxation.
    """

    explanation: Explanation
    curves: tuple[Curve, ...]
    sizes: Sizes
    """Orders of magnitude, in which coordinates are counted."""
    loading_time: float
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
                low = float(curve.position.min() + bent.min() - BEFORE * curve.span)
                high = float(curve.position.max() + bent.max())
            elif q.log:
                low, high = slot.scale / reach, slot.scale * reach
            low, high = known.get(slot.name, (low, high))
            ends.append((slot.coordinate(low), slot.coordinate(high)))
        return np.array(ends).reshape(-1, 2).T

    def within(self, at: Array) -> list[int]:
        """Return the coordinates that are at none of their limits, which a fit could use."""
        low, high = self.limits
        return np.flatnonzero((at > low) & (at < high)).tolist()

    def acts(self, slot: Slot, curve: int) -> bool:
        """Return whether a coordinate is of a curve."""
        owner = self.beads[curve] if slot.quantity.scope == "indenter" else curve
        return slot.curve in (None, owner)

    @cached_property
    def _scales(self) -> tuple[NDArray[np.intp], Array]:
        """Which coordinates are logarithms, and all scales."""
        logs = np.flatnonzero([slot.quantity.log for slot in self.slots])
        return logs, np.array([slot.scale for slot in self.slots])

    @cached_property
    def _acting(self) -> list[list[int]]:
        """The coordinates of each curve."""
        slots = [*enumerate(self.slots)]
        return [[k for k, s in slots if self.acts(s, i)] for i in range(len(self.curves))]

    def known(self, at: Array, curve: int) -> Explanation:
        """Return the explanation of a curve with values of its open quantities.

        Of coordinates of shape (k, coordinates) they are columns of shape (k, 1).
        """
        logs, scales = self._scales
        numbers = at * scales
        if logs.size:
            numbers[..., logs] = np.exp(at[..., logs]) * scales[logs]
        of = numbers.T[:, :, None] if at.ndim > 1 else numbers.tolist()
        values: list[dict[str, Any]] = [{} for _ in self.explanation.parts]
        for k in self._acting[curve]:
            values[self.slots[k].part][self.slots[k].name] = of[k]
        pairs = zip(self.explanation.effects, values[1:], strict=True)
        effects = tuple(effect.of_values(known) if known else effect for effect, known in pairs)
        for effect in effects if MODULUS in values[0] else ():
            if isinstance(effect, Responds):
                values[0][MODULUS] = values[0][MODULUS] / effect.relaxed(self.loading_time)
        return Explanation(self.explanation.solid.of_values(values[0]), effects)

    def values(self, at: Array) -> dict[tuple[str, int | None], float]:
        """Return values in SI by name, and curve of what is not shared."""
        pairs = zip(self.slots, at, strict=True)
        return {(slot.name, slot.curve): slot.value(c) for slot, c in pairs}

    def at_values(self, known: dict[tuple[str, int | None], float]) -> Array:
        """Return coordinates of values, such as those of another explanation; NaN where unknown."""
        values = [known.get((slot.name, slot.curve), np.nan) for slot in self.slots]
        return np.array([s.coordinate(v) for s, v in zip(self.slots, values, strict=True)])
