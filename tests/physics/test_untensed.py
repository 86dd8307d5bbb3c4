"""Contact without tension against closed forms, and these against facts that they do not hold."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq

from pellicle_plugins.closed_forms.hertz import ellipse, sphere
from pellicle_plugins.closed_forms.sneddon import cone
from tests.tables_of_runs import half_space, heights, paraboloid
from tests.tables_of_runs import step as solved


def _step(
    solver: str, points: Any, size: Any, indenter: dict[str, Any], **loading: Any
) -> xr.Dataset:
    return solved(
        solver,
        grid={"points": points, "size": size},
        kernel=half_space(),
        indenter=indenter,
        loading=loading,
        corrections=[{"type": "yastrebov"}],
    )


def test_hertz_force_area_and_pressure(solver: str) -> None:
    """A paraboloid at N = 256 gives Hertz's force to 1e-3 and his pressure where it is smooth."""
    true = sphere(1.0, 1.0, depth=0.01)
    step = _step(solver, 256, 3 * true.semi_x, paraboloid(), depth=0.01)
    assert float(step["force"]) == pytest.approx(true.force, rel=1e-3)
    assert float(step["contact_area_yastrebov"]) == pytest.approx(np.pi * true.semi_x**2, rel=5e-3)
    x, y = step["x"].values[:, None], step["y"].values[None]
    inner = x**2 + y**2 < (0.9 * true.semi_x) ** 2
    expected = true.pressure(x, y)
    assert np.abs(step["pressure"].values - expected)[inner].max() < 1e-3 * true.peak_pressure


def test_hertz_ellipse_on_rectangular_cells(solver: str) -> None:
    """A quadric on 96 × 64 cells of aspect ratio 3:4 gives Hertz's elliptic force and area."""
    true = ellipse(2.0, 1.0, 1.0, depth=0.01)
    size = [2.4 * true.semi_x, 2.4 * true.semi_x * 8 / 9]
    indenter = {"type": "quadric", "radius_x": 2.0, "radius_y": 1.0}
    step = _step(solver, [96, 64], size, indenter, depth=0.01)
    assert float(step["force"]) == pytest.approx(true.force, rel=1e-3)
    area = np.pi * true.semi_x * true.semi_y
    assert float(step["contact_area_yastrebov"]) == pytest.approx(area, rel=1e-2)


def test_sneddon_cone(solver: str) -> None:
    """A cone gives Sneddon's force."""
    angle = np.radians(75)
    true = cone(angle, 1.0, depth=0.01)
    indenter = {"type": "cone", "half_angle": angle}
    step = _step(solver, 128, 3 * true.contact_radius, indenter, depth=0.01)
    assert float(step["force"]) == pytest.approx(true.force, rel=1e-3)


def test_the_sphere_is_stiffer_than_its_paraboloid_by_the_quartic_term(solver: str) -> None:
    """The exact sphere differs from the paraboloid as the next term of its profile says."""
    depth = 0.05
    quadratic = _step(solver, 64, 0.7, paraboloid(), depth=depth)
    exact = _step(solver, 64, 0.7, {"type": "sphere", "radius": 1.0}, depth=depth)
    # Sneddon 1965, with L = ln((R+a)/(R−a)): δ = aL/2, F = E*[(R² + a²)L/2 − aR].
    a = brentq(lambda a: a * np.arctanh(a) - depth, 1e-3, 0.9)
    true = (1 + a**2) * np.arctanh(a) - a
    hertz = sphere(1.0, 1.0, depth=depth).force
    ratio = float(exact["force"]) / float(quadratic["force"])
    assert ratio == pytest.approx(true / hertz, rel=2e-4)
    assert abs(true / hertz - 1) > 4e-3


def test_flat_punch_force_converges_at_first_order(solver: str) -> None:
    """The force of a punch, singular at its rim, comes near 2 E* a δ at least as 1/N."""
    points, errors, punch = np.array([16, 32, 64, 128]), [], {"type": "flat_punch", "radius": 1.0}
    for n in points:
        # Several offsets of the rim against the grid, as a circle of cells is never quite round.
        steps = [_step(solver, n, size, punch, depth=0.01) for size in np.linspace(2.2, 2.5, 7)]
        errors.append(np.sqrt(np.mean([(float(step["force"]) / 0.02 - 1) ** 2 for step in steps])))
    assert -np.polyfit(np.log(points), np.log(errors), 1)[0] > 0.8
    assert errors[-1] < 1e-2


@pytest.mark.parametrize("width", [1, 4])
def test_westergaard_wavy_contact(width: int, solver: str) -> None:
    """A cosine wave touches over Westergaard's width, also on a grid of one cell across.

    The mean pressure is p* sin²(πa/λ), p* = πE*Δ/λ, and the pressure at ψ = πx/λ
    2p* cos ψ √(sin²(πa/λ) − sin²ψ) (Johnson 1985, section 13.2).
    """
    n, amplitude, modulus = 256, 1e-3, 1.0
    full, share = np.pi * modulus * amplitude, np.sin(0.2 * np.pi) ** 2
    x = (np.arange(n) + 0.5) / n - 0.5
    root = np.sqrt(np.maximum(0.0, share - np.sin(np.pi * x) ** 2))
    wave = np.repeat(amplitude * np.cos(2 * np.pi * x)[:, None], width, axis=1)
    step = solved(
        solver,
        grid={"points": [n, width], "size": [1.0, 0.3], "boundary": "periodic"},
        kernel=half_space(modulus),
        indenter=heights(wave),
        loading={"mean_pressure": full * share},
    )
    assert float(step["contact_fraction"]) == pytest.approx(0.4, abs=2 / n)
    pressure, expected = step["pressure"].values[:, 0], 2 * full * np.cos(np.pi * x) * root
    inner = np.abs(x) < 0.18
    assert np.abs(pressure - expected)[inner].max() < 1e-3 * expected.max()


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
