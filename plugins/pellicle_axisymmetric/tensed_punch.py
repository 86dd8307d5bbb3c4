"""Contact of a rigid flat punch with a half-space under surface tension."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi, sqrt

import numpy as np

from .arguments import not_negative, positive, single
from .reciprocity import punch_slope, punch_stiffness


@dataclass(frozen=True)
class TensedPunch:
    """Contact of a flat punch, without its pressure distribution."""

    contact_radius: float
    """a, the radius of the punch [m]."""
    depth: float
    """δ [m]."""
    force: float
    """P [N], including the ring force."""
    ring_force: float
    """Part of the force that the rim carries as a line load [N]; 0 without tension."""


def punch(
    radius: float,
    reduced_modulus: float,
    tension: float,
    *,
    depth: float | None = None,
    force: float | None = None,
) -> TensedPunch:
    """Return the contact of a flat punch of a = ``radius`` [m] for a depth [m] or a force [N].

    E* = E / (1 − ν²) [Pa] is the reduced modulus; the tension τ₀ [N/m] may be zero.  With the
    stiffness k the line load N at the rim is that of k′ = 4πa N² / (2τ₀ δ²): its energy release
    rate is N² / 2τ₀.
    """
    positive(radius=radius, reduced_modulus=reduced_modulus)
    not_negative(tension=tension)
    quantity, value = single(depth=depth, force=force)
    ratio = np.array([2 * tension / reduced_modulus / radius])
    log, slope = float(punch_stiffness(ratio)[0][0]), reduced_modulus * float(punch_slope(ratio)[0])
    stiffness = 2 * reduced_modulus * radius * exp(log)
    ring = sqrt(2 * pi * radius * tension * slope)
    depth = value if quantity == "depth" else value / stiffness
    return TensedPunch(radius, depth, stiffness * depth, ring * depth)
