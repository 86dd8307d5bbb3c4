"""The interpolated force curves against the axisymmetric equation."""

import curve_tables
import numpy as np
import pytest

import pellicle as pl
from pellicle.components import HasForceCurve
from pellicle_axisymmetric import reciprocity, splines
from pellicle_axisymmetric.indentation import indent
from pellicle_axisymmetric.tensed_punch import punch
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid, Sphere

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
