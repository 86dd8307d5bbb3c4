"""The compliance of a stack of layers by Thomson's transfer matrices, in decimal arithmetic.

As it stands this method loses all digits (Thomson 1950, Haskell 1953); with enough of them it is an
independent reference that knows nothing of the recursion of the kernel.
"""

from collections.abc import Sequence
from decimal import Decimal, localcontext
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.object_]

_DIGITS = 150


class Layer(NamedTuple):
    """Young's modulus [Pa], Poisson's ratio and thickness [m] of a layer."""

    youngs_modulus: float
    poissons_ratio: float
    thickness: float


class HalfSpace(NamedTuple):
    """Young's modulus [Pa] and Poisson's ratio of a half-space."""

    youngs_modulus: float
    poissons_ratio: float


def stack_compliance(
    layers: Sequence[Layer], substrate: HalfSpace | None, wavenumber: float
) -> float:
    """Return G(q) [m/Pa] of layers, from the surface down, on a half-space or a rigid base (None).

    u_x = U sin qx, u_z = W cos qx, and pressures S cos qx and tractions T sin qx on the surface,
    z down into the solid.
    """
    with localcontext(prec=_DIGITS):
        q = Decimal(wavenumber)
        surface = _matrix([0, 0], [0, 0])
        if substrate is not None:
            mu, nu = _constants(substrate)
            diagonal, coupling = (1 - nu) / (mu * q), (2 * nu - 1) / (2 * mu * q)
            surface = _matrix([diagonal, coupling], [coupling, diagonal])
        for layer in reversed(layers):
            mu, nu = _constants(layer)
            share, twice = nu / (1 - nu), 2 * mu * q
            # d(U, W, T, S)/d(−qz), tractions in 2μq: Hooke's law and equilibrium.
            upwards = _matrix(
                [0, -1, 2, 0],
                [share, 0, 0, (1 - 2 * nu) / (1 - nu)],
                [1 / (1 - nu), 0, 0, -share],
                [0, 0, 1, 0],
            )
            through = _exponential(upwards, q * Decimal(layer.thickness))
            above = through @ np.vstack([twice * surface, _matrix([1, 0], [0, 1])])
            (p, o), (r, s) = above[2:]
            surface = above[:2] @ _matrix([s, -o], [-r, p]) / (p * s - o * r) / twice
        return float(surface[1, 1])


def _constants(solid: Layer | HalfSpace) -> tuple[Decimal, Decimal]:
    """Return shear modulus and Poisson's ratio."""
    nu = Decimal(solid.poissons_ratio)
    return Decimal(solid.youngs_modulus) / (2 * (1 + nu)), nu


def _exponential(a: Matrix, x: Decimal) -> Matrix:
    """Return exp(ax) for (a² − 1)² = 0, as a cubic polynomial in a."""
    up, down = x.exp(), (-x).exp()
    cosh, sinh = (up + down) / 2, (up - down) / 2
    one, square = _matrix(*np.eye(4, dtype=int).tolist()), a @ a
    even = (cosh - x * sinh / 2) * one + x * sinh / 2 * square
    odd = (sinh - (x * cosh - sinh) / 2) * one + (x * cosh - sinh) / 2 * square
    value: Matrix = even + a @ odd
    return value


def _matrix(*rows: Sequence[Decimal | int]) -> Matrix:
    return np.array([[Decimal(value) for value in row] for row in rows], dtype=object)
