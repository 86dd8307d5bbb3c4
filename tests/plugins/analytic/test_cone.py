"""Cone without tension."""

import numpy as np
import pytest

from pellicle_plugins.closed_forms.sneddon import cone

E = 3.0e4


def test_cone_pressure_carries_the_force() -> None:
    """The pressure of the cone integrates to its force."""
    contact = cone(1.2, E, depth=2e-4)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    u = (nodes + 1) / 2
    r = contact.contact_radius * (1 - (1 - u**2) ** 2)
    jacobian = contact.contact_radius * 4 * u * (1 - u**2) / 2
    force = weights @ (2 * np.pi * r * contact.pressure(r) * jacobian)
    assert force == pytest.approx(contact.force, rel=1e-10)


def test_cone_stiffness_is_twice_modulus_times_radius() -> None:
    """dF/dδ = 2 E* a for the cone."""
    low, high = (cone(1.2, E, depth=2e-4 * (1 + h)) for h in (-1e-3, 1e-3))
    slope = (high.force - low.force) / (high.depth - low.depth)
    assert slope == pytest.approx(2 * E * cone(1.2, E, depth=2e-4).contact_radius, rel=1e-9)
