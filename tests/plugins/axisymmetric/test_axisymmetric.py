"""Axisymmetric contact under tension: references, limits, identities, interpolated curves."""

from pathlib import Path

import curve_tables
import numpy as np
import pytest

import pellicle as pl
from pellicle.components import HasAbelSlope, HasForceCurve
from pellicle.errors import ConfigError
from pellicle_axisymmetric import reciprocity, splines
from pellicle_axisymmetric.indentation import AxisymmetricContact, indent
from pellicle_axisymmetric.tensed_punch import punch
from pellicle_plugins.closed_forms.hertz import sphere
from pellicle_plugins.closed_forms.sneddon import cone
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid, Sphere

DATA = Path(__file__).parents[2] / "data" / "paraboloid.csv"
ROWS = [
    tuple(float(value) for value in line.split(","))
    for line in DATA.read_text(encoding="utf-8").splitlines()
    if line and line[0].isdigit()
]
INDENTERS = [Paraboloid(radius=2e-3), Sphere(radius=2e-3), Cone(half_angle=1.2)]
E = 1e4


def integrated(contact: AxisymmetricContact) -> float:
    """Return the force [N] that the pressure of a contact carries."""
    nodes, weights = np.polynomial.legendre.leggauss(160)
    theta = np.pi / 4 * (nodes + 1)
    r = contact.contact_radius * np.sin(theta)
    jacobian = contact.contact_radius * np.cos(theta) * np.pi / 4
    return float(weights @ (2 * np.pi * r * contact.pressure(r) * jacobian))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"s/a={row[0]:g}")
def test_paraboloid_matches_the_reference(row: tuple[float, ...]) -> None:
    """Load, depth, centre and edge pressure equal the tabulated ones."""
    ratio, load, depth, centre, edge = row
    a, radius = 3e-4, 2e-3
    contact = indent(Paraboloid(radius=radius), E, ratio * a * E / 2, contact_radius=a)
    assert contact.force / (4 * E * a**3 / (3 * radius)) == pytest.approx(load, rel=1e-11)
    assert contact.depth / (a**2 / radius) == pytest.approx(depth, rel=1e-11)
    p = contact.pressure([0.0, a]) * radius / (E * a)
    assert p[0] == pytest.approx(centre, rel=1e-10)
    assert p[1] == pytest.approx(edge, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize("tension", [0.0, 0.1, 1e3])
@pytest.mark.parametrize("indenter", INDENTERS, ids=lambda i: type(i).__name__)
def test_pressure_carries_the_force(indenter: HasAbelSlope, tension: float) -> None:
    """The pressure integrates to the force for every profile."""
    contact = indent(indenter, E, tension, contact_radius=3e-4)
    assert integrated(contact) == pytest.approx(contact.force, rel=1e-8)


@pytest.mark.parametrize("ratio", [1e-2, 1.0, 1e6])
def test_stiffness_is_that_of_a_punch(ratio: float) -> None:
    """dP/dδ of a smooth indenter is the stiffness of the punch of its contact."""
    a, tension = 3e-4, ratio * 3e-4 * E / 2
    low, high = (
        indent(Paraboloid(radius=2e-3), E, tension, contact_radius=a * (1 + h))
        for h in (-1e-4, 1e-4)
    )
    slope = (high.force - low.force) / (high.depth - low.depth)
    assert slope == pytest.approx(punch(a, E, tension, depth=1.0).force, rel=1e-7)


def test_no_tension_is_hertz_and_sneddon() -> None:
    """At exactly zero tension the closed forms come out, pressure included."""
    a = 3e-4
    r = np.array([1e-6, 1e-4, 2.9e-4, 4e-4])
    round_, exact = (
        indent(Paraboloid(radius=2e-3), E, 0.0, contact_radius=a),
        sphere(2e-3, E, contact_radius=a),
    )
    assert (round_.force, round_.depth) == pytest.approx((exact.force, exact.depth), rel=1e-13)
    assert round_.pressure(r) == pytest.approx(exact.pressure(r), rel=1e-12)
    pointed, sneddon = (
        indent(Cone(half_angle=1.2), E, 0.0, contact_radius=a),
        cone(1.2, E, contact_radius=a),
    )
    assert (pointed.force, pointed.depth) == pytest.approx((sneddon.force, sneddon.depth))
    assert pointed.pressure(r) == pytest.approx(sneddon.pressure(r), rel=1e-12)


@pytest.mark.parametrize("indenter", INDENTERS, ids=lambda i: type(i).__name__)
def test_little_tension_changes_little(indenter: HasAbelSlope) -> None:
    """Force and depth tend to those without tension as s/a → 0."""
    a = 3e-4
    none = indent(indenter, E, 0.0, contact_radius=a)
    little = indent(indenter, E, 1e-6 * a * E / 2, contact_radius=a)
    assert 0 < little.force / none.force - 1 < 3e-5
    assert 0 < little.depth / none.depth - 1 < 3e-5


def test_strong_tension_limit() -> None:
    """P/P_H → (3π/4)(s/a) + 2 and δR/a² → ½ + ln(2s/a) − γ."""
    ratio, a, radius = 1e6, 3e-4, 2e-3
    contact = indent(Paraboloid(radius=radius), E, ratio * a * E / 2, contact_radius=a)
    hertz = 4 * E * a**3 / (3 * radius)
    assert contact.force / hertz == pytest.approx(3 * np.pi / 4 * ratio + 2, rel=1e-10)
    expected = 0.5 + np.log(2 * ratio) - np.euler_gamma
    assert contact.depth * radius / a**2 == pytest.approx(expected, rel=2e-6)
    # Laplace: all of the pressure is tension times curvature.
    assert contact.pressure(a / 2) == pytest.approx(2 * contact.tension / radius, rel=1e-5)


def test_pressure_near_the_edge_has_the_known_logarithm() -> None:
    """Near the edge p ≈ p(a⁻) [1 + (e/πs) ln(1/e)] at a small distance e from the edge."""
    contact = indent(Paraboloid(radius=1.0), 1.0, 0.5, contact_radius=1.0)
    e = np.array([1e-4, 2e-4])
    edge = contact.pressure(1.0)
    rise = (contact.pressure(1 - e) / edge - 1) / e
    assert rise[0] - rise[1] == pytest.approx(np.log(2) / np.pi, rel=5e-3)


def test_cone_pressure_at_its_apex() -> None:
    """The product p r → τ₀ cot α at the apex of a cone, and p(0) is infinite."""
    contact = indent(Cone(half_angle=1.2), E, 0.1, contact_radius=3e-4)
    r = 3e-13
    assert contact.pressure(r) * r == pytest.approx(0.1 / np.tan(1.2), rel=1e-6)
    assert contact.pressure(0.0) == np.inf


def test_small_sphere_contact_is_a_paraboloid() -> None:
    """A sphere pressed far less than its radius behaves as its osculating paraboloid."""
    a, radius = 2e-6, 2e-3
    exact, near = (
        indent(i, E, a * E, contact_radius=a)
        for i in (Sphere(radius=radius), Paraboloid(radius=radius))
    )
    assert (exact.force, exact.depth) == pytest.approx((near.force, near.depth), rel=2e-6)


@pytest.mark.parametrize("indenter", INDENTERS, ids=lambda i: type(i).__name__)
@pytest.mark.parametrize("tension", [0.0, pytest.param(0.3, marks=pytest.mark.slow)])
def test_given_depth_or_force_finds_the_radius(indenter: HasAbelSlope, tension: float) -> None:
    """Radius → depth or force → radius closes."""
    contact = indent(indenter, E, tension, contact_radius=3e-4)
    for same in (
        indent(indenter, E, tension, depth=contact.depth),
        indent(indenter, E, tension, force=contact.force),
    ):
        assert same.contact_radius == pytest.approx(3e-4, rel=1e-11)


def test_nothing_presses_outside() -> None:
    """The pressure is zero beyond the contact and keeps the shape of its argument."""
    contact = indent(Paraboloid(radius=2e-3), E, 0.1, contact_radius=3e-4)
    p = contact.pressure([[1e-4, 3.1e-4], [2e-4, 1.0]])
    assert p.shape == (2, 2)
    assert (p > 0).tolist() == [[True, False], [True, False]]


def test_contact_beyond_the_sphere_is_refused() -> None:
    """A force or radius that would need more than a hemisphere is an error."""
    with pytest.raises(ConfigError, match="wider"):
        indent(Sphere(radius=2e-3), E, 0.1, force=1e6)
    with pytest.raises(ConfigError, match="less than"):
        indent(Sphere(radius=2e-3), E, 0.1, contact_radius=2e-3)


@pytest.mark.parametrize(("ratio", "share"), [(0.1, 0.35), (10.0, 0.95)])
def test_punch_carries_a_ring_load(ratio: float, share: float) -> None:
    """The rim carries 35 % of the force at s/a = 0.1, and 95 % at 10."""
    contact = punch(1.0, 1.0, ratio / 2, force=1.0)
    assert contact.ring_force == pytest.approx(share, abs=5e-3)


def test_punch_limits() -> None:
    """Boussinesq without tension, and P / 2E*aδ → (πs/2a) / (ln(2s/a) − γ) with much."""
    plain = punch(2e-3, E, 0.0, depth=1e-5)
    assert plain.force == pytest.approx(2 * E * 2e-3 * 1e-5)
    assert plain.ring_force == 0.0
    ratio = 1e5
    tensed = punch(1.0, 1.0, ratio / 2, depth=1.0)
    expected = np.pi * ratio / (np.log(2 * ratio) - np.euler_gamma)
    assert tensed.force == pytest.approx(expected, rel=1e-5)


ACCURACY = 1e-6
RADIUS = 3e-6
ANGLE = 1.2

# Off the nodes, and past both ends of the table: s over the contact radius, and a over R.
_random = np.random.default_rng(7)
RATIOS = [0.0, 1e-7, *10 ** _random.uniform(-4, 5, 6), 1e7]
SPHERES = [
    (0.01, 1e-5),
    (0.3, 0.2),
    (0.8, 0.02),
    (0.45, 3.0),
    (0.5, 50.0),
    (0.15, 700.0),
    (0.81, 0.0),
]


def _curve(type_: str, depth: float, length: float) -> tuple[float, float, float]:
    fields = {"half_angle": ANGLE} if type_ == "cone" else {"radius": RADIUS}
    indenter = pl.indenter(type_, **fields)
    assert isinstance(indenter, HasForceCurve)
    curve = indenter.force_curve(np.array([depth]), length)
    return float(curve.force[0]), float(curve.by_depth[0]), float(curve.by_length[0])


@pytest.mark.parametrize("ratio", RATIOS)
def test_one_variable_curves_solve_the_equation(ratio: float) -> None:
    """Paraboloid, cone and punch agree with the equation to 1e-6 at any s/a."""
    a = 0.4e-6
    for type_, shape in (
        ("paraboloid", Paraboloid(radius=RADIUS)),
        ("cone", Cone(half_angle=ANGLE)),
    ):
        exact = indent(shape, 1.0, ratio * a / 2, contact_radius=a)
        assert _curve(type_, exact.depth, ratio * a)[0] == pytest.approx(exact.force, rel=ACCURACY)
    exact_punch = punch(RADIUS, 1.0, ratio * RADIUS / 2, depth=a)
    assert _curve("flat_punch", a, ratio * RADIUS)[0] == pytest.approx(
        exact_punch.force, rel=ACCURACY
    )


@pytest.mark.parametrize(("contact", "ratio"), SPHERES)
def test_sphere_solves_the_equation(contact: float, ratio: float) -> None:
    """The sphere agrees up to depths of R."""
    exact = indent(
        Sphere(radius=RADIUS), 1.0, ratio * contact * RADIUS / 2, contact_radius=contact * RADIUS
    )
    force = _curve("sphere", exact.depth, ratio * contact * RADIUS)[0]
    assert force == pytest.approx(exact.force, rel=ACCURACY)


def test_the_table_is_what_its_script_makes() -> None:
    """Stiffness and pressure of punches, made anew, are those of the file."""
    for number in range(1, reciprocity.LENGTHS.size, 60):
        stiffness, pressure = curve_tables.punch(float(reciprocity.LENGTHS[number]))
        log, *shares = splines.table_in(reciprocity.FILE)["shares"][number]
        assert log == pytest.approx(stiffness, abs=1e-9)
        shipped = splines.table_in(reciprocity.FILE)["modes"] @ shares
        assert shipped == pytest.approx(pressure, abs=1e-9 * pressure.max())


@pytest.mark.parametrize("type_", ["paraboloid", "sphere", "cone", "flat_punch"])
def test_curves_rise_smoothly(type_: str) -> None:
    """Force rises in depth and in length; the sensitivities are its derivatives."""
    lengths = RADIUS * np.concatenate([[0.0], np.geomspace(1e-5, 1e4, 60)])
    depths = RADIUS * np.geomspace(1e-6, 0.95, 80)
    for length in lengths:
        for depth in depths[::5]:
            _, by_depth, by_length = _curve(type_, depth, length)
            step = 1e-4 * depth
            up, down = (_curve(type_, depth + d, length)[0] for d in (step, -step))
            assert by_depth > 0
            assert (up - down) / (2 * step) == pytest.approx(by_depth, rel=1e-5)
            assert by_length > 0
            step = 1e-4 * max(length, 1e-5 * RADIUS)
            here, up = (_curve(type_, depth, length + d)[0] for d in (0.0, step))
            if length:
                down = _curve(type_, depth, length - step)[0]
                noise = 1e-13 * here / step / by_length
                assert (up - down) / (2 * step) == pytest.approx(by_length, rel=1e-4 + noise)


@pytest.mark.parametrize("type_", ["paraboloid", "sphere", "cone", "flat_punch"])
@pytest.mark.parametrize("length", [0.0, 1e-6])
def test_no_force_before_contact(type_: str, length: float) -> None:
    """Force and derivatives are 0 at depths up to 0, also where all are."""
    fields = {"half_angle": ANGLE} if type_ == "cone" else {"radius": RADIUS}
    indenter = pl.indenter(type_, **fields)
    assert isinstance(indenter, HasForceCurve)
    for depths in ([-1e-6, 0.0, 1e-7], [-1e-6, 0.0], [0.0]):
        depth = np.array(depths)
        for values in indenter.force_curve(depth, length):
            assert values.shape == depth.shape
            assert not values[depth <= 0].any()
            assert (values[depth > 0] > 0).all()
