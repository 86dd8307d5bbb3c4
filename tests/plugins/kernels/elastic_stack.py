"""The compliance of a stack of layers by Thomson's transfer matrices, in decimal arithmetic.

As it stands this method loses all digits (Thomson 1950, Haskell 1953); with enough of them it is an
independent reference that knows nothing of the recursion of the kernel.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal, localcontext
from typing import NamedTuple

Matrix = list[list[Decimal]]

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
        surface = [[Decimal(0)] * 2 for _ in range(2)]
        if substrate is not None:
            mu, nu = _constants(substrate)
            diagonal, coupling = (1 - nu) / (mu * q), (2 * nu - 1) / (2 * mu * q)
            surface = [[diagonal, coupling], [coupling, diagonal]]
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
            below = [[twice * value for value in row] for row in surface]
            above = _product(through, [*below, *_matrix([1, 0], [0, 1])])
            quotient = _product(above[:2], _inverse(above[2:]))
            surface = [[value / twice for value in row] for row in quotient]
        return float(surface[1][1])


def _constants(solid: Layer | HalfSpace) -> tuple[Decimal, Decimal]:
    """Return shear modulus and Poisson's ratio."""
    nu = Decimal(solid.poissons_ratio)
    return Decimal(solid.youngs_modulus) / (2 * (1 + nu)), nu


def _exponential(a: Matrix, x: Decimal) -> Matrix:
    """Return exp(ax) for (a² − 1)² = 0, as a cubic polynomial in a."""
    up, down = x.exp(), (-x).exp()
    cosh, sinh = (up + down) / 2, (up - down) / 2
    square = _product(a, a)
    one = _matrix(*([int(i == j) for j in range(4)] for i in range(4)))
    even = _sum(one, square, cosh - x * sinh / 2, x * sinh / 2)
    odd = _sum(one, square, sinh - (x * cosh - sinh) / 2, (x * cosh - sinh) / 2)
    return _sum(even, _product(a, odd), Decimal(1), Decimal(1))


def _matrix(*rows: Sequence[Decimal | int]) -> Matrix:
    return [[Decimal(value) for value in row] for row in rows]


def _sum(a: Matrix, b: Matrix, factor: Decimal, other: Decimal) -> Matrix:
    return [
        [factor * x + other * y for x, y in zip(row, second, strict=True)]
        for row, second in zip(a, b, strict=True)
    ]


def _product(a: Matrix, b: Matrix) -> Matrix:
    columns = list(zip(*b, strict=True))
    return [
        [sum((x * y for x, y in zip(row, column, strict=True)), Decimal(0)) for column in columns]
        for row in a
    ]


def _inverse(a: Matrix) -> Matrix:
    (p, q), (r, s) = a
    determinant = p * s - q * r
    return [[s / determinant, -q / determinant], [-r / determinant, p / determinant]]
