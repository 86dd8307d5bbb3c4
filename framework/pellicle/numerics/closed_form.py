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

Radial = Callable[[Array], Array]

# Relative difference that an approximate closed form may have; a wrong one differs by more.
_ALLOWED = 1e-3
_STEP = 0.1  # of the logarithms
_WIDEST = 9.0  # widths beyond which a Gaussian is 0
_LOWEST_WAVE = 1e-14  # over 1/width: long elastocapillary lengths contribute as log q
_LOWEST_RADIUS = 1e-4  # over width
_CELLS = 2.0  # width of the narrow Gaussian in cells
_SHARE = 0.25  # width of the wide Gaussian over the domain


def disagreement(
    compliance: Radial, greens_function: Radial, radial_primitive: Radial, cell: float, size: float
) -> str:
    """Return a message if the formulas of a kernel contradict each other; empty if they agree.

    This compares the displacements under two Gaussian pressures, one about as wide as a ``cell``
    [m], the other as the domain of ``size`` [m], and the growth of the primitive between these
    radii.
    """
    for width in (_CELLS * cell, _SHARE * size):
        q = _nodes(_LOWEST_WAVE, _WIDEST) / width
        waves = compliance(q) * np.exp(-((q * width) ** 2) / 2) * q**2
        by_compliance = width**2 * _trapezoid(waves)
        r = _nodes(_LOWEST_RADIUS, _WIDEST) * width
        rings = radial_primitive(r) * np.exp(-((r / width) ** 2) / 2) * r**2
        by_primitive = 2 * np.pi / width**2 * _trapezoid(rings)
        if abs(by_primitive - by_compliance) > _ALLOWED * by_compliance:
            return (
                f"radial_primitive(r) gives {by_primitive:.6g} m at the centre of a Gaussian "
                f"pressure of 1 Pa and standard deviation {width:.3g} m, compliance(q) "
                f"{by_compliance:.6g} m; they have to agree"
            )
    by_greens_function = _growth(greens_function, cell, size)
    start, end = radial_primitive(np.array([cell, size]))
    if abs(end - start - by_greens_function) > _ALLOWED * max(abs(start), abs(end)):
        return (
            f"radial_primitive(r) grows by {end - start:.6g} m³/N from r = {cell:.3g} m to "
            f"{size:.3g} m, and the integral of greens_function(r) r by {by_greens_function:.6g} "
            "m³/N; they have to agree"
        )
    return ""


def _growth(greens_function: Radial, start: float, end: float) -> float:
    """Return ∫ G(r) r dr [m³/N] between two radii [m]."""
    edges = np.linspace(np.log(start), np.log(end), 2 + int(np.log(end / start)))
    nodes, weights = np.polynomial.legendre.leggauss(16)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    r = np.exp(middle[:, None] + half[:, None] * nodes)
    return float((half[:, None] * weights * greens_function(r) * r**2).sum())


def _nodes(start: float, end: float) -> Array:
    number = int(np.log(end / start) / _STEP)
    nodes: Array = end * np.exp(_STEP * np.arange(-number, 1))
    return nodes


def _trapezoid(integrand: Array) -> float:
    return float(_STEP * (integrand.sum() - (integrand[0] + integrand[-1]) / 2))
