"""What explains a curve: an elastic half-space and a set of effects, and its force."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any, NamedTuple, TypeVar

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConvergenceError

from .balance import DIFFERENCE, balance_depths
from .contact.contact import Contact, HasModulus
from .contact.curve import Curve
from .effect import (
    Adds,
    Bends,
    Effect,
    Records,
    Responds,
    Response,
    Sizes,
    Solid,
    Yields,
    quantities,
)

_Kind = TypeVar("_Kind", bound=Effect)
_ROUNDING = 1e-6
"""Difference of forces that is none, over the largest."""
_LEAST = 0.05
"""Least depth from which a balance is sought, over that of the base."""


class Balance(NamedTuple):
    """Forces and depths of a curve, of shape (n,), or (k, n) of k trials."""

    recorded: Array
    """Recorded force [N]."""
    force: Array
    """True force [N]."""
    depth: Array
    """Depth of the solid [m]."""
    rate: Array
    """Derivative of the true force by the depth of the base [N/m]."""


@dataclass(frozen=True)
class Explanation:
    """A solid and a set of effects, one of each type, with open quantities."""

    solid: Solid
    effects: tuple[Effect, ...] = ()

    @property
    def parts(self) -> tuple[Solid | Effect, ...]:
        """The components that have quantities."""
        return (self.solid, *self.effects)

    @cached_property
    def types(self) -> frozenset[str]:
        """Types of the effects."""
        return frozenset(effect.type_name for effect in self.effects)

    @cached_property
    def _ordered(self) -> list[Effect]:
        return sorted(self.effects, key=lambda effect: (effect.rank, effect.type_name))

    def of(self, kind: type[_Kind]) -> list[_Kind]:
        """Return the effects in one of the five places, in the order in which they act."""
        return [effect for effect in self._ordered if isinstance(effect, kind)]

    def contact(self, curve: Curve) -> Contact:
        """Return the contact of the curve's indenter, of known quantities."""
        contact = curve.contact.of_modulus(self.solid.reduced_modulus)
        for effect in self.of(Bends):
            contact = effect.contact(contact)
        return contact

    def excuse(self, curves: Sequence[Curve]) -> str:
        """Return why the set is not legal or cannot act on the curves; empty if it can."""
        bends, responds = self.of(Bends), self.of(Responds)
        if len(responds) > 1 or len(bends) > len({effect.rank for effect in bends}):
            return "two of them stand in one place"
        names = [name for part in self.parts for name in quantities(type(part))]
        if len(names) > len(set(names)):
            return "two of them have a quantity of one name"
        if any(effect.balances for effect in responds) and self.of(Yields):
            return "nothing may be in series with what balances the cantilever itself"
        for curve in curves:
            contact, sizes = curve.contact, Sizes.of_curve(curve)
            if responds and isinstance(contact.indenter, HasModulus):
                return "a bead that yields does not relax with the solid"
            one = np.ones(1)
            if curve.sines and any(
                effect.known(sizes).complex_modulus(one, one, 0.0) is None for effect in responds
            ):
                return "what a sine tells beside it is not known"
            for effect in (*bends, *(e for e in self.effects if e not in bends)):
                if excuse := effect.excuse(contact, curve, self.types - {effect.type_name}):
                    return excuse
                if isinstance(effect, Bends):
                    contact = effect.known(sizes).contact(contact)
            if curve.sines and "tension" in names and not contact.is_bare:
                return "what a sine tells under a tension is known of a bare half-space alone"
        return ""

    def accuracy(self, curve: Curve) -> float:
        """Return the error of its force over the largest one."""
        contact = self.contact(curve)
        of_effects = (effect.accuracy(contact, curve, self.types) for effect in self.effects)
        return max((contact.error, *of_effects))

    def relaxed(self, time: float) -> float:
        """Return the modulus after a time [s] over E*."""
        return next((effect.relaxed(time) for effect in self.of(Responds)), 1.0)

    def free_force(self, curve: Curve) -> Array:
        """Return the force [N] that is recorded in each row of a cantilever without a load."""
        return self.recorded(np.zeros_like(curve.force), curve)

    def depth(self, curve: Curve) -> Array:
        """Return the depth of the tip [m] in each row, negative before contact."""
        load = curve.force - self.free_force(curve)
        return self.base_depth(curve) - load / (curve.stiffness or np.inf)

    def base_depth(self, curve: Curve) -> Array:
        """Return the depth of the base over that of first touch [m], in each row."""
        touch: float | Array = self.solid.contact_point
        if curve.touch is not None and curve.stiffness is not None:
            nearest = int(np.argmin(np.abs(curve.position - touch)))
            touch = touch + self.free_force(curve)[..., [nearest]] / curve.stiffness
        return np.asarray(curve.base - touch)

    def force(self, curve: Curve) -> Array:
        """Return the force [N] that is recorded in each row, of known quantities.

        If the solid and what is in series with it do not balance, it is a ConvergenceError.
        """
        force = self.balance(curve).recorded
        if not np.isfinite(force).all():
            raise ConvergenceError(
                "the forces of the cantilever and the solid do not balance; is the spring "
                "constant right?"
            )
        return force

    def balance(self, curve: Curve, *, together: bool = True) -> Balance:
        """Return forces and depths of a curve in balance, NaN where none balances.

        Quantities are numbers, or columns of shape (k, 1) of k trials, which are computed together
        or one by one.
        """
        if not together:
            balances = [known.balance(curve) for known in self._each()]
            return Balance(*map(np.array, zip(*balances, strict=True)))
        of, step = self._forces(curve), DIFFERENCE * curve.contact.deepest
        if of.give is None:
            depth, force = of.base, of.true_force(of.base)
        else:
            depth, force = balance_depths(of.true_force, of.give, of.base, of.near)
        rate = (of.true_force(depth + step) - force) / step
        if of.give is not None:
            way = of.give(force)
            stretch = 1 + (of.give(force + step * rate) - way) / step
            left, rate = of.base - depth - way, rate / stretch
            force, depth = force + rate * left, depth + left / stretch
        return Balance(self.recorded(force, curve), force, depth, rate)

    def beside(self, curve: Curve, near: Balance, *, together: bool = True) -> Array:
        """Return the recorded forces [N] beside a balance at quantities that differ little."""
        if not together:
            rows = enumerate(self._each())
            return np.array([k.beside(curve, Balance(*(x[i] for x in near))) for i, k in rows])
        of = self._forces(curve)
        if of.give is None:
            return self.recorded(of.true_force(of.base), curve)
        force = of.true_force(near.depth)
        left = of.base - near.depth - of.give(force)
        return self.recorded(force + near.rate * left, curve)

    def recorded(self, force: Array, curve: Curve) -> Array:
        """Return what the instrument makes of a true force [N] in each row."""
        return reduce(lambda f, effect: effect.recorded(f, curve), self.of(Records), force)

    def stiffness(self, curve: Curve) -> float | None:
        """Return the true spring constant [N/m] of a curve; None if its cantilever is stiff."""
        if curve.stiffness is None:
            return None
        return reduce(lambda k, effect: effect.stiffness(k), self.of(Records), curve.stiffness)

    def _each(self) -> Iterator[Explanation]:
        """Yield the explanation of each trial, of quantities that are numbers."""
        own = [{n: getattr(part, n) for n in quantities(type(part))} for part in self.parts]
        for row in range(max(np.size(v) for values in own for v in values.values())):
            of_row = [
                {n: float(np.ravel(v)[row % np.size(v)]) for n, v in vs.items()} for vs in own
            ]
            pairs = zip(self.parts, of_row, strict=True)
            parts: list[Any] = [part.of_values(values) for part, values in pairs]
            yield Explanation(parts[0], tuple(parts[1:]))

    def _forces(self, curve: Curve) -> _Forces:
        """Return what pushes and what gives way along the path of a curve."""
        stiffness = self.stiffness(curve)
        softness = 0.0 if stiffness is None else 1 / stiffness
        contact, base = self.contact(curve), self.base_depth(curve)
        adds, yields, responds = self.of(Adds), self.of(Yields), self.of(Responds)

        def give(force: Array) -> Array:
            return sum((effect.give(force) for effect in yields), start=softness * force)

        is_free = curve.stiffness is None and not yields
        balances = is_free or any(effect.balances for effect in responds)
        # The way that the measured forces leave.
        path = base if balances else base - give(curve.smooth_force - self.free_force(curve))
        response: Response = contact.force
        for effect in responds:
            response = effect.response(contact, curve, path, softness)

        def true_force(depth: Array) -> Array:
            beside = (add.force(contact, curve, depth) for add in adds)
            return sum(beside, start=response(depth))

        near = np.where(base > 0, np.maximum(path, _LEAST * base), base)
        return _Forces(base, near, true_force, None if balances else give)


def columns_are_rows(explanation: Explanation, curve: Curve) -> bool:
    """Return whether an explanation takes columns of its open quantities, of many trials at once.

    The results then have the shape (k, n), and each row is that of the numbers.
    """
    sizes, factors = Sizes.of_curve(curve), np.array([[1.0], [1.1], [0.9]])
    effects = [(effect, effect.known(sizes)) for effect in explanation.effects]
    columns = tuple(
        known.of_values({name: getattr(known, name) * factors for name in effect.open})
        for effect, known in effects
    )
    moduli, touch = sizes.of("Pa") * factors[::-1], float(np.median(curve.base))
    solid = explanation.solid.of_values({"reduced_modulus": moduli, "contact_point": touch})
    trials = Explanation(solid, columns)
    try:
        forces = trials.balance(curve).recorded
    except Exception:  # Of another author's code any may come.
        return False
    one_by_one = trials.balance(curve, together=False).recorded
    far = np.inf if forces.shape != one_by_one.shape else np.max(np.abs(forces - one_by_one))
    return bool(far <= _ROUNDING * np.max(np.abs(one_by_one)))


class _Forces(NamedTuple):
    """What a solid and what is in series with it do along a path."""

    base: Array
    """Depths of the base [m]."""
    near: Array
    """Depths [m] from which a balance is sought."""
    true_force: Response
    """True force [N] of each row at its depth [m]."""
    give: Callable[[Array], Array] | None
    """Way [m] of what is in series; None if nothing is, or what responds has it."""
