"""The displacement under a Gaussian, by the compliance G(q) and by the closed form of a kernel.

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

_STEP = 0.1  # of the logarithms
_WIDEST = 9.0  # widths beyond which a Gaussian is 0
_LOWEST_WAVE = 1e-14  # over 1/width: long elastocapillary lengths contribute as log q
_LOWEST_RADIUS = 1e-4  # over width


def displacement_of_centre(compliance: Callable[[Array], Array], width: float) -> float:
    """Return the displacement [m] of the centre of a Gaussian pressure of 1 Pa."""
    q = _nodes(_LOWEST_WAVE) / width
    values = compliance(q)
    # Formulas may cancel for the longest waves, which hardly contribute.
    finite = np.where(np.isfinite(values), values, 0.0)
    return width**2 * _trapezoid(finite * np.exp(-((q * width) ** 2) / 2) * q**2)


def displacement_by_primitive(primitive: Callable[[Array], Array], width: float) -> float:
    """Return the same displacement [m] from the radial primitive."""
    r = _nodes(_LOWEST_RADIUS) * width
    rings = primitive(r) * np.exp(-((r / width) ** 2) / 2) * r**2
    return 2 * np.pi / width**2 * _trapezoid(rings)


def _nodes(start: float) -> Array:
    number = int(np.log(_WIDEST / start) / _STEP)
    return np.asarray(_WIDEST * np.exp(_STEP * np.arange(-number, 1)))


def _trapezoid(integrand: Array) -> float:
    return float(_STEP * (integrand.sum() - (integrand[0] + integrand[-1]) / 2))
