"""The response of a contact and of the zone around it to a change of the depth."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.surface import Operator

# Iterations between restarts; 7 to 20 suffice for zones of some cells.
_RESTART = 60


def with_zone(
    operator: Operator,
    zone: Mask,
    following: Callable[[Array], Array],
    closing: Callable[[Array], Array],
    tolerance: float,
) -> Array:
    """Return dp/dδ on contact and zone, with the contact fixed and the zone following its law.

    ``following`` returns the change of the traction on the ``zone`` for one of the gap, ``closing``
    the pressure on the contact that displaces it by 1, given the displacement by other tractions.
    The traction of the zone obeys v = dσ/dg (u − 1), u being the displacement by v and by the
    pressure that keeps the contact closed: a linear system on the zone, solved by GMRES (Saad &
    Schultz 1986).
    """
    from scipy.sparse.linalg import LinearOperator, gmres

    cells = np.flatnonzero(zone)
    at_rest = closing(np.zeros(zone.shape))
    if not cells.size:
        return at_rest

    def pressure(values: Array) -> Array:
        field = np.zeros(zone.shape)
        field.ravel()[cells] = values
        return field + closing(operator(field))

    def by_the_law(pressure: Array) -> Array:
        return following(operator(pressure) - 1.0).ravel()[cells]

    constant = by_the_law(at_rest)

    def residual(values: Array) -> Array:
        return values - (by_the_law(pressure(values)) - constant)

    matrix = LinearOperator((cells.size, cells.size), matvec=residual, dtype=np.float64)
    values, _ = gmres(matrix, constant, rtol=tolerance, atol=0.0, restart=_RESTART, maxiter=2)
    return pressure(values)
