"""What explains a curve: an elastic half-space and a set of effects, and its force."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConvergenceError

from .contact import Contact
from .curve import Curve
from .effect import Adds, Bends, Effect, Records, Responds, Sizes, Solid, Yields, quantities

_Kind = TypeVar("_Kind", bound=Effect)
_BALANCE, _HALVED = 1e-6, 1e-9
"""Last step over the largest way: of Newton's method, which leaves about its square, and of
halvings."""
_DIFFERENCE = 1e-6
"""Step of slopes by √δ over the root of that way."""
_LONGEST, _FAR = 4.0, 1e6
"""Longest step, over the root of the depth or of the way, and the greatest root over the latter."""
_STEPS = 80
"""Most steps of a search for a balance."""
_NODES = 200
"""Nodes of the table from which searches for a balance start."""
_SHALLOW = 1e-6
"""Least depth that is tabulated, over the range of positions."""
_DEEPER = 2.0
"""Depth up to which the force is known while a balance is sought, over the deepest of the path."""


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

    def of(self, kind: type[_Kind]) -> list[_Kind]:
        """Return the effects in one of the five places, in the order in which they act."""
        found = [effect for effect in self.effects if isinstance(effect, kind)]
        return sorted(found, key=lambda effect: (effect.rank, effect.type_name))

    def contact(self, curve: Curve) -> Contact:
        """Return the contact of the curve's indenter, of known quantities."""
        contact = Contact.on_half_space(curve.indenter, self.solid.reduced_modulus)
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
            contact = Contact.on_half_space(curve.indenter, 1.0)
            for effect in (*bends, *(e for e in self.effects if e not in bends)):
                if excuse := effect.excuse(contact, curve, self.types - {effect.type_name}):
                    return excuse
                if isinstance(effect, Bends):
                    contact = effect.known(Sizes.of_curve(curve)).contact(contact)
        return ""

    def accuracy(self, curve: Curve) -> float:
        """Return the error of its force over the largest one."""
        contact = self.contact(curve)
        of_effects = (effect.accuracy(contact, curve, self.types) for effect in self.effects)
        return max((contact.error, *of_effects))

    def relaxed(self, time: float) -> float:
        """Return the modulus after a time [s] over E*."""
        return next((effect.relaxed(time) for effect in self.of(Responds)), 1.0)

    def baseline(self, curve: Curve) -> Array:
        """Return the force [N] that is recorded in each row without a load."""
        force = np.zeros(curve.position.shape)
        for effect in self.of(Records):
            force = effect.recorded(force, curve)
        return force

    def force(self, curve: Curve) -> Array:
        """Return the force [N] that is recorded in each row, of known quantities.

        If the solid and what is in series with it do not balance, it is a ConvergenceError.
        """
        stiffness, records = curve.stiffness, self.of(Records)
        if stiffness is not None:
            for effect in records:
                stiffness = effect.stiffness(stiffness)
        force = self._pushed(curve, 1 / stiffness if stiffness else 0.0)
        for effect in records:
            force = effect.recorded(force, curve)
        return force

    def _pushed(self, curve: Curve, softness: float) -> Array:
        """Return the true force [N] in each row; the softness is the cantilever's [m/N]."""
        contact, depth = self.contact(curve), curve.base - self.solid.contact_point
        adds, yields = self.of(Adds), self.of(Yields)

        def give(force: Array) -> Array:
            return sum((effect.give(force) for effect in yields), start=softness * force)

        in_series = bool(softness or yields)
        path = depth - give(curve.smoothed) if in_series else depth
        if in_series:
            # A search may try contact points that no row reaches.
            deepest = float(max(np.max(depth), np.max(path), _SHALLOW * curve.span))
            contact = contact.tabulated(min(_DEEPER * deepest, contact.depth_limit))
        response: Callable[[Array], Array] = contact.force
        balances = False
        for effect in self.of(Responds):
            response = effect.response(contact, curve, path, softness)
            balances = effect.balances

        def pushed(depth: Array) -> Array:
            beside = (add.force(contact, curve, depth) for add in adds)
            return sum(beside, start=response(depth))

        if balances or not in_series:
            return pushed(depth)
        # Without memory and additions the depths in balance are those of a table.
        root = np.sqrt(contact.depth_limit) * np.linspace(0.0, 1.0, _NODES)
        start = np.interp(depth, root**2 + give(contact.force(root**2)), root) ** 2
        return pushed(balanced(pushed, give, depth, np.where(depth > 0, start, depth)))


def balanced(
    pushed: Callable[[Array], Array], give: Callable[[Array], Array], base: Array, start: Array
) -> Array:
    """Return the depth δ [m] at which δ + u(P(δ)) is that of the base, shape (n,).

    The sum grows with δ, so that there is one root, which Newton's method finds from a good start;
    a step that leaves what brackets it halves that.  If there is no root, it is a ConvergenceError.
    """
    way = np.sqrt(max(float(np.ptp(base)), 1e-300))
    step, far = _DIFFERENCE * way, _FAR * way

    def depth_of(root: Array) -> Array:
        return root * np.abs(root)

    def excess(root: Array) -> Array:
        return depth_of(root) + give(pushed(depth_of(root))) - base

    # In √δ a toe that is infinitely soft at first touch has a slope.
    root = np.sign(start) * np.sqrt(np.abs(start))
    low, high = np.full(base.shape, -far), np.full(base.shape, far)
    for _ in range(_STEPS):
        above = excess(root)
        low, high = np.where(above < 0, root, low), np.where(above > 0, root, high)
        slope = (excess(root + step) - above) / step
        longest = _LONGEST * np.maximum(np.abs(root), way)
        new: Array = root - np.clip(above / np.maximum(slope, 1e-6 * step), -longest, longest)
        is_out = (new < low) | (new > high)
        new = np.where(is_out, (low + high) / 2, new)
        change = np.abs(depth_of(new) - depth_of(root))
        is_near = np.all(change <= np.where(is_out, _HALVED, _BALANCE) * way**2)
        # Without a root halvings end at the end of the bracket.
        if is_near and np.max(np.abs(new)) < 0.99 * far:
            return depth_of(new)
        root = new
    raise ConvergenceError(
        "the forces of the cantilever and the solid do not balance; is the spring constant right?"
    )
