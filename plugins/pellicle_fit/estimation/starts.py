"""Where searches for the least χ² start."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.contact.curve import BEFORE
from pellicle_fit.effect import Records, powers

from .candidate import Candidate
from .coordinates import CONTACT_POINT, MODULUS, Slot
from .objective import Objective
from .search import descend

_POINTS = 25
"""Contact points that are scanned on a curve."""
_EARLIER = BEFORE * 2.0 ** np.arange(-5.0, 0.0)
"""Those before its first row, over the range of positions."""
_ROUGH = 20
"""Steps of a search on one curve of several."""
_LAST = 0.05
"""Share of the range at whose end no contact begins."""
_KEPT = 4
"""Scans from which searches go on."""
_GUESS = 0.03
"""Coordinate of what neither a scan nor an effect says."""


def starts(objective: Objective, known: Sequence[Candidate], *, scan: bool) -> list[Array]:
    """Return coordinates to start from: of minima of other explanations, and of a scan."""
    coordinates, own = pooled_start(objective) if scan else [], list(_own(objective))
    for candidate in known:
        # A search from a part of a part starts further off.
        if any(candidate.types < larger.types for larger in known):
            continue
        at = objective.at_values(candidate.objective.values(candidate.minimum.at))
        # Starts that differ in what is known already are one.
        coordinates += [*np.unique([np.where(np.isnan(at), guess, at) for guess in own], axis=0)]
    return coordinates


def _own(objective: Objective) -> Iterator[Array]:
    """Yield coordinates of the starts of effects; those of the solid are sizes of the curve."""
    effects = objective.explanation.effects
    for choice in product(*(list(effect.starts(objective.sizes)) for effect in effects)):
        values = {name: value for start in choice for name, value in start.items()}
        slots = ((slot, values.get(slot.name, _GUESS * slot.scale)) for slot in objective.slots)
        yield np.array([slot.coordinate(value) for slot, value in slots])


def pooled_start(objective: Objective) -> list[Array]:
    """Return the best of scans of each curve: medians of what the curves share."""
    if len(objective.curves) == 1:
        return scan_contact_points(objective)
    guesses = []
    for curve, noise in zip(objective.curves, objective.noise, strict=True):
        sizes = objective.sizes._replace(shallow_force=curve.shallow_force)
        alone = replace(objective, curves=(curve,), noise=(noise,), sizes=sizes, memory=())
        minima = descend(alone.coarse, np.array(scan_contact_points(alone)), steps=_ROUGH)
        values = [alone.values(minimum.at).items() for minimum in minima]
        guesses.append([{name: value for (name, _), value in of} for of in values])

    def value(slot: Slot, known: Sequence[dict[str, float]]) -> float:
        shared = float(np.median([values[slot.name] for values in known]))
        return slot.coordinate(shared if slot.curve is None else known[slot.curve][slot.name])

    several = zip(*guesses, strict=False)
    return [np.array([value(slot, known) for slot in objective.slots]) for known in several]


def scan_contact_points(objective: Objective) -> list[Array]:
    """Return the best few of a scan of contact points for each start of the effects.

    With all forces of an explanation its recorded force grows: at each point one factor is linear.
    """
    (curve,) = objective.curves
    curve = curve.coarse
    means = replace(objective, curves=(curve,), memory=())
    point, modulus = objective.index(CONTACT_POINT), objective.index(MODULUS)
    owns = np.array([*_own(means)])
    # Noisy positions are taken as they are, where no force bends the cantilever.
    shifts = means.known(owns, 0).free_force(curve) / (curve.stiffness or np.inf)
    shifts, group = np.unique(np.atleast_2d(shifts), axis=0, return_inverse=True)
    groups = np.broadcast_to(group, len(owns))
    scans = []
    for number, shift in enumerate(shifts):
        some = owns[groups == number]
        tip = replace(curve, position=curve.position + shift, stiffness=None)
        touches = np.linspace(tip.position.min(), tip.position.max() - _LAST * tip.span, _POINTS)
        touches = np.append(touches, touches[0] - _EARLIER * tip.span)
        at = np.repeat(some, touches.size if point is not None else 1, axis=0)
        if modulus is not None:
            at[:, modulus] = 0.0
        if point is not None:
            at[:, point] = np.tile(touches / objective.slots[point].scale, len(some))
        misfits, scaled = _scaled(replace(means, curves=(tip,)), at)
        positions = np.argmin(misfits.reshape(len(some), -1), axis=1)
        best = positions + np.arange(len(some)) * (len(at) // len(some))
        scans += [*zip(misfits[best], scaled[best], strict=True)]
    return [at for _, at in sorted(scans, key=lambda trial: trial[0])[:_KEPT]]


def _scaled(objective: Objective, at: Array) -> tuple[Array, Array]:
    """Return the misfits [N²] of the best multiples of all forces, and their coordinates."""
    (curve,), at = objective.curves, at.copy()
    (balance,) = objective.trials(at).balances
    free = objective.known(at, 0).free_force(curve)
    force = np.nan_to_num(balance.recorded) - free
    measured, weighed = curve.weights * (curve.force - free), curve.weights * force
    norm = np.sum(weighed**2, axis=1)
    product = np.sum(weighed * measured, axis=1)
    factor = np.divide(product, norm, out=np.zeros_like(norm), where=norm > 0)
    # Where most of the measured force is negative, as far from 0 before contact.
    span = np.ptp(force, axis=1)
    factor = np.where(factor > 0, factor, curve.largest / np.where(span > 0, span, curve.largest))
    for k, slot in enumerate(objective.slots):
        is_load = not isinstance(objective.explanation.parts[slot.part], Records)
        if is_load and powers(slot.quantity.unit)[0] == 1:
            at[:, k] = at[:, k] + np.log(factor) if slot.quantity.log else at[:, k] * factor
    return np.sum((factor[:, None] * weighed - measured) ** 2, axis=1), at
