"""Adhesive contact under tension against references, closed forms, limits and identities."""

import csv
from collections.abc import Callable
from math import inf, pi, radians, sqrt, tan
from pathlib import Path

import curve_tables
import numpy as np
import pytest

from pellicle.components import HasAbelSlope
from pellicle.errors import ConfigError
from pellicle_axisymmetric.adhesive_contact import Adhesion, punch_pull_off
from pellicle_axisymmetric.indentation import indent
from pellicle_axisymmetric.radius_curves import radius_curves
from pellicle_axisymmetric.reciprocity import contacts
from pellicle_axisymmetric.tensed_punch import punch
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid, Sphere

DATA = Path(__file__).parents[2] / "data" / "jkr_tension.csv"
LINES = [line for line in DATA.read_text(encoding="utf-8").splitlines() if line[0] != "#"]
ROWS = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(LINES)]
PARABOLOID = Paraboloid(radius=1.0)


def adhesion(
    length: float, work: float = 1.0, modulus: float = 1.0, indenter: HasAbelSlope = PARABOLOID
) -> Adhesion:
    """Return the adhesive contact at an elastocapillary length s and a work w over E*."""
    return Adhesion(indenter, modulus, length * modulus / 2, work * modulus)


@pytest.mark.parametrize(
    "row",
    [*ROWS[:1], *(pytest.param(row, marks=pytest.mark.slow) for row in ROWS[1:3]), *ROWS[3:]],
    ids=lambda row: f"s/a0={row['s_over_a0']:g}",
)
def test_paraboloid_matches_the_reference(row: dict[str, float]) -> None:
    """Pull-off, zero load and the instability at fixed depth equal the tabulated ones."""
    sticky = adhesion(row["s_over_a0"], modulus=3.0)
    dead_load, free = sticky.instability(), sticky.at_force(0.0)
    fixed_depth = sticky.instability(inf)
    assert dead_load.force / 3 / pi == pytest.approx(row["Fpulloff_over_piwR"], rel=1e-6)
    assert free.contact_radius == pytest.approx(row["a_zero_load"], rel=1e-6)
    assert free.depth == pytest.approx(row["depth_zero_load"], rel=1e-6)
    assert fixed_depth.depth == pytest.approx(row["depth_depth_control"], rel=1e-6)
    # Force and depth are stationary here, so the radii of the table have six digits.
    assert dead_load.contact_radius == pytest.approx(row["a_pulloff"], rel=5e-6)
    assert fixed_depth.contact_radius == pytest.approx(row["a_depth_control"], rel=5e-6)
    assert fixed_depth.force / 3 / pi == pytest.approx(row["F_depth_control_over_piwR"], rel=5e-6)


@pytest.mark.slow
@pytest.mark.parametrize("length", [1.0, 10.0])
def test_radius_of_the_lowest_depth_is_stationary(length: float) -> None:
    """dδ/da is 0 there by direct solutions and the line load at the rim of the punch."""
    a = float(adhesion(length).instability(inf).contact_radius)

    def depth(radius: float) -> float:
        hard = indent(PARABOLOID, 1.0, length / 2, contact_radius=radius)
        rim = punch(radius, 1.0, length / 2, depth=1.0).ring_force / (2 * pi * radius)
        return hard.depth - sqrt(length) / rim

    offsets = 0.05 * np.array([-2, -1, 1, 2])
    values = np.array([depth(a * (1 + offset)) for offset in offsets])
    slope = (values @ [1, -8, 8, -1]) / (12 * 0.05)
    curvature = (values @ [-1, 16, 16, -1] - 30 * depth(a)) / (12 * 0.05**2)
    # The fourth-order differences leave 4e-5 of the curvature.
    assert abs(slope) < 1e-4 * curvature


def test_without_tension_it_is_the_theory_of_johnson_kendall_and_roberts() -> None:
    """F = 4E*a³/3R − √(8πE*w a³) and δ = a²/R − √(2πaw/E*)."""
    a = np.geomspace(1e-3, 1e3, 13)
    curve = adhesion(0.0, 0.3, 5.0).equilibrium(a)
    assert curve.force == pytest.approx(5 * (4 / 3 * a**3 - np.sqrt(2.4 * pi * a**3)), rel=1e-9)
    assert curve.depth == pytest.approx(a**2 - np.sqrt(0.6 * pi * a), rel=1e-9)


def test_without_tension_a_cone_is_that_of_maugis_and_barquins() -> None:
    """F = −54 w² tan³α / πE* at a = 18 w tan²α / πE*."""
    alpha = radians(75)
    pull_off = adhesion(0.0, 0.3, 5.0, Cone(half_angle=alpha)).instability()
    assert pull_off.force == pytest.approx(-54 * 0.3**2 * 5 * tan(alpha) ** 3 / pi, rel=1e-9)
    assert pull_off.contact_radius == pytest.approx(18 * 0.3 * tan(alpha) ** 2 / pi, rel=1e-8)


@pytest.mark.parametrize(
    "length",
    [pytest.param(1e-3, marks=pytest.mark.slow), 1.0, pytest.param(1e3, marks=pytest.mark.slow)],
)
def test_stiffness_slope_is_the_line_load_at_the_rim(length: float) -> None:
    """k′ = 4πa N²/(2τ₀δ²): the energy release rate of a punch under tension is N²/2τ₀."""
    a = 0.7
    curves = radius_curves(PARABOLOID, length, np.log([a]))
    slope = curves.stiffness[0] / a * curves.stiffness_slope[0]
    log, pressure = curve_tables.punch(length / a)
    # φ sin η at the rim, times π² a for a depth of 1.
    ring = pi**2 * a * 2 * np.exp(log) * pressure[0]
    assert slope == pytest.approx(ring**2 / (pi * a * length), rel=3e-8)
    assert punch(a, 1.0, length / 2, depth=1.0).ring_force == pytest.approx(ring, rel=1e-8)


@pytest.mark.parametrize(
    "indenter",
    [
        PARABOLOID,
        pytest.param(Sphere(radius=1.0), marks=pytest.mark.slow),
        pytest.param(Cone(half_angle=1.4), marks=pytest.mark.slow),
    ],
)
def test_curves_between_nodes_are_solutions(indenter: HasAbelSlope) -> None:
    """Interpolated force and depth are those of the equation, and dF₁/dδ₁ is k."""
    xi = np.log([0.31])
    curves = radius_curves(indenter, 0.5, xi)
    hard = indent(indenter, 1.0, 0.25, contact_radius=float(curves.radius[0]))
    assert curves.force[0] == pytest.approx(hard.force, rel=2e-9)
    assert curves.depth[0] == pytest.approx(hard.depth, rel=2e-9)
    rates = curves.force * curves.force_slope, curves.depth * curves.depth_slope
    assert rates[0][0] / rates[1][0] == pytest.approx(curves.stiffness[0], rel=1e-8)


@pytest.mark.slow
def test_tension_alone_pulls_off_at_the_force_of_a_liquid() -> None:
    """Pull-off tends to −πwR at a = R√(w/2τ₀) as s/a grows (Hui et al. 2015)."""
    far = adhesion(1e5).instability()
    assert far.force / pi == pytest.approx(-1, rel=1e-4)
    assert far.contact_radius == pytest.approx(1e5**-0.5, rel=1e-3)


@pytest.mark.slow
def test_a_cone_steeper_than_the_rim_is_never_pulled() -> None:
    """A contact under tension sticks to a cone only if cot α < √(2w/τ₀)."""
    cone = Cone(half_angle=radians(80))
    rim = sqrt(4 * 0.01 / 2.0)
    assert 1 / tan(radians(80)) > rim
    assert not np.any(adhesion(2.0, 0.01, indenter=cone).instability())
    assert adhesion(2.0, 0.02, indenter=cone).instability().force < 0


def test_a_spring_loses_stability_between_dead_load_and_fixed_depth() -> None:
    """dF/dδ = −k_c there, and the limits of k_c are those of the other two."""
    sticky = adhesion(1.0)
    dead_load, fixed_depth = sticky.instability(), sticky.instability(inf)
    for spring in (0.1, 1.0, 10.0):
        end = sticky.instability(spring)
        assert fixed_depth.contact_radius < end.contact_radius < dead_load.contact_radius
        near = sticky.equilibrium(end.contact_radius * np.array([1 - 1e-3, 1 + 1e-3]))
        assert np.diff(near.force) == pytest.approx(-spring * np.diff(near.depth), rel=2e-3)
    assert sticky.instability(1e-9).force == pytest.approx(dead_load.force, rel=1e-9)
    assert sticky.instability(1e9).depth == pytest.approx(fixed_depth.depth, rel=1e-9)


def test_equilibria_at_a_depth_and_at_a_force_are_those_of_their_radius() -> None:
    """at_depth and at_force invert the stable branch of the curve."""
    sticky = adhesion(1.0)
    true = sticky.equilibrium(1.5)
    for same in (sticky.at_depth(float(true.depth)), sticky.at_force(float(true.force))):
        assert np.array(same) == pytest.approx(np.array(true), rel=1e-10)


@pytest.mark.slow
def test_scales_change_nothing() -> None:
    """A contact of micrometres is that of metres with s, w/E* and R scaled."""
    true, scale = adhesion(1.0).instability(), 1e-6
    end = adhesion(scale, scale, 1e4, Paraboloid(radius=scale)).instability()
    assert end.force == pytest.approx(true.force * scale**2 * 1e4, rel=1e-9)
    assert end.contact_radius == pytest.approx(true.contact_radius * scale, rel=1e-7)


def test_sphere_is_a_paraboloid_where_the_contact_is_small() -> None:
    """The error of the shallow limit falls as (a/R)²."""
    errors = []
    for work in (1e-6, 1e-9):
        ends = [
            adhesion(0.0, work, indenter=shape).instability().force
            for shape in (Sphere(radius=1.0), PARABOLOID)
        ]
        errors.append(abs(ends[0] / ends[1] - 1))
    assert errors[0] < 1e-3
    assert errors[1] == pytest.approx(errors[0] / 100, rel=0.05)


@pytest.mark.parametrize("length", [0.0, 1e-6, 1.0])
def test_punch_pulls_off_at_its_rim(length: float) -> None:
    """A flat punch follows Kendall (1971), or carries √(2τ₀w) along its rim under tension."""
    end = punch_pull_off(2.0, 5.0, 2.5 * length, 0.3)
    if length < 1e-3:
        assert end.force == pytest.approx(-sqrt(8 * pi * 5 * 0.3 * 8), rel=1e-5)
    else:
        whole = punch(2.0, 5.0, 2.5 * length, depth=float(-end.depth))
        assert whole.ring_force / (4 * pi) == pytest.approx(sqrt(5 * length * 0.3), rel=1e-12)
        assert end.force == pytest.approx(-whole.force, rel=1e-12)


@pytest.mark.parametrize("length", [0.0, 0.1, 1.0, 10.0])
@pytest.mark.parametrize("flat", [0.3, 0.6, 1.5])
def test_an_edge_holds_the_rim_until_its_punch_lets_go(flat: float, length: float) -> None:
    """The lowest force and depth are those of the punch or of a wider contact that pulls harder."""
    body = Paraboloid(radius=1.0, flat_radius=flat)
    sticky, end = adhesion(length, indenter=body), punch_pull_off(flat, 1.0, length / 2, 1.0)
    radii = flat * (1 + np.geomspace(1e-5, 9, 1000))
    hard = contacts(body, radii, length)
    retraction = np.sqrt(4 * pi * radii / hard.stiffness_slope)
    wider = hard.depth - retraction, hard.force - hard.stiffness * retraction
    lowest = [min(float(e), w.min()) for e, w in zip(end[1:], wider, strict=True)]
    assert sticky.instability(inf).depth == pytest.approx(lowest[0], rel=1e-4)
    assert sticky.instability().force == pytest.approx(lowest[1], rel=1e-4)
    if (flat, length) == (0.6, 1.0):
        assert np.array(lowest) == pytest.approx([-1.688003, -1.504754 * pi], rel=1e-6)
    edge = sticky.equilibrium(flat)
    assert np.array(edge) == pytest.approx(np.array(end), rel=1e-9)
    # Pinned, it is the punch at any depth between; without tension there is none.
    if length and edge.depth <= lowest[0]:
        held = sticky.at_depth(0.97 * float(edge.depth))
        assert held.contact_radius == flat
        assert held.force == pytest.approx(0.97 * edge.force, rel=1e-9)
    free = sticky.at_force(0.0)
    assert sticky.at_depth(float(free.depth) + 1e-9).force == pytest.approx(0, abs=1e-5)


def test_a_small_flat_and_a_blunt_tip_change_little() -> None:
    """A flat of 1e-3 a₀ changes nothing to 1e-6; a blunt tip is a paraboloid at first."""
    for small, whole in (
        (adhesion(1.0, indenter=Paraboloid(radius=1.0, flat_radius=1e-3)), adhesion(1.0)),
        (
            adhesion(1e-2, 1e-6, indenter=Cone(half_angle=0.1, tip_radius=1.0)),
            adhesion(1e-2, 1e-6),
        ),
    ):
        for other in (0.0, 1.0, inf):
            one, same = small.instability(other), whole.instability(other)
            assert np.array(one[1:]) == pytest.approx(np.array(same[1:]), rel=1e-6)
            assert one.contact_radius == pytest.approx(float(same.contact_radius), rel=1e-4)
        assert small.at_force(1e-9).depth == pytest.approx(float(whole.at_force(1e-9).depth), 1e-5)


@pytest.mark.parametrize(
    ("message", "act"),
    [
        ("work_of_adhesion", lambda: Adhesion(PARABOLOID, 1.0, 0.0, -1.0)),
        ("tension", lambda: Adhesion(PARABOLOID, 1.0, -1.0, 1.0)),
        ("less than 1.0 m", lambda: adhesion(0.0, indenter=Sphere(radius=1.0)).equilibrium(1.0)),
        ("above -4.71239, the lowest", lambda: adhesion(0.0).at_force(-4.8)),
        ("above -1.60877, the lowest", lambda: adhesion(0.0).at_depth(-1.7)),
        ("whole profile", lambda: adhesion(0.0, 1e12, indenter=Sphere(radius=1.0)).instability()),
        (
            "whole profile",
            lambda: adhesion(0, 1e12, indenter=Sphere(radius=1, flat_radius=0.1)).instability(),
        ),
    ],
)
def test_impossible_requests_are_refused(message: str, act: Callable[[], object]) -> None:
    """What has no adhesive equilibrium is refused by name, with what is allowed."""
    with pytest.raises(ConfigError, match=message):
        act()
