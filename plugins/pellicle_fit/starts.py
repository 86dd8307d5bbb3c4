"""Where searches for the least χ² start."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from pellicle.arrays import Array

from .candidate import Candidate
from .effect import Records, powers
from .objective import CONTACT_POINT, MODULUS, ROUGH, Objective, Slot

_POINTS, _ROWS = 25, 120
"""Contact points that are scanned, and rows of each pass that a scan sees."""
_LAST = 0.05
"""Share of the range at whose end no contact begins."""
_KEPT = 4
"""Scans from which searches go on."""
_GUESS = 0.03
"""Coordinate of what neither a scan nor an effect says."""


def starts(objective: Objective, known: Sequence[Candidate], *, scan: bool) -> list[Array]:
    """Return coordinates to start from: of minima of other explanations, and of a scan."""
    found, own = pooled(objective) if scan else [], list(_own(objective))
    for other in known:
        # A search from a part of a part starts further off.
        if any(other.types < larger.types for larger in known):
            continue
        at = objective.at_values(other.objective.values(other.minimum.at))
        # Starts that differ in what is known already are one.
        found += [*np.unique([np.where(np.isnan(at), guess, at) for guess in own], axis=0)]
    return found


def _own(objective: Objective) -> Iterator[Array]:
    """Yield coordinates of the starts of effects; those of the solid are sizes of the curve."""
    effects = objective.explanation.effects
    for choice in product(*(list(effect.starts(objective.sizes)) for effect in effects)):
        values = {name: value for start in choice for name, value in start.items()}
        slots = ((slot, values.get(slot.name, _GUESS * slot.scale)) for slot in objective.slots)
        yield np.array([slot.coordinate(value) for slot, value in slots])


def pooled(objective: Objective) -> list[Array]:
    """Return the best of scans of each curve: medians of what the curves share."""
    if len(objective.curves) == 1:
        return scanned(objective)
    each = []
    for curve, noise in zip(objective.curves, objective.noise, strict=True):
        sizes = objective.sizes._replace(shallow_force=curve.shallow_force)
        alone = replace(objective, curves=(curve,), noise=(noise,), sizes=sizes, memory=())
        minima = [alone.minimise(at, steps=ROUGH).at for at in scanned(alone)]
        each.append([{name: v for (name, _), v in alone.values(at).items()} for at in minima])

    def value(slot: Slot, known: Sequence[dict[str, float]]) -> float:
        shared = float(np.median([values[slot.name] for values in known]))
        return slot.coordinate(shared if slot.curve is None else known[slot.curve][slot.name])

    several = zip(*each, strict=False)
    return [np.array([value(slot, known) for slot in objective.slots]) for known in several]


def scanned(objective: Objective) -> list[Array]:
    """Return the best few of a scan of contact points for each start of the effects.

    With all forces of an explanation its recorded force grows: at each point one factor is linear.
    """
    (curve,) = objective.curves
    curve = curve.binned(_ROWS)
    means = replace(objective, curves=(curve,))
    point, modulus = objective.index(CONTACT_POINT), objective.index(MODULUS)
    found = []
    for own in _own(means):
        # Noisy positions are taken as they are, where no force bends the cantilever.
        shift = means.known(own, 0).free_force(curve) / (curve.stiffness or np.inf)
        tip = replace(curve, position=curve.position + shift, stiffness=None)
        last, trials = tip.position.max() - _LAST * tip.span, []
        tips = replace(means, curves=(tip,))
        for z in np.linspace(tip.position.min(), last, _POINTS if point is not None else 1):
            at = own.copy()
            if modulus is not None:
                at[modulus] = 0.0
            if point is not None:
                at[point] = objective.slots[point].coordinate(z)
            trials.append(_scaled(tips, at))
        found.append(min(trials, key=lambda trial: trial[0]))
    return [at for _, at in sorted(found, key=lambda trial: trial[0])[:_KEPT]]


def _scaled(objective: Objective, at: Array) -> tuple[float, Array]:
    """Return the misfit [N²] of the best multiple of all forces, and its coordinates."""
    (curve,), (force,) = objective.curves, objective.forces(at)
    free = objective.known(at, 0).free_force(curve)
    measured, force = curve.weights * (curve.force - free), curve.weights * (force - free)
    norm = float(force @ force)
    factor = float(force @ measured) / norm if norm else 0.0
    if factor <= 0:
        # Where most of the measured force is negative, as far from 0 before contact.
        factor = curve.largest / (float(np.ptp(force)) or curve.largest)
    for k, slot in enumerate(objective.slots):
        is_load = not isinstance(objective.explanation.parts[slot.part], Records)
        if is_load and powers(slot.quantity.unit)[0] == 1:
            at[k] = at[k] + np.log(factor) if slot.quantity.log else at[k] * factor
    return float(np.sum((factor * force - measured) ** 2)), at
