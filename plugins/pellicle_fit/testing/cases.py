"""Cases of the kit of effects: clean curves, and what a known effect makes of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import Any, NamedTuple, cast

import numpy as np

import pellicle as pl
from pellicle.arrays import Array
from pellicle.units import quantity_of
from pellicle_fit.contact.contact import Contact
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Adds, Bends, Effect, Records, Responds, Sizes, Solid, Yields
from pellicle_fit.explanation import Explanation

_MODULUS, STIFFNESS, _SPEED = 2e3, 0.05, 1e-6
DEPTHS = np.linspace(-0.5e-6, 1e-6, 61)
_ROUNDING = 2e-5
"""Difference of forces that is none, over the largest, as that of tables."""


class Case(NamedTuple):
    """An effect of known quantities on a curve."""

    effect: Effect
    curve: Curve
    modulus: float = _MODULUS
    """That at the end of the loading [Pa], as fits count it."""

    @property
    def contact(self) -> Contact:
        """The contact of the indenter on a half-space."""
        return replace(self.curve.contact, modulus=self.modulus)

    def force(self, *effects: Effect, contact_point: float = 0.0) -> Array:
        """Return the force [N] that is recorded with some effects."""
        time = self.curve.time_in_contact(contact_point)
        relaxed = Explanation(Solid(), effects).relaxed(time)
        solid = Solid(reduced_modulus=self.modulus / relaxed, contact_point=contact_point)
        return Explanation(solid, effects).force(self.curve)

    def scaled(self, length: float, force: float, time: float) -> Case:
        """Return the case with lengths, forces and times times factors, and so all quantities."""
        factor, update = Sizes(length, force, time, 0).of, {}
        curve, body = self.curve, cast("Any", self.curve.indenter)
        for name, info in type(self.effect).model_fields.items():
            quantity, value = quantity_of(info), getattr(self.effect, name)
            if quantity is not None and value is not None:
                update[name] = value * factor(quantity.unit)
        if radius := getattr(body, "radius", None):
            body = pl.indenter("paraboloid", radius=length * radius)
        curve = replace(
            curve,
            position=length * curve.position,
            force=force * curve.force,
            indenter=body,
            time=time * curve.clock,
            stiffness=STIFFNESS * factor("N/m"),
        )
        effect = self.effect.model_copy(update=update)
        return Case(effect, curve, self.modulus * factor("Pa"))

    def given(self, rows: Array) -> Array:
        """Return what the effect itself makes of depths [m] or, of an instrument, forces [N]."""
        rows, effect, curve = rows.view(), self.effect, self.curve
        rows.flags.writeable = False
        match effect:
            case Bends():
                return effect.contact(self.contact).force(rows)
            case Responds():
                return effect.response(self.contact, curve, curve.position, 1 / STIFFNESS)(rows)
            case Adds():
                return effect.force(self.contact, curve, rows)
            case Yields():
                return effect.give(rows)
        assert isinstance(effect, Records)
        return effect.recorded(rows, curve)

    @property
    def rows(self) -> Array:
        """Depths [m] of the rows; forces [N] of what yields or is the instrument's."""
        is_force = isinstance(self.effect, (Yields, Records))
        return self.curve.force if is_force else self.curve.position

    @property
    def force_tolerance(self) -> float:
        """Difference of forces that is none [N]."""
        known = Explanation(Solid(reduced_modulus=self.modulus, contact_point=0.0), (self.effect,))
        return max(_ROUNDING, 3 * known.accuracy(self.curve)) * self.curve.largest


def curves() -> Iterator[tuple[str, Curve]]:
    """Yield clean curves, whose base moves at a constant speed."""
    bead, cone = pl.indenter("paraboloid", radius=5e-6), pl.indenter("cone", half_angle=1.2)
    bodies: dict[str, Any] = {"a round tip": bead, "a cone": cone}
    passes = {"the approach": DEPTHS, "both passes": np.append(DEPTHS, DEPTHS[-2::-1])}
    for (tip, body), (words, depth) in product(bodies.items(), passes.items()):
        force = Contact.on_half_space(body, _MODULUS, 2 * float(np.ptp(depth))).force(depth)
        way = np.abs(np.diff(depth + force / STIFFNESS, prepend=depth[0]))
        curve = Curve(depth, force, body, np.cumsum(way) / _SPEED, stiffness=STIFFNESS)
        for array in (depth, force, curve.clock, curve.base, curve.smooth_force, curve.velocity):
            array.flags.writeable = False
        yield f"{words} of {tip}", curve
