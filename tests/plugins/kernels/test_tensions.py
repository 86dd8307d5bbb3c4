"""Skins that are tensed more one way, on periodic domains."""

from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle import Grid, Problem
from pellicle.components.calls import solution_of
from pellicle.surface import operator_of
from tests.tables_of_runs import half_space, pressing, relaxing, self_affine

T = (0.02, 0.08)
BALL = {"type": "paraboloid", "radius": "1 mm"}


def skin(tension: Any, **fields: Any) -> Any:
    """Return the kernel of a half-space of 10 kPa under a skin."""
    return pl.kernel("tensed_membrane", **{"reduced_modulus": 1e4} | fields, tension=tension)


def coated(tension: Any, **fields: Any) -> Any:
    """Return the same as a coat."""
    solid = {"type": "half_space", "reduced_modulus": 1e4}
    return pl.kernel("coated", tension=tension, substrate=solid, **fields)


def step(kernel: Any, **parts: Any) -> Any:
    """Return the last step of a sphere that is pressed into a periodic surface."""
    run = pressing(64, "0.4 mm", kernel, BALL, boundary="periodic", force="20 uN")
    return pl.run(pl.Run(**run | parts), progress=False).dataset.isel(step=-1)


B = 3e-12


@pytest.mark.parametrize(("make", "bending"), [(skin, {}), (coated, {}), (coated, {"bending": B})])
@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0])
def test_full_contact_with_any_wave(make: Any, bending: dict[str, float], angle: float) -> None:
    """The pressure is k times the wave, k = E*q/2 + T₁q∥² + T₂q⊥² + Bq⁴."""
    grid = Grid(points=[24, 20], size=[1e-4, 0.8e-4], boundary="periodic")
    operator = operator_of(make(T, angle=angle, **bending), grid)
    x, y = grid.coordinates()
    for m, n in ((1, 0), (0, 1), (2, 3), (-4, 1)):
        qx, qy = 2 * np.pi * m / grid.size[0], 2 * np.pi * n / grid.size[1]
        wave = np.cos(qx * x + qy * y)
        along, across = np.dot([np.cos(angle), np.sin(angle)], [qx, qy]), 0.0
        across = np.hypot(qx, qy) ** 2 - along**2
        k = 5e3 * np.hypot(qx, qy) + T[0] * along**2 + T[1] * across
        k += bending.get("bending", 0.0) * np.hypot(qx, qy) ** 4
        np.testing.assert_allclose(operator(k * wave), wave, atol=1e-9)


def test_full_contact_of_a_rough_surface() -> None:
    """In a run: depth, pressure and area are those of the waves."""
    rough = self_affine("1 um", 0.8, "50 um", seed=1)
    loading = {"mean_pressure": "3 kPa"}
    data = step(skin(T, angle=0.4), indenter=rough, loading=loading)
    assert data["contact"].all()
    heights = (data["displacement"] - data["gap"]).values
    grid = Grid(points=64, size=4e-4, boundary="periodic")
    pressure = data["pressure"].values - data["mean_pressure"].item()
    moved = operator_of(skin(T, angle=0.4), grid)(pressure)
    np.testing.assert_allclose(moved, heights - heights.mean(), atol=1e-6 * np.ptp(heights))


def test_equal_tensions_are_one() -> None:
    """They are stored as one, so nothing differs: the free boundary, the closed form, the bits."""
    both, one = skin(["20 mN/m", "20 mN/m"]), skin("20 mN/m")
    assert both == one
    assert both.is_isotropic
    assert coated([0.02, 0.02]) == coated(0.02)
    run = {"grid": {"points": 16, "size": "0.4 mm"}, "loading": {"depth": "5 um"}}
    assert step(both, **run)["force"].item() == step(one, **run)["force"].item()


def test_a_quarter_of_a_turn_swaps_the_axes() -> None:
    """So does a mirror of the domain; half a turn changes nothing."""
    first, turned = step(skin(T)), step(skin(T[::-1]))
    np.testing.assert_array_equal(first["contact"].values, turned["contact"].values.T)
    for same in (skin(T, angle="180 degree"), skin(T[::-1], angle="90 degree")):
        np.testing.assert_allclose(step(same)["pressure"], first["pressure"], rtol=1e-6)


def test_without_a_solid_stretched_coordinates_make_it_isotropic() -> None:
    """T₁u_xx + T₂u_yy is the Laplacian of x/√T₁, y/√T₂: the same cells, in each of them."""
    rng = np.random.default_rng(2)
    grid = Grid(points=[32, 24], size=[1e-4, 0.9e-4], boundary="periodic")
    lengths = tuple(size / np.sqrt(t) for size, t in zip(grid.size, T, strict=True))
    stretched = Grid(points=grid.points, size=lengths, boundary="periodic")
    profile = -np.cumsum(np.cumsum(rng.random(grid.shape), 0), 1)
    profile = profile - profile[::-1, ::-1]
    profile = 1e-7 * (profile - profile.max()) / np.ptp(profile)
    pressures = []
    for domain, kernel in (
        (grid, skin(T, reduced_modulus=1e-9)),
        (stretched, skin(1.0, reduced_modulus=1e-9)),
    ):
        problem = Problem(domain, operator_of(kernel, domain), profile, pl.Depth(2e-8))
        solver = pl.solver("active_set", tolerance=1e-10)
        pressures.append(solution_of(solver, problem, None, lambda *_: None).pressure)
    assert pressures[0].any()
    np.testing.assert_allclose(pressures[0], pressures[1], atol=1e-7 * pressures[1].max())


@pytest.mark.parametrize("make", [skin, coated])
def test_depths_and_areas_lie_between_those_of_both(make: Any) -> None:
    """And the contact is longer along the lesser tension, which is that along x."""
    low, high, both = (step(make(t)) for t in (T[0], T[1], T))
    assert high["depth"] < both["depth"] < low["depth"]
    areas = sorted(float(data["contact_area"]) for data in (low, high))
    assert areas[0] < both["contact_area"] < areas[1]
    assert both["semi_major_axis"] > 1.05 * both["semi_minor_axis"]
    assert abs(both["major_axis_angle"]) < 0.01


@pytest.mark.filterwarnings("ignore:step 1. converged; the contact area")
def test_without_a_solid_the_contact_of_a_sphere_is_an_ellipse() -> None:
    """Its axes are as √(T₂/T₁): an ellipse of uniform pressure, in stretched coordinates."""
    data = step(
        skin([0.025, 0.05], reduced_modulus=20.0),
        grid={"points": 256, "size": "0.8 mm", "boundary": "periodic"},
        loading={"contact_radius": "50 um"},
    )
    slenderness = float(data["semi_major_axis"] / data["semi_minor_axis"])
    assert slenderness == pytest.approx(np.sqrt(2), rel=0.04)
    middle = data["pressure"].values[124:132, 124:132]
    assert np.ptp(middle) < 0.02 * middle.mean()
    # The curvature 1/R times both tensions; the solid adds a little.
    assert middle.mean() == pytest.approx(75.0, rel=0.05)


def test_no_tension_one_way_is_allowed() -> None:
    """The solid carries what the skin does not."""
    data = step(skin([0.0, 0.05]))
    assert bool(data["converged"])
    assert data["depth"] < step(skin(0.0))["depth"]


def test_a_free_boundary_a_solid_that_relaxes_and_a_fit_are_refused() -> None:
    """Each before anything is solved."""
    with pytest.raises(pl.ConfigError, match="yields equally in all directions"):
        step(skin(T), grid={"points": 16, "size": "0.4 mm"})
    with pytest.raises(pl.ConfigError, match="symbol"):
        skin(T).compliance(np.ones(2))
    with pytest.raises(pl.ConfigError, match="has a skin"):
        pl.kernel("viscoelastic", solid=skin(T), relaxation=[{"fraction": 0.5, "time": 1}])
    depth = np.linspace(0, 1e-6, 50)
    for given in ({"tension": list(T)}, {"angle": 0.5}):
        with pytest.raises(pl.ConfigError) as caught:
            pl.fit(
                depth,
                depth**1.5,
                indenter="sphere",
                radius="5 um",
                kernel={"type": "tensed_membrane", **given},
            )
        (field,) = given
        assert caught.value.problems[0].field == f"kernel.{field}"


def test_a_solid_that_relaxes_under_two_tensions() -> None:
    """The skin does not; in the end it carries more than it did."""
    solid = relaxing(half_space(1e4), 0.9, 1.0)
    kernel = pl.kernel("coated", tension=T, substrate=solid)
    loading = {"depth": ["5 um", "5 um"], "time": [0.0, 1e6]}
    late = step(kernel, loading=loading)
    expected = step(skin(T, reduced_modulus=1e3), loading={"depth": "5 um"})
    assert late["force"].item() == pytest.approx(expected["force"].item(), rel=1e-6)


def test_derivatives_by_each_tension() -> None:
    """Each tension has a path of its own."""
    paths = ["kernel.tension.0", "kernel.tension.1", "kernel.angle"]
    loading = {"depth": ["5 um"]}
    data = step(skin(T, angle=0.3), gradient=paths, loading=loading)
    for index, path in enumerate(paths):
        forces = []
        for sign in (1, -1):
            tension, angle = list(T), 0.3
            if index < 2:
                tension[index] *= 1 + sign * 1e-4
            else:
                angle *= 1 + sign * 1e-4
            forces.append(step(skin(tension, angle=angle), loading=loading)["force"].item())
        change = 2e-4 * (T[index] if index < 2 else 0.3)
        expected = (forces[0] - forces[1]) / change
        found = data[f"force_by_{path.replace('.', '_')}"].item()
        assert found == pytest.approx(expected, rel=1e-3)
