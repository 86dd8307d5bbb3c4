"""Hertz contact against facts that its formulas do not contain."""

import numpy as np
import pytest

from pellicle_plugins.closed_forms.hertz import ellipse, sphere

R, E = 1.5e-3, 2.0e4


def test_pressure_carries_the_force() -> None:
    """The pressure of an elliptic contact integrates to its force."""
    contact = ellipse(R, 3 * R, E, depth=1e-5)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    theta = np.pi / 4 * (nodes + 1)
    x = contact.semi_x * np.sin(theta)
    # Across a chord of half-width b cos θ the pressure is half an ellipse.
    chord = np.pi / 2 * contact.pressure(x) * contact.semi_y * np.cos(theta)
    force = 2 * np.pi / 4 * weights @ (chord * contact.semi_x * np.cos(theta))
    assert force == pytest.approx(contact.force, rel=1e-12)


def test_stiffness_is_twice_modulus_times_radius() -> None:
    """dF/dδ = 2 E* a for the sphere."""
    low, high = (sphere(R, E, depth=1e-5 * (1 + h)) for h in (-1e-4, 1e-4))
    slope = (high.force - low.force) / (high.depth - low.depth)
    assert slope == pytest.approx(2 * E * sphere(R, E, depth=1e-5).semi_x, rel=1e-8)


def test_round_ellipse_is_a_sphere() -> None:
    """Radii that differ by 1e-9 give the contact of a sphere."""
    round_, almost = sphere(R, E, force=1e-3), ellipse(R, R * (1 + 1e-9), E, force=1e-3)
    for name in ("semi_x", "semi_y", "depth", "peak_pressure"):
        assert getattr(almost, name) == pytest.approx(getattr(round_, name), rel=3e-9)


@pytest.mark.parametrize("ratio", [0.9, pytest.param(0.1, marks=pytest.mark.slow), 1e-4])
def test_surface_follows_the_ellipsoid(ratio: float) -> None:
    """The potential of the pressure, integrated directly, has the two curvatures."""
    contact = ellipse(R, ratio * R, E, depth=1e-6)
    a, b = contact.semi_x, contact.semi_y
    nodes, weights = np.polynomial.legendre.leggauss(400)
    angle = np.pi / 4 * (nodes + 1)
    # Directions θ with tan θ = (b/a) tan(angle) follow the ellipse however slender.
    theta = np.arctan(b / a * np.tan(angle))
    jacobian = np.pi / 4 * (b / a) / np.cos(angle) ** 2 * np.cos(theta) ** 2
    inverse = np.cos(theta) ** 2 / a**2 + np.sin(theta) ** 2 / b**2
    # u = (1 / πE*) ∫ dθ of the pressure along the chord, half an ellipse, through (x, y).
    chord = contact.peak_pressure / E * weights * jacobian / np.sqrt(inverse)
    depth = chord.sum()
    curvature_x = chord @ (np.sin(theta) ** 2 / (a * b) ** 2 / inverse)
    curvature_y = chord @ (np.cos(theta) ** 2 / (a * b) ** 2 / inverse)
    assert depth == pytest.approx(contact.depth, rel=1e-8)
    assert curvature_x == pytest.approx(1 / (2 * R), rel=1e-8)
    assert curvature_y == pytest.approx(1 / (2 * ratio * R), rel=1e-8)


def test_given_force_returns_given_depth() -> None:
    """Depth → force → depth closes, for sphere and ellipse."""
    assert sphere(R, E, force=sphere(R, E, depth=1e-5).force).depth == pytest.approx(1e-5)
    force = ellipse(R, 2 * R, E, depth=1e-5).force
    assert ellipse(R, 2 * R, E, force=force).depth == pytest.approx(1e-5)
