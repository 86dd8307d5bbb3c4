"""Comparison of a kernel's closed form with its compliance G(q).

A pressure exp(−r²/2w²) displaces its centre by

    w² ∫₀^∞ G(q) exp(−q²w²/2) q dq = 2π/w² ∫₀^∞ P(r) exp(−r²/2w²) r dr,

where P(r) = ∫₀^r G(r') r' dr' is the radial primitive. The second form follows by parts and also
holds for springs, whose G(r) is a delta function. Both integrands are smooth in the logarithm of q
and of r, where the trapezoidal rule converges exponentially.
"""

from __future__ import annotations

import math

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import component_name
from pellicle.errors import PluginError
from pellicle.grid import Grid

from .kernel_calls import HasClosedForm, checked_call, positive_compliance

# Relative difference that an approximate closed form may have; a wrong one differs by more.
_ALLOWED = 1e-3
_STEP = 0.1  # of the logarithms
_WIDEST = 9.0  # widths beyond which a Gaussian is 0
_LOWEST_WAVE = 1e-14  # over 1/width: long elastocapillary lengths contribute as log q
_LOWEST_RADIUS = 1e-4  # over width
_CELLS = 2.0  # width of the narrow Gaussian in cells
_SHARE = 0.25  # width of the wide Gaussian over the domain


def refuse_contradiction(kernel: HasClosedForm, grid: Grid) -> None:
    """Refuse a kernel whose closed form is not the transform of its compliance.

    This compares the displacements under two Gaussian pressures, one about as wide as a cell, the
    other as the domain, and the growth of the primitive between these radii.
    """
    compliance = checked_call(kernel, "compliance")
    greens_function = checked_call(kernel, "greens_function")
    radial_primitive = checked_call(kernel, "radial_primitive")
    cell, size = min(grid.spacing), math.hypot(*grid.size)

    def positive(q: Array) -> Array:
        with np.errstate(all="ignore"):
            values = compliance(q)
        # Formulas may cancel for waves far longer than the domain, which hardly contribute.
        near = q > 1e-3 / size
        positive_compliance(kernel, q[near], values[near])
        return np.where(np.isfinite(values), values, 0.0)

    def nodes(start: float) -> Array:
        number = int(np.log(_WIDEST / start) / _STEP)
        return np.asarray(_WIDEST * np.exp(_STEP * np.arange(-number, 1)))

    def trapezoid(integrand: Array) -> float:
        return float(_STEP * (integrand.sum() - (integrand[0] + integrand[-1]) / 2))

    for width in (_CELLS * cell, _SHARE * size):
        q = nodes(_LOWEST_WAVE) / width
        waves = positive(q) * np.exp(-((q * width) ** 2) / 2) * q**2
        by_compliance = width**2 * trapezoid(waves)
        r = nodes(_LOWEST_RADIUS) * width
        rings = radial_primitive(r) * np.exp(-((r / width) ** 2) / 2) * r**2
        by_primitive = 2 * np.pi / width**2 * trapezoid(rings)
        if abs(by_primitive - by_compliance) > _ALLOWED * by_compliance:
            raise PluginError(
                f"{component_name(kernel)}: radial_primitive(r) gives {by_primitive:.6g} m at the "
                f"centre of a Gaussian pressure of 1 Pa and standard deviation {width:.3g} m, "
                f"compliance(q) {by_compliance:.6g} m; they have to agree"
            )
    # ∫ G(r) r dr [m³/N] between the two radii.
    edges = np.linspace(np.log(cell), np.log(size), 2 + int(np.log(size / cell)))
    points, weights = np.polynomial.legendre.leggauss(16)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    r = np.exp(middle[:, None] + half[:, None] * points)
    by_greens_function = float((half[:, None] * weights * greens_function(r) * r**2).sum())
    start, end = radial_primitive(np.array([cell, size]))
    if abs(end - start - by_greens_function) > _ALLOWED * max(abs(start), abs(end)):
        raise PluginError(
            f"{component_name(kernel)}: radial_primitive(r) grows by {end - start:.6g} m³/N from "
            f"r = {cell:.3g} m to {size:.3g} m, and the integral of greens_function(r) r by "
            f"{by_greens_function:.6g} m³/N; they have to agree"
        )
