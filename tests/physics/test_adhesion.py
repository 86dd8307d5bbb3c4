"""Adhesive contact against closed theory, and what must not change about it."""

from math import pi
from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.runs.terms.adhesion import limit_of
from tests.adhesive_paths import (
    FORCE,
    JKR,
    retracted,
    retraction_cases,
    solved,
    theory,
    wave_pressure,
    wavy,
)
from tests.random_adhesion import SAME, random_run, verdicts
from tests.tables_of_runs import heights, paraboloid, tensed

LINEAR = {"type": "linear", "work_of_adhesion": 1.0, "strength": 2.0}
DUGDALE = {"type": "dugdale", "work_of_adhesion": 1.0, "strength": 1.0}
LAWS = JKR, LINEAR, DUGDALE, {"type": "exponential", "work_of_adhesion": 1.0, "range": 0.4}
# The units E* = R = w = 1 have slopes beyond the theory, and random problems have few cells.
pytestmark = pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("length", "name"), [(0.0, "a = 1.5"), (0.1, "F = 0"), (1.0, "a = 1.5"), (10.0, "a = 1.5")]
)
def test_a_retracted_paraboloid_is_the_closed_theory(length: float, name: str) -> None:
    """Force and contact radius are right to 0.02 πwR and 3 % with 128 points."""
    size, depth, force, radius = retraction_cases(length)[name]
    step = retracted(128, length, depth, size)
    assert step["status_code"].item() == "STEEP"
    assert abs(float(step["force"]) - force) < 0.02 * FORCE
    assert float(step["contact_radius"]) == pytest.approx(radius, rel=0.03)
    # Two wider zones give the limit of none, and the error, larger than it is by chance.
    error = abs(float(step["force"]) - force)
    assert abs(float(step["force_extrapolated"]) - force) < 0.0065 * FORCE
    assert error <= float(step["force_error"]) < 0.03 * FORCE


@pytest.mark.slow
@pytest.mark.parametrize(("length", "radius", "size"), [(0.03, 0.9, 4.0), (0.03, 1.8, 6.0)])
def test_errors_beside_the_cases_of_the_benchmark(
    length: float, radius: float, size: float
) -> None:
    """The worst of other lengths and radii, 128 points, are as docs/adhesion.md tells them."""
    closed = theory(length).equilibrium(radius)
    step = retracted(128, length, float(closed.depth), size)
    error = abs(float(step["force"]) - float(closed.force)) / FORCE
    assert 0.015 < error < 0.047
    assert abs(float(step["force_extrapolated"]) - float(closed.force)) < 0.0165 * FORCE
    assert float(step["force_error"]) > 0.7 * error * FORCE


@pytest.mark.parametrize(
    ("interaction", "length", "most"), [(JKR, 1.0, 0.002), (DUGDALE, 0.1, 0.005)]
)
def test_approach_and_retraction_are_one_curve(
    interaction: dict[str, Any], length: float, most: float
) -> None:
    """The lattice does not pin the edge: at depths ≥ 0 the path back has the same forces."""
    depths = [0.05, 0.3, 0.6, 0.9]
    path = solved(64, length, [*depths, *depths[-2::-1]], interaction=interaction, size=7.0)
    force = path["force"].values / FORCE
    np.testing.assert_allclose(force[4:], force[2::-1], atol=most)
    assert np.ptp(force[:4]) > 0.1
    assert not path["jumped"].values[1:].any()


@pytest.mark.parametrize(
    ("seed", "averaged"), [(33, False), pytest.param(218, True, marks=pytest.mark.slow)]
)
def test_a_cell_that_just_touches_is_solved(seed: int, averaged: bool) -> None:
    """Wall pressure and attraction of a single cell cancel: no pressure, and no displacement.

    A law that is averaged over the cells pulls at those beside it too.
    """
    path = pl.run(random_run(seed), progress=False).dataset
    step = path.isel(step=3)
    assert int(step["contact"].sum()) == 1
    assert float(step["depth"]) == 0.0
    pull = abs(float(step["pressure"].sum())) / float(step["wall_pressure"].sum())
    assert (0.01 < pull < 0.1) if averaged else (pull < 1e-12)
    assert path["status_code"].values[3] == "COARSE"


@pytest.mark.slow
def test_a_jump_of_one_asperity_is_named() -> None:
    """Of two bumps the lower one jumps in after and off before the other; the sum is the loss."""
    x = (np.arange(40) + 0.5) / 10 - 2
    bumps = [-((x[:, None] - at) ** 2 + x**2) / 12 - low for at, low in ((1.1, 0.0), (-1.1, 0.025))]
    down = np.arange(-0.01, 0.051, 0.01)
    path = solved(
        40, 0.0, [*down, *np.arange(0.04, -0.071, -0.01)], size=4.0,
        interaction={"type": "jkr", "work_of_adhesion": 0.0025, "estimate_error": False},
        indenter=heights(np.maximum(*bumps)),
    )  # fmt: skip
    patches = path["patches"].values
    jumps = np.flatnonzero(path["jumped"].values)
    # Both jump in and off again, one after the other.
    assert patches[jumps].tolist() == [1, 2, 1, 0]
    assert np.flatnonzero(np.diff(patches)).tolist() == (jumps - 1).tolist()
    codes = path["status_code"].values
    assert codes[jumps].tolist() == ["CONVERGED", "JUMPED", "JUMPED", "CONVERGED"]
    assert "JUMPED" not in np.delete(codes, jumps)
    assert path["converged"].values.all()
    message = str(path["status"].values[jumps[2]])
    assert "a part of the contact jumped after the last step and lost" in message
    force, depth, energy = (path[name].values for name in ("force", "depth", "energy"))
    work = float((0.5 * (force[1:] + force[:-1]) * np.diff(depth)).sum())
    lost = work - (energy[-1] - energy[0])
    assert np.nansum(path["jump_energy"].values) == pytest.approx(lost, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("length", [0.3, 3.0])
def test_pull_off_on_few_cells_is_within_its_error(length: float) -> None:
    """On four cells the force is off by a tenth, which two wider zones alone do not see."""
    end = theory(length).instability()
    steps = [0.3, *(float(end.depth) + np.array([0.3, 0.1, 0.0, -0.1, -0.2, -0.3]))]
    result = pl.Result(solved(24, length, steps, size=6 * float(end.contact_radius)))
    summary = result.path_summary
    error = abs(summary["pull_off"] - float(end.force))
    assert error > 0.05 * abs(summary["pull_off"])
    assert error < summary["pull_off_accuracy"] < 3 * error
    assert any("at pull-off" in message for message in result.warnings())


@pytest.mark.parametrize("length", [0.0, 0.3, 3.0])
def test_error_of_a_pull_on_few_cells_holds_the_theory(length: float) -> None:
    """Near the lowest force, on four cells in the radius."""
    contacts = theory(length).equilibrium(np.linspace(0.3, 3.5, 4000))
    end = theory(length).instability()
    depth, stable = float(end.depth) + 0.1, int(np.argmin(contacts.depth))
    path = solved(24, length, [0.3, depth], size=6 * float(end.contact_radius))
    force = float(np.interp(depth, contacts.depth[stable:], contacts.force[stable:]))
    error = abs(path["force"].values[-1] - force)
    assert error < path["force_error"].values[-1] < 5 * error


@pytest.mark.parametrize("bend", [0.0, 0.3, -0.1])
def test_limit_of_no_width(bend: float) -> None:
    """A line gives its intercept; of a bent one the error is that of the line that is farther off.

    F = 1 + 0.2 w + bend (w − 1)(w − 1.5): lines through neighbours at w = 0 are 1, and 1 − 3 bend.
    """
    widths = np.array([1.0, 1.5, 3.0])
    forces = 1 + 0.2 * widths + bend * (widths - 1) * (widths - 1.5)
    limit, off = limit_of([*forces])
    assert off == pytest.approx(max(0.2, abs(1 - 3 * bend - 1.2)))
    assert bend or limit == pytest.approx(1.0)


@pytest.mark.parametrize("across", [0.02, 0.3])
def test_zone_of_a_line_contact_is_as_wide_on_cells_of_any_shape(across: float) -> None:
    """The problem is plane, so cells may be as long as they like along the line."""
    law = {"type": "linear", "work_of_adhesion": 0.2, "strength": 0.5}
    path = solved(
        [96, 1], 0.0, [0.3 * across], quantity="force",
        size=(6.0, across), boundary="periodic", interaction=law,
    )  # fmt: skip
    assert path["zone_width"].values[-1] == pytest.approx(0.5, abs=1 / 16)


def test_a_step_across_the_lowest_force_does_not_jump() -> None:
    """The force is as low before as after it, and its curvature in between is no energy lost."""
    sticky = {**JKR, "estimate_error": False}
    down, up = [0.3, -0.3, -1.0, -1.2, -1.1], np.linspace(-1.1, -0.4, 9)[1:]
    coarse, fine = (
        solved(24, 0.0, [*down, *back], interaction=sticky)[["force", "jumped", "jump_energy"]]
        for back in (up[-1:], up)
    )
    force = coarse["force"].values
    assert abs(force[-1] - force[-2]) < 0.01 * FORCE
    assert float(fine["force"][5:].min()) < min(force[-2:]) - 0.01 * FORCE
    for path in (coarse, fine):
        assert not path["jumped"].values[1:].any()
        assert not path["jump_energy"].values[1:].any()


@pytest.mark.parametrize(
    ("law", "length", "reach", "steps", "jumps"),
    [
        ("linear", 0.5, 2.0, 6, 0),
        ("linear", 0.5, 2.0, 24, 0),
        ("jkr", 0.0, 0.0, 2, 2),
        pytest.param("dugdale", 0.0, 1.5, 6, 1, marks=pytest.mark.slow),
        pytest.param("exponential", 0.0, 0.7, 24, 2, marks=pytest.mark.slow),
        pytest.param("linear", 0.2, 0.8, 6, 2, marks=pytest.mark.slow),
        pytest.param("linear", 0.2, 0.8, 24, 2, marks=pytest.mark.slow),
    ],
)
def test_a_loss_that_falls_with_the_step_is_no_jump(
    law: str, length: float, reach: float, steps: int, jumps: int
) -> None:
    """A step that jumps loses as much in 16 parts; where contact begins smoothly none is named."""
    interaction = {"type": law, "work_of_adhesion": 1.0} | ({"range": reach} if reach else {})
    down = np.linspace(-2.5, 0.6, steps + 1)

    def path(depths: list[float]) -> Any:
        return solved(24, length, depths, interaction=interaction, size=7.0)

    depths = [*down, *down[-2::-1]]
    coarse = path(depths)
    named = np.flatnonzero(coarse["jumped"].values)
    assert named.size == jumps
    assert (coarse["jump_energy"].values[named] > 0).all()
    for index in named:
        parts = np.linspace(depths[index - 1], depths[index], 17)
        fine = path([*depths[: index - 1], *parts]).isel(step=slice(index - 1, None))
        force, depth, energy = (fine[name].values for name in ("force", "depth", "energy"))
        work = float((0.5 * (force[1:] + force[:-1]) * np.diff(depth)).sum())
        lost = work - (energy[-1] - energy[0])
        assert lost > 0.3 * float(coarse["jump_energy"][index])
        assert np.nansum(fine["jump_energy"].values) == pytest.approx(lost, rel=0.2)


@pytest.mark.parametrize("law", ["jkr", "dugdale"])
@pytest.mark.parametrize(
    ("prescribed", "values"), [("depth", [1e-6, 2e-6]), ("force", [1e-7, 2e-7])]
)
def test_a_step_that_is_held_does_not_jump(law: str, prescribed: str, values: list[float]) -> None:
    """The error that the tolerance leaves in the energy does not count as lost in a jump."""
    reach = {"range": "1 um"} if law == "dugdale" else {"estimate_error": False}
    path = solved(
        32, 0.0, [*values, values[1], values[1], *values[::-1], values[0]], size=80e-6,
        quantity=prescribed,
        kernel=tensed(1e4, 0.01),
        indenter=paraboloid(1e-4),
        interaction={"type": law, "work_of_adhesion": 1e-3, **reach},
    )  # fmt: skip
    assert path["converged"].values.all()
    assert path["jumped"].values.tolist() == [True, *[False] * 6]
    assert not path["jump_energy"].values[1:].any()


def _flat(
    points: int,
    size: float,
    kernel: dict[str, Any],
    work: float,
    values: list[float],
    quantity: str = "depth",
) -> xr.Dataset:
    """Return the path of a flat indenter that touches with all cells at once."""
    law = {"type": "jkr", "work_of_adhesion": work, "estimate_error": False}
    flat = heights(np.zeros((points, points)))
    return solved(
        points, 0.0, values, size=size, kernel=kernel, indenter=flat, interaction=law,
        quantity=quantity,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("points", "size", "kernel", "work", "depths"),
    [
        (1, 8e-5, {"type": "half_space", "reduced_modulus": 1e4}, 1e-3, [1e-6, 2e-6, 0.0, -1e-6]),
        (2, 1.0, tensed(1.0, 0.3), 0.01, [0.02, 0.05, 0.02, 0.0, -0.01]),
    ],
)
def test_steps_of_one_inner_solve_are_closed(
    points: int, size: float, kernel: dict[str, object], work: float, depths: list[float]
) -> None:
    """Not in single precision only, in which an inner solve adds to the displacement."""
    path = _flat(points, size, kernel, work, depths)
    assert path["converged"].values.all(), path["status"].values
    assert path["contact"].values.all()


@pytest.mark.parametrize("points", [1, 8])
@pytest.mark.parametrize("kernel", [tensed(1.0, 0.3), {"type": "winkler", "foundation": 1.0}])
def test_no_force_is_met_to_rounding(points: int, kernel: dict[str, object]) -> None:
    """Wall pressure and attraction of a flat cancel under no force, cell by cell."""
    path = _flat(points, 1.0, kernel, 0.01, [0.01, 0.05, 0.0, 0.02], "force")
    assert path["converged"].values.all(), path["status"].values
    assert path["contact"].values.all()


def test_full_contact_that_is_rigid_does_not_jump() -> None:
    """Any force leaves it as it is; round-off of its energy is no jump."""
    x = np.cos(2 * pi * (np.arange(22) + 0.5) / 22)
    layer = {"thickness": 0.04, "reduced_modulus": 1.0, "poissons_ratio": 0.5}
    path = solved(
        22, 0.0, [0.1, 10.0, 0.2, 3.0, 0.1], size=1.0, boundary="periodic", quantity="force",
        kernel={"type": "bonded_layer", **layer},
        indenter=heights(0.001 * (x[:, None] + x)),
        interaction={"type": "jkr", "work_of_adhesion": 0.1, "estimate_error": False},
    )  # fmt: skip
    assert path["contact"].values.all()
    assert not path["jumped"].values[1:].any()


@pytest.mark.slow
def test_pull_off_is_that_of_jkr() -> None:
    """The lowest force on a path in depth is −1.5 πwR to 2 %."""
    end = theory(0.0).instability()
    steps = float(end.depth) + np.arange(0.1, -0.101, -0.05)
    path = solved(128, 0.0, [0.1, *steps])
    assert float(path["force"].values.min()) == pytest.approx(float(end.force), rel=0.02)
    limit = float(path["force_extrapolated"].values.min())
    assert limit == pytest.approx(float(end.force), rel=0.01)


@pytest.mark.parametrize("length", [0.0, 1.0])
def test_jkr_attracts_nothing_before_it_touches(length: float) -> None:
    """The first contact of an approach is within 0.05 a₀²/R of the first touch, and pulls."""
    path = solved(64, length, [-0.3, -0.05, 0.05])
    assert (path["contact_area"].values > 0).tolist() == [False, False, True]
    assert path["force"].values[:2].tolist() == [0.0, 0.0]
    assert float(path["force"][2]) < -FORCE / 2


@pytest.mark.parametrize("stiffness", [pytest.param(0.1, marks=pytest.mark.slow), 10.0])
def test_a_cantilever_jumps_off_where_the_theory_says(stiffness: float) -> None:
    """It holds at a base 3 % before the last stable one, and has jumped off 3 % beyond."""
    end = theory(0.0).instability(stiffness)
    last = float(end.depth + end.force / stiffness)
    path = solved(
        64,
        0.0,
        [0.1, 0.8 * last, 0.97 * last, 1.03 * last],
        quantity="base_displacement",
        spring_constant=stiffness,
    )
    assert (path["contact_area"].values > 0).tolist() == [True, True, True, False]


def test_a_dugdale_zone_is_that_of_maugis() -> None:
    """At λ = 1 force and radius along the path are right to 1 % (Maugis 1992).

    With λ = 2σ₀ (R/πwK²)^⅓, K = 4E*/3, and c the radius of the zone, m = c/a and θ = arccos(1/m)
    give ½λa² (√(m² − 1) + (m² − 2)θ) + 4/3 λ²a (θ√(m² − 1) − m + 1) = 1 in units of (πwR²/K)^⅓.
    """
    strength = 0.5 * np.cbrt(pi * (4 / 3) ** 2)
    ratio = np.geomspace(3.0, 1.1, 3000)
    tangent, angle = np.sqrt(ratio**2 - 1), np.arccos(1 / ratio)
    quarter = (tangent + (ratio**2 - 2) * angle) / 4
    linear = (tangent * angle - ratio + 1) * 2 / 3
    scaled = (np.sqrt(linear**2 + 2 * quarter) - linear) / (2 * quarter)
    unit = np.cbrt(3 * pi / 4)
    closed_depth = unit**2 * (scaled**2 - 4 / 3 * scaled * tangent)
    closed_force = pi * (scaled**3 - scaled**2 * (tangent + ratio**2 * angle))
    depths = [1.0, 0.2, -0.6]
    law = {"type": "dugdale", "work_of_adhesion": 1.0, "strength": float(strength)}
    path = solved(128, 0.0, depths, interaction=law, size=6.0)
    force = np.interp(depths, closed_depth, closed_force)
    np.testing.assert_allclose(path["force"].values, force, atol=0.01 * FORCE)
    radius = np.interp(depths, closed_depth, unit * scaled)
    np.testing.assert_allclose(path["contact_radius"].values, radius, rtol=0.01)


@pytest.mark.parametrize(
    "law",
    [
        {"type": "dugdale", "range": 0.1},
        {"type": "linear", "range": 0.2},
        {"type": "exponential", "range": 0.03},
    ],
)
def test_a_hard_sphere_pulls_off_a_hard_solid_at_bradleys_force(law: dict[str, Any]) -> None:
    """Any law gives 2πwR to 1 % on the way to the first touch (Bradley 1932)."""
    path = solved(
        64,
        0.0,
        [-0.01, -0.001, -0.0002, 0.0],
        size=2.4,
        kernel={"type": "half_space", "reduced_modulus": 1e5},
        interaction={**law, "work_of_adhesion": 1.0},
    )
    assert float(path["force"].values.min()) == pytest.approx(-2 * pi, rel=0.01)


@pytest.mark.parametrize(("interaction", "length"), [*zip(LAWS, (0.0, 1.0) * 2, strict=True)])
def test_force_is_the_slope_of_the_energy(interaction: dict[str, Any], length: float) -> None:
    """F = +dU/dδ by central differences to 1e-3."""
    path = solved(64, length, [0.05, 0.01, 0.0, -0.01], interaction=interaction, size=7.0)
    energy, force = path["energy"].values, path["force"].values
    assert (energy[1] - energy[3]) / 0.02 == pytest.approx(force[2], rel=1e-3)


@pytest.mark.parametrize(
    ("interaction", "length"),
    [
        pytest.param(LAWS[0], 1.0, marks=pytest.mark.slow),
        (LAWS[1], 0.0),
        (LAWS[2], 1.0),
        pytest.param(LAWS[3], 0.0, marks=pytest.mark.slow),
    ],
)
def test_stiffness_is_the_slope_of_the_path(interaction: dict[str, Any], length: float) -> None:
    """dF/dδ with contact fixed and zone following is that of neighbouring steps, to 1e-3."""
    depths = [0.5, 0.3001, 0.3, 0.2999]
    path = solved(48, length, depths, interaction=interaction, size=7.0, stiffness=True)
    force = path["force"].values
    differences = (force[1] - force[3]) / 2e-4
    assert path["zone_area"][2] > 0
    assert float(path["stiffness"][2]) == pytest.approx(differences, rel=1e-3)


@pytest.mark.slow
def test_stiffness_is_that_of_the_closed_theory_on_average() -> None:
    """Of a path whose contact grows by many cells; single steps scatter by a tenth."""
    closed = theory(1.0)
    one, other = closed.equilibrium(1.7), closed.equilibrium(2.2)
    slope = float((other.force - one.force) / (other.depth - one.depth))
    edges = np.linspace(float(other.depth), float(one.depth), 17)
    depths = [edges[0] + 0.2, *(edges[1:] + edges[:-1]) / 2]
    law = {**JKR, "estimate_error": False}
    path = solved(64, 1.0, depths, interaction=law, size=7.0, stiffness=True)
    assert float(path["stiffness"][1:].mean()) == pytest.approx(slope, rel=0.03)


def test_stiffness_after_pull_off_is_none() -> None:
    """Without contact and zone the indenter is held by nothing."""
    path = solved(32, 0.0, [0.3, -3.0], stiffness=True)
    assert path["stiffness"].values[0] > 1
    assert path["stiffness"].values[1] == 0.0


@pytest.mark.slow
def test_prescribed_radii_are_those_of_the_closed_theory() -> None:
    """To half a cell, and at the depth of the branch that has this radius."""
    closed, radii = theory(1.0), [2.0, 1.6]
    law = {**JKR, "estimate_error": False}
    path = solved(24, 1.0, radii, interaction=law, size=6.0, quantity="contact_radius")
    assert path["converged"].all()
    np.testing.assert_allclose(path["contact_radius"], radii, atol=6 / 24 / 2)
    expected = np.linspace(1.0, 2.8, 40)
    depths = [float(closed.equilibrium(radius).depth) for radius in expected]
    np.testing.assert_allclose(
        path["contact_radius"], np.interp(path["depth"].values, depths, expected), rtol=0.06
    )


def test_prescribed_volume_of_the_gap_where_it_sticks() -> None:
    """A search in depth meets the volume."""
    rough, volumes = rough_heights(), [5e-3]
    path = solved(
        rough.shape,
        0.0,
        volumes,
        size=[side / 40 for side in rough.shape],
        boundary="periodic",
        indenter=heights(rough),
        interaction={"type": "linear", "work_of_adhesion": 3e-4, "range": 0.01},
        quantity="gap_volume",
    )
    np.testing.assert_allclose(path["gap_volume"], volumes, rtol=1e-4)
    assert path["converged"].all()


def test_a_wavy_surface_sticks_as_in_johnsons_theory() -> None:
    """Partial contact of a sine, one cell across, on the way back from twice its depth."""
    height, work = 0.1, 0.002
    path = wavy(128, [0.05, 0.02, 0.0, -0.02], height, work)
    assert (np.diff(path["contact_fraction"].values) < 0).all()
    for index in (1, 2, 3):
        half_width = float(path["contact_fraction"][index]) / 2
        closed = wave_pressure(half_width, height, work)
        assert float(path["mean_pressure"][index]) == pytest.approx(closed, abs=0.015 * pi * height)
    assert float(path["mean_pressure"][3]) < 0


def rough_heights(seed: int = 5) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return heights [m] of 40 × 32 cells without symmetry, with waves of ten cells and more."""
    draw = np.random.default_rng(seed)
    spectrum = np.zeros((40, 32), complex)
    spectrum[:4, :4] = draw.normal(size=(4, 4)) + 1j * draw.normal(size=(4, 4))
    spectrum[0, 0] = 0.0
    rough = np.fft.ifft2(spectrum).real
    return 0.05 * rough / np.ptp(rough)


def rough_step(
    rough: np.ndarray[Any, np.dtype[np.float64]],
    boundary: str = "free",
    length: float = 1.0,
    modulus: float = 1.0,
    interaction: str = "jkr",
) -> xr.Dataset:
    """Return the last step of a retraction, with lengths and moduli in given units."""
    depth = np.array([0.02, 0.01])
    law: dict[str, Any] = {"type": interaction, "work_of_adhesion": 3e-4 * length * modulus}
    if interaction != "jkr":
        law["range"] = 0.01 * length
    return solved(
        rough.shape,
        0.0,
        list(length * depth),
        size=[side / 40 * length for side in rough.shape],
        boundary=boundary,
        kernel=tensed(modulus, 0.05 * modulus * length),
        indenter=heights(rough * length),
        interaction=law,
    ).isel(step=-1)


@pytest.mark.parametrize("interaction", ["jkr", "exponential"])
def test_turned_and_mirrored_problems_have_turned_and_mirrored_tractions(interaction: str) -> None:
    """A mirror image, and a quarter turn."""
    rough = rough_heights()
    expected = rough_step(rough, interaction=interaction)["pressure"].values
    assert expected.min() < 0 < expected.max()
    mirrored = rough_step(rough[::-1], interaction=interaction)["pressure"].values[::-1]
    turned = np.rot90(rough_step(np.rot90(rough), interaction=interaction)["pressure"], -1)
    for field in (mirrored, turned):
        np.testing.assert_allclose(field, expected, atol=1e-5 * expected.max())


def test_a_periodic_problem_can_be_shifted() -> None:
    """Heights moved across the boundary move the tractions, and the zone, with them."""
    rough = rough_heights()
    expected = rough_step(rough, "periodic")["pressure"].values
    assert expected.min() < 0 < expected.max()
    shifted = rough_step(np.roll(rough, (23, 17), (0, 1)), "periodic")["pressure"].values
    np.testing.assert_allclose(
        np.roll(shifted, (-23, -17), (0, 1)), expected, atol=1e-5 * expected.max()
    )


@pytest.mark.parametrize(
    ("interaction", "length", "modulus"),
    [("jkr", 1e-6, 1e3), ("jkr", 1e6, 1e-3), ("exponential", 1e-12, 1.0)],
)
def test_lengths_and_moduli_can_be_scaled(interaction: str, length: float, modulus: float) -> None:
    """Tractions scale with the modulus if w scales with modulus times length."""
    rough = rough_heights()
    expected = rough_step(rough, interaction=interaction)
    assert expected["pressure"].min() < 0 < expected["wall_pressure"].max()
    scaled = rough_step(rough, "free", length, modulus, interaction)
    highest = float(expected["pressure"].max())
    np.testing.assert_allclose(
        scaled["pressure"].values / modulus, expected["pressure"].values, atol=1e-5 * highest
    )
    assert float(scaled["energy"]) / (modulus * length**3) == pytest.approx(
        float(expected["energy"]), rel=1e-6
    )
    assert scaled["status_code"].item() == expected["status_code"].item()


@pytest.mark.slow
@pytest.mark.parametrize("first", [6, 18, 24])
def test_statuses_of_random_problems_are_honest(first: int) -> None:
    """A step that says converged is a stationary point; most are where a dense descent ends."""
    rows = [row for seed in range(first, first + 4) for row in verdicts(seed)]
    assert [row.description for row in rows if not row.honest] == []
    assert all(row.settled for row in rows)
    solved_rows = [row for row in rows if row.converged]
    assert len(solved_rows) >= 14
    same = [row for row in solved_rows if abs(row.difference) <= SAME]
    assert len(same) >= 0.8 * len(solved_rows)
