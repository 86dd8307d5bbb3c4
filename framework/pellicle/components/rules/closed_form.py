"""Comparison of a kernel's closed form with its compliance G(q).

A pressure exp(−r²/2w²) displaces its centre by

    w² ∫₀^∞ G(q) exp(−q²w²/2) q dq = 2π/w² ∫₀^∞ P(r) exp(−r²/2w²) r dr,

where P(r) = ∫₀^r G(r') r' dr' is the radial primitive. The second form follows by parts and also
holds for springs, whose G(r) is a delta function. Both integrands are smooth in the logarithm of q
and of r, where the trapezoidal rule converges exponentially.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pellicle.arrays import Array
from pellicle.surface.operators import HasClosedForm

# Relative difference that an approximate closed form may have; a wrong one differs by more.
_ALLOWED = 1e-3
_STEP = 0.1  # of the logarithms
_WIDEST = 9.0  # widths beyond which a Gaussian is 0
_LOWEST_WAVE = 1e-14  # over 1/width: long elastocapillary lengths contribute as log q
_LOWEST_RADIUS = 1e-4  # over width
_CELLS = 2.0  # width of the narrow Gaussian in cells
_SHARE = 0.25  # width of the wide Gaussian over the domain


def displacement_of_centre(compliance: Callable[[Array], Array], width: float) -> float:
    """Return the displacement [m] of the centre of a Gaussian pressure of 1 Pa."""
    q = _nodes(_LOWEST_WAVE) / width
    values = compliance(q)
    # Formulas may cancel for the longest waves, which hardly contribute.
    finite = np.where(np.isfinite(values), values, 0.0)
    return width**2 * _trapezoid(finite * np.exp(-((q * width) ** 2) / 2) * q**2)


def _nodes(start: float) -> Array:
    number = int(np.log(_WIDEST / start) / _STEP)
    return np.asarray(_WIDEST * np.exp(_STEP * np.arange(-number, 1)))


def _trapezoid(integrand: Array) -> float:
    return float(_STEP * (integrand.sum() - (integrand[0] + integrand[-1]) / 2))


def contradiction_of_compliance(kernel: HasClosedForm, cell: float, size: float) -> str:
    """Compare the displacements under Gaussians about as wide as a cell and as the domain."""
    for width in (_CELLS * cell, _SHARE * size):
        by_compliance = displacement_of_centre(kernel.compliance, width)
        r = _nodes(_LOWEST_RADIUS) * width
        rings = kernel.radial_primitive(r) * np.exp(-((r / width) ** 2) / 2) * r**2
        by_primitive = 2 * np.pi / width**2 * _trapezoid(rings)
        if not abs(by_primitive - by_compliance) <= _ALLOWED * by_compliance:
            return (
                f"radial_primitive(r) gives {by_primitive:.6g} m at the centre of a Gaussian "
                f"pressure of 1 Pa and standard deviation {width:.3g} m, compliance(q) "
                f"{by_compliance:.6g} m"
            )
    return ""


def contradiction_of_primitive(kernel: HasClosedForm, cell: float, size: float) -> str:
    """Compare the growth of the primitive from r = cell to size with ∫ G(r) r dr [m³/N]."""
    edges = np.linspace(np.log(cell), np.log(size), 2 + int(np.log(size / cell)))
    points, weights = np.polynomial.legendre.leggauss(16)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    r = np.exp(middle[:, None] + half[:, None] * points)
    by_greens_function = float((half[:, None] * weights * kernel.greens_function(r) * r**2).sum())
    start, end = kernel.radial_primitive(np.array([cell, size]))
    if abs(end - start - by_greens_function) <= _ALLOWED * max(abs(start), abs(end)):
        return ""
    return (
        f"radial_primitive(r) grows by {end - start:.6g} m³/N from r = {cell:.3g} m to "
        f"{size:.3g} m, and the integral of greens_function(r) r by {by_greens_function:.6g} m³/N"
    )
