"""Initial guesses of a fit: the best of a scan over contact points and values of the model."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.parameters import CONTACT_POINT, OFFSET, SLOPE, Coordinates, Values

from .likelihood import Likelihood

_BINS = 200
_POINTS = 50
BEFORE = 0.5
"""Largest distance of the contact point before the first position, over the range of positions."""
GUESSES = 3


def initial_guesses(
    likelihood: Likelihood, fixed: Coordinates, points: list[float] | None = None
) -> list[Coordinates]:
    """Return the `GUESSES` best of a scan over contact points and values of the model, best first.

    ``fixed`` has the coordinates of all parameters that are not free; others are ignored.  At each
    node the force scale and the baseline, in which the model is linear, follow by least squares.
    With ``points``, the contact points of the scan, all rows are compared, as a model needs that
    belongs to them; otherwise averages of neighbours.
    """
    fixed = {p: fixed[p] for p in likelihood.parameters if p not in likelihood.free}
    if points is None:
        z, f = _binned(likelihood.position), _binned(likelihood.force)
    else:
        z = likelihood.base if likelihood.force_model.on_base else likelihood.position
        f = likelihood.force
    span = float(np.ptp(z))
    if points is None:
        points = np.linspace(z.min() - BEFORE * span, z.max() - 0.02 * span, _POINTS).tolist()
    if CONTACT_POINT in fixed:
        points = [fixed[CONTACT_POINT]]
    # A parameter fixed at its minimum (no tension) removes the trials above it.
    trials = [
        values
        for values in likelihood.force_model.guesses(span)
        if not any(fixed.get(p) == p.minimum < value for p, value in values.items())
    ]
    guesses = [
        guess
        for point in points
        for values in trials
        if (guess := _linear_fit(likelihood, fixed, z, f, point, values)) is not None
    ]
    guesses.sort(key=lambda guess: guess[0])
    return [parameters for _, parameters in guesses[:GUESSES]]


def _binned(values: Array) -> Array:
    """Return the means of about `_BINS` groups of neighbours."""
    edges = np.linspace(0, values.size, min(values.size, _BINS) + 1).astype(int)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    means: Array = (sums[edges[1:]] - sums[edges[:-1]]) / np.diff(edges)
    return means


def _linear_fit(
    likelihood: Likelihood, fixed: Coordinates, z: Array, f: Array, point: float, values: Values
) -> tuple[float, Coordinates] | None:
    """Return misfit [N²] and coordinates; None if the force would have to be negative."""
    model = likelihood.force_model
    shape = model.force(z - point, {**values, CONTACT_POINT: point}).force
    baseline = {OFFSET: np.ones_like(z), SLOPE: z - likelihood.position[0]}
    fitted = [p for p in baseline if p not in fixed]
    matrix = np.column_stack([shape, *(baseline[p] for p in fitted)])
    norms = np.linalg.norm(matrix, axis=0)
    if not norms.all():
        return None
    target = f - sum(fixed[p] * baseline[p] for p in baseline if p in fixed)
    solution = np.linalg.lstsq(matrix / norms, target, rcond=None)[0] / norms
    factor = float(solution[0])
    for p, value in values.items():
        if p.logarithmic and p in fixed:
            factor = p.value(fixed[p]) / value
    if factor <= 0:
        return None
    scaled = {p: p.coordinate(value) for p, value in model.scaled(values, factor).items()}
    linear = dict(zip(fitted, solution[1:].tolist(), strict=True))
    misfit = float(np.sum((matrix @ solution - target) ** 2))
    return misfit, {CONTACT_POINT: point} | scaled | linear | fixed
