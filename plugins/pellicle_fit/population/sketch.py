"""Few points of a curve and its fit, as many as a small figure shows."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PellicleError
from pellicle_fit.files.measurement import Measurement

_POINTS = 80
_DIGITS = 5


class Sketch(NamedTuple):
    """Position [m] and force [N] of some rows of a curve, and the force of the fit there."""

    position: Array
    force: Array
    fit: Array | None


def to_json(position: Array, force: Array, fit: Array) -> dict[str, list[float]]:
    """Return a sketch as JSON data: evenly chosen rows, rounded."""
    rows = _rows(position.size)
    names = zip(Sketch._fields, (position, force, fit), strict=True)
    return {name: [float(f"{v:.{_DIGITS}g}") for v in values[rows]] for name, values in names}


def from_json(data: dict[str, Any]) -> Sketch | None:
    """Return the sketch that JSON data hold; None if they hold none."""
    try:
        position, force, fit = (np.array(data[name], dtype="f4") for name in Sketch._fields)
    except (KeyError, TypeError, ValueError):
        return None
    return Sketch(position, force, fit)


def of_curve(curve: Measurement | PellicleError) -> Sketch | None:
    """Return the sketch of a curve without a fit; None if it has no numbers."""
    if isinstance(curve, PellicleError):
        return None
    try:
        position, force = (np.asarray(v, dtype=float) for v in (curve.position, curve.force))
        finite = np.isfinite(position) & np.isfinite(force)
        rows = np.flatnonzero(finite)
        rows = rows[_rows(rows.size)]
        return Sketch(position[rows].astype("f4"), force[rows].astype("f4"), None)
    except (TypeError, ValueError, IndexError):
        return None


def _rows(size: int) -> Array:
    """Return the indices of evenly chosen rows, with the first and the last."""
    chosen: Array = np.unique(np.linspace(0, size - 1, min(size, _POINTS)).round().astype(int))
    return chosen
