"""Where a fit starts: the best of a scan of contact points and elastocapillary lengths."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array
from pellicle.components import HasForceCurve
from pellicle.components.calls import force_curve_of

from .likelihood import MODULUS, OFFSET, POINT, SLOPE, TENSION, Likelihood

_BINS = 200
_POINTS = 50
_LENGTHS = (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0)
"""s over the measured range of positions."""
BEFORE = 0.5
"""How far before the first point contact may have begun, over the range."""
KEPT = 3


def starts(likelihood: Likelihood, held: Array) -> list[Array]:
    """Return the `KEPT` best of the scan, best first.

    ``held`` holds the parameters that are not free, and anything for those that are.  At a given
    contact point and length the modulus and the baseline are linear, so they are solved for.
    """
    z, f = _binned(likelihood.position), _binned(likelihood.force)
    span = float(np.ptp(z))
    points = np.linspace(z[0] - BEFORE * span, z[-1] - 0.02 * span, _POINTS)
    if POINT not in likelihood.free:
        points = held[POINT : POINT + 1]
    lengths = _LENGTHS if TENSION in likelihood.free or held[TENSION] else (0.0,)
    found = [
        (misfit, parameters)
        for point in points
        for length in lengths
        if (tried := _solved(likelihood, held, z, f, point, length * span)) is not None
        for misfit, parameters in [tried]
    ]
    found.sort(key=lambda each: each[0])
    return [parameters for _, parameters in found[:KEPT]]


def _binned(values: Array) -> Array:
    """Return means of neighbours, about `_BINS` of them."""
    edges = np.linspace(0, values.size, min(values.size, _BINS) + 1).astype(int)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    means: Array = (sums[edges[1:]] - sums[edges[:-1]]) / np.diff(edges)
    return means


def _solved(
    likelihood: Likelihood, held: Array, z: Array, f: Array, point: float, length: float
) -> tuple[float, Array] | None:
    """Return misfit and parameters at a contact point and length; None if force would pull."""
    shape = _force(likelihood.indenter, z - point, length)
    moved = z - likelihood.position[0]
    columns = {MODULUS: shape, OFFSET: np.ones_like(z), SLOPE: moved}
    fitted = [k for k in columns if k == MODULUS or k in likelihood.free]
    matrix = np.column_stack([columns[k] for k in fitted])
    norms = np.linalg.norm(matrix, axis=0)
    if not norms.all():
        return None
    target = f - sum(held[k] * columns[k] for k in (OFFSET, SLOPE) if k not in fitted)
    solution = np.linalg.lstsq(matrix / norms, target, rcond=None)[0] / norms
    modulus = float(solution[0])
    if MODULUS not in likelihood.free:
        modulus = float(np.exp(held[MODULUS]))
    if modulus <= 0:
        return None
    parameters = held.copy()
    parameters[fitted] = solution
    parameters[POINT], parameters[MODULUS] = point, np.log(modulus)
    if TENSION in likelihood.free:
        parameters[TENSION] = modulus * length / 2
    misfit = float(np.sum((matrix @ solution - target) ** 2))
    return misfit, parameters


def _force(indenter: HasForceCurve, depth: Array, length: float) -> Array:
    return force_curve_of(indenter, depth, length).force
