"""The contact of Maugis with a Dugdale zone against elasticity, limits and a published fit."""

from math import pi

import numpy as np
import pytest

from pellicle_plugins.axisymmetric.adhesive_contact import Adhesion
from pellicle_plugins.closed_forms.maugis import (
    DugdaleContact,
    dugdale_contact,
    transition_parameter,
)
from pellicle_plugins.indenters.of_revolution import Paraboloid

R, E, W = 2e-3, 3e4, 0.05
STRENGTH = 1 / transition_parameter(R, E, W, 1.0)
"""σ₀ [Pa] at which λ is 1."""
A0 = (W * R**2 / E) ** (1 / 3)


def contact(transition: float, a: object) -> DugdaleContact:
    """Return the contact at λ and radii in units of (wR²/E*)^(1/3)."""
    return dugdale_contact(R, E, W, transition * STRENGTH, np.asarray(a) * A0)


@pytest.mark.parametrize("transition", [0.01, 0.5, 1.0, 3.0, 30.0])
@pytest.mark.parametrize("radius", [1e-3, 0.5, 2.0])
def test_gap_depth_and_force_are_those_of_its_tractions(transition: float, radius: float) -> None:
    """Sneddon's integrals of the tractions give a gap of w/σ₀ at the end of the zone."""
    state = contact(transition, radius)
    a, c, depth, force = (float(value) for value in state)
    strength = transition * STRENGTH
    # φ(x) = ∫ p r dr / √(r² − x²) is E*/2 (δ − x²/R) in contact and −σ₀ √(c² − x²) in the zone.
    assert E / 2 * (depth - a**2 / R) == pytest.approx(-strength * np.sqrt(c**2 - a**2), rel=1e-8)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    top = np.arcsin(a / c)
    psi = top * (nodes + 1) / 2
    x = c * np.sin(psi)
    inside = weights @ (E / 2 * (depth - x**2 / R)) * top / 2
    displacement = 4 / (pi * E) * (inside - strength * (c - a))
    assert displacement - depth + c**2 / (2 * R) == pytest.approx(W / strength, rel=1e-7)
    psi = top + (pi / 2 - top) * (nodes + 1) / 2
    zone = weights @ (c**2 * np.cos(psi) ** 2) * (pi / 2 - top) / 2
    carried = 2 * E * (depth * a - a**3 / (3 * R)) - 4 * strength * zone
    assert force == pytest.approx(carried, rel=1e-8, abs=1e-9 * W * R)


def test_a_point_contact_is_the_limit_of_small_ones() -> None:
    """All numbers are continuous at a = 0."""
    for transition in (0.1, 1.0, 10.0):
        point, small = contact(transition, 0.0), contact(transition, 1e-6)
        assert np.array(point[1:]) == pytest.approx(np.array(small[1:]), rel=1e-4)


def test_a_short_range_is_the_limit_of_johnson_kendall_and_roberts() -> None:
    """The difference at a radius falls as 1/λ², and is nothing at λ = 1e6."""
    a = np.array([0.5, 1.5, 3.0])
    jkr = Adhesion(Paraboloid(radius=R), E, 0.0, W).equilibrium(a * A0)
    far = contact(1e6, a)
    assert far.force == pytest.approx(jkr.force, abs=1e-5 * pi * W * R)
    assert far.depth == pytest.approx(jkr.depth, abs=1e-5 * A0**2 / R)
    assert far.zone_radius == pytest.approx(a * A0, rel=1e-5)
    errors = [np.abs(contact(value, a).force - jkr.force).max() for value in (30.0, 60.0)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.01)


def test_a_long_range_is_the_limit_of_derjaguin_muller_and_toporov() -> None:
    """Hertz contact pulled by 2πwR, and −2πwR, that of a rigid sphere, at a point (Bradley)."""
    a = np.array([0.0, 0.5, 2.0])
    near = contact(1e-7, a)
    force = 4 / 3 * E * (a * A0) ** 3 / R - 2 * pi * W * R
    assert near.force == pytest.approx(force, abs=2e-3 * pi * W * R)
    assert near.depth == pytest.approx((a * A0) ** 2 / R, abs=1e-3 * A0**2 / R)


def test_pull_off_goes_from_that_of_a_rigid_sphere_to_that_of_a_soft_one() -> None:
    """The lowest force grows from −2πwR to −1.5 πwR with λ."""
    a = np.linspace(0, 2.5, 251)
    lowest = [contact(value, a).force.min() for value in (1e-5, 0.01, 0.1, 0.5, 1, 3, 10, 1e4)]
    assert (np.diff(lowest) > 0).all()
    assert lowest[0] == pytest.approx(-2 * pi * W * R, rel=0.01)
    assert lowest[-1] == pytest.approx(-1.5 * pi * W * R, rel=1e-3)
