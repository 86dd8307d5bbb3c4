"""The stiffness of a contact, measured on the response of a solver."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array, Mask

from .attraction import Attraction
from .problem import Problem


class Stiffness(NamedTuple):
    """The stiffness of a contact and its residual."""

    value: float
    """dF/dδ [N/m] with the contact fixed."""
    residual: float
    """Rms error of the displacement in contact, over the prescribed displacement."""


def measure_stiffness(
    problem: Problem, contact: Mask, pressure: Array, attraction: Attraction | None = None
) -> Stiffness:
    """Return the contact stiffness from the pressure per depth [Pa/m] of a flat punch.

    The footprint of the punch is ``contact``: cells that join as the depth grows carry no pressure
    at first, so dF/dδ is that of a flat punch (Pharr, Oliver & Brotzen 1992 for axisymmetric
    indenters). The operator is applied once. The value is 2 Σq − Σq·Aq times the area of a cell,
    stationary at the solution, so its error is quadratic in that of q.

    With an ``attraction`` the traction off the contact follows the gap, q = dσ/dg (A q − 1), and
    counts towards the force.
    """
    if not contact.any():
        return Stiffness(0.0, 0.0)
    opened = problem.operator.with_spring(0.0)(pressure) - 1.0
    missed = -opened[contact]
    total = float(pressure.sum()) + float((pressure[contact] * missed).sum())
    if attraction and attraction.zone.any():
        zone = attraction.zone
        traction = (attraction.change(opened) - pressure)[zone]
        total -= float((opened[zone] * traction).sum())
        missed = np.concatenate([missed, traction / attraction.greatest_slope])
    return Stiffness(
        value=total * problem.grid.cell_area, residual=float(np.sqrt((missed**2).mean()))
    )
