"""The compliance of a surface, carried upwards through an elastic layer glued to it.

All numbers are dimensionless: compliances are in units of 2/(E* q), with E* of the layer or
half-space under the surface, and x = qh is the wavenumber times the thickness of a layer.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from pellicle.arrays import Array

from .hyperbolic import DEEP, scaled_cosh_rest, scaled_sinh_rest


class SurfaceCompliance(NamedTuple):
    """The symmetric 2 × 2 matrix from the tractions on a surface to its displacements.

    The tractions are waves of shear, sin qx along x, and of pressure, cos qx; the displacements are
    such waves along x and into the solid. The determinant is a number of its own because
    shear · normal − coupling² cancels: under a stiff film it may be 10⁻⁵ of either term.
    """

    shear: Array | float
    coupling: Array | float
    normal: Array | float
    determinant: Array | float

    def in_units(self, ratio: float) -> SurfaceCompliance:
        """Return the same compliance in units that are smaller by the factor ``ratio``."""
        shear, coupling, normal, determinant = self
        return SurfaceCompliance(
            ratio * shear, ratio * coupling, ratio * normal, ratio * ratio * determinant
        )


RIGID: Final = SurfaceCompliance(0.0, 0.0, 0.0, 0.0)
"""A surface that does not move."""


def half_space(coupling_ratio: float) -> SurfaceCompliance:
    """Return the compliance of a half-space; Johnson 1985, section 13.2."""
    return SurfaceCompliance(1.0, -coupling_ratio, 1.0, 1 - coupling_ratio**2)


def on_layer(below: SurfaceCompliance, x: Array, coupling_ratio: float) -> SurfaceCompliance:
    """Return the compliance of the upper surface of a layer glued to the surface ``below``.

    ``below`` is in the units of the layer, x > 0 the wavenumber times the thickness, and
    ``coupling_ratio`` is g = (1 − 2ν)/(2(1 − ν)) of the layer.

    Two solutions of Hooke's law and equilibrium fit the lower surface. Their minors, determinants
    of pairs of tractions and displacements, obey a linear differential equation with constant
    coefficients in the height (Dunkin 1965). Its solution is used here, times e^{−2x}; divided by
    the minor of the two tractions the minors are the compliance and its determinant. Terms that
    cancel for small x are combined. Through six layers of moduli from 10⁻⁶ to 10⁶ the relative
    error is below 2e-15.
    """
    g, f = coupling_ratio, 1 - coupling_ratio**2
    y = np.minimum(2 * x, DEEP)
    decay = np.exp(-y)
    cosh2, sinh2 = ((1 + decay) / 2) ** 2, (np.expm1(-y) / 2) ** 2  # cosh² x, sinh² x
    x1, x2 = decay * y / 2, decay * (y / 2) ** 2
    odd, even = scaled_sinh_rest(y) / 2, scaled_cosh_rest(y) / 2

    # Minors of the layer on a rigid base.
    tractions = decay + 2 * (1 - g) * x2 + f * even
    shear = f * odd + 2 * (1 - g) * x1
    normal = f * odd + 2 * g * (1 - g) * x1
    coupling = (1 - g) * ((1 - 3 * g) * x2 - g * (1 + g) * even)
    determinant = f**2 * even + 4 * g * (1 - g) ** 2 * x2
    # Contributions to the coupling by the compliance below.
    by_shear = (1 - 2 * g) * x1 - g * odd
    by_normal = x1 + g * odd
    by_both = x2 + g * even
    by_coupling = decay - 2 * (1 - 2 * g) * x2 + 2 * g**2 * even

    a, b, c, d = below
    minor = tractions + (odd + 2 * x1) * a - 2 * by_both * b + odd * c + even * d
    return SurfaceCompliance(
        shear=(shear + cosh2 * a - 2 * by_normal * b + sinh2 * c + odd * d) / minor,
        coupling=(coupling + by_shear * a + by_coupling * b - by_normal * c - by_both * d) / minor,
        normal=(normal + sinh2 * a + 2 * by_shear * b + cosh2 * c + (odd + 2 * x1) * d) / minor,
        determinant=(determinant + normal * a + 2 * coupling * b + shear * c + tractions * d)
        / minor,
    )
