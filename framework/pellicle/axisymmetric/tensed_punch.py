"""Contact of a rigid flat punch with a half-space under surface tension.

The integral equation of ``equation`` with a flat profile is
∫_{−a}^{a} φ(t) K(x − t) dt = E* δ, P = π ∫ φ.  Its solution approaches C (a² − t²)^(−1/2)
at the edge, which represents a line load of total force π² C on the rim of the punch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pellicle.errors import ConvergenceError

from .arguments import not_negative, positive, single
from .equation import LEVELS, influence, without_negligible
from .panels import gauss, graded, joined
from .product_integration import clustering, collocation

TOLERANCE = 1e-9
RING_TOLERANCE = 1e-6


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


def unit_forces(ratio: float, level: int) -> tuple[float, float]:
    """Return P and the ring force over E* a δ at s/a = ratio, zero included, on a mesh level."""
    if not ratio:
        return 2.0, 0.0
    order, finest = LEVELS[level]
    panels = graded(order, finest * np.sqrt(min(1.0, ratio)), 1.0)
    matrix = collocation(panels, influence(ratio, 0), clustering(ratio), 1)
    y = np.linalg.solve(matrix, np.ones(joined(panels).psi.size)).reshape(len(panels), order)
    _, unit, to_legendre = gauss(order)
    halves = np.array([panel.length / 2 for panel in panels])
    force = 2 * np.pi * float(halves @ y @ unit)
    return force, np.pi**2 * float(np.sum(to_legendre @ y[-1]))


def punch(
    radius: float,
    reduced_modulus: float,
    tension: float,
    *,
    depth: float | None = None,
    force: float | None = None,
) -> TensedPunch:
    """Return the contact of a flat punch of a = ``radius`` [m] for a depth [m] or a force [N].

    E* = E / (1 − ν²) [Pa] is the reduced modulus; the tension τ₀ [N/m] may be zero.
    """
    positive(radius=radius, reduced_modulus=reduced_modulus)
    not_negative(tension=tension)
    quantity, value = single(depth=depth, force=force)
    ratio = without_negligible(2 * tension / reduced_modulus / radius)
    levels = [unit_forces(ratio, level) for level in (0, 1)]
    if not _agree(*levels):
        levels.append(unit_forces(ratio, 2))
        if not _agree(*levels[1:]):
            raise ConvergenceError(f"the punch at s/a = {ratio:g} does not converge: {levels}")
    stiffness, ring = (value * reduced_modulus * radius for value in levels[-1])
    depth = value if quantity == "depth" else value / stiffness
    return TensedPunch(radius, depth, stiffness * depth, ring * depth)


def _agree(old: tuple[float, float], new: tuple[float, float]) -> bool:
    return (
        abs(new[0] - old[0]) <= TOLERANCE * new[0]
        and abs(new[1] - old[1]) <= RING_TOLERANCE * new[1]
    )
