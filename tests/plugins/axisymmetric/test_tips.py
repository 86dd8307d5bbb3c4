"""Bodies of revolution with an edge, and others, from the pressures of flat punches."""

from collections.abc import Callable
from math import pi, radians, tan
from typing import Any, Literal

import numpy as np
import pytest
from scipy.integrate import quad

import pellicle as pl
from pellicle.arrays import Array
from pellicle_axisymmetric import BodyOfRevolution
from pellicle_axisymmetric.equation import solve
from pellicle_axisymmetric.master_curves import _Power
from pellicle_axisymmetric.reciprocity import contacts
from pellicle_plugins.indenters.of_revolution import (
    Cone,
    FlatPunch,
    Paraboloid,
    Sphere,
)
from tests.tables_of_runs import pressing, tensed

Tip = BodyOfRevolution | FlatPunch
WORN = Sphere(radius=5e-6, flat_radius=1e-6)
BLUNT = Cone(half_angle=radians(70), tip_radius=20e-9)
FLAT = Paraboloid(radius=5e-6, flat_radius=1e-6)
TIPS = pytest.mark.parametrize("body", [WORN, FLAT, BLUNT], ids=["worn", "flat", "blunt"])


def curve(body: Tip, depth: Array, length: float = 0.0) -> Array:
    """Return P/E*."""
    return body.force_curve(depth, length).force


@TIPS
def test_transform_is_that_of_the_profile(body: Sphere | Paraboloid | Cone) -> None:
    """h(x) = −x ∫ f′(r)/√(x² − r²) dr, by x cos φ = √(x² − r²), and h′ is its slope."""
    (kink,) = body.kinks

    def slope(r: float) -> float:
        step = 1e-5 * kink
        ends = (body.profile(np.array(r + d), np.zeros(())) for d in (step, -step))
        return float(np.subtract(*ends)) / (2 * step)

    for x in kink * np.array([1.2, 2.0, 3.5]):
        phi = float(np.arcsin(kink / x))
        parts = ((0.0, phi), (phi, pi / 2))
        h = -x * sum(quad(lambda p, x=x: slope(x * np.sin(p)), *part)[0] for part in parts)
        assert body.abel_transform(np.array(x)) == pytest.approx(h, rel=1e-5)
        ends = body.abel_transform(x * np.array([1 - 1e-5, 1 + 1e-5]))
        assert body.abel_slope(np.array(x)) == pytest.approx(np.diff(ends)[0] / 2e-5 / x, rel=1e-6)


def test_a_blunted_cone_is_that_of_briscoe() -> None:
    """Force and depth without tension of Briscoe, Sebastian & Adams (1994, eqs 6 and 7)."""
    radius, slope = BLUNT.tip_radius or 0.0, 1 / tan(BLUNT.half_angle)
    b = radius * slope
    a = b * np.geomspace(1.0, 50.0, 23)
    root, angle = np.sqrt(a**2 - b**2), pi / 2 - np.arcsin(b / a)
    depth = a * (slope * angle + (a - root) / radius)
    inner = a**2 / 2 * slope * angle + a**3 / 3 / radius
    force = 2 * (a * depth - inner + root * (b / 2 * slope + (a**2 - b**2) / 3 / radius))
    assert curve(BLUNT, depth) == pytest.approx(force, rel=1e-6)


def test_a_worn_sphere_is_that_of_sneddon() -> None:
    """F = 2E*(ah(a) − ∫h dx) without tension (Sneddon 1965)."""
    (b,) = WORN.kinks
    for a in b * np.array([1.0003, 1.01, 1.2, 2.0, 4.0]):
        depth = WORN.abel_transform(np.array(a))
        # In units of b, and from an integrand without a root.
        area, _ = quad(
            lambda u: 2 * u * float(WORN.abel_transform(b * (1 + u**2))), 0, (a / b - 1) ** 0.5
        )
        force = 2 * (a * float(depth) - b * area)
        assert curve(WORN, np.array([depth]))[0] == pytest.approx(force, rel=1e-6)


@TIPS
@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.3, 20.0])
def test_far_from_the_edge_it_does_not_matter(
    body: Sphere | Paraboloid | Cone, ratio: float
) -> None:
    """Shallow, a worn sphere is a punch and a blunted cone a paraboloid; deep, they are whole."""
    (edge,) = body.kinks
    if isinstance(body, Cone):
        shallow: Tip = Paraboloid(radius=body.tip_radius or 0.0)
        whole: Tip = Cone(half_angle=body.half_angle)
        deep: Tip = body
    else:
        shallow = FlatPunch(radius=edge)
        whole = body.model_copy(update={"radius": 1e3 * edge, "flat_radius": None})
        deep = body.model_copy(update={"radius": 1e3 * edge})
    depth, length = np.array([1e-3 * edge]), ratio * edge
    if ratio or isinstance(body, Cone):
        assert curve(body, depth, length) == pytest.approx(curve(shallow, depth, length), rel=1e-6)
    depth = np.array([400 * edge])
    # A blunted cone is lower by a constant.
    assert curve(deep, depth, length) == pytest.approx(curve(whole, depth, length), rel=1e-2)


@pytest.mark.parametrize("ratio", [1e-6, 1e-3, 0.05, 1.0, 30.0, 1e4])
@pytest.mark.parametrize("exponent", [1, 2, 4])
def test_any_body_solves_the_equation(exponent: int, ratio: float) -> None:
    """Force and depth at a radius are those of the equation."""
    body = _Power(exponent, pointed=exponent == 1)
    force, depth = solve(body, 1.0, ratio, 1).moments()
    found = contacts(body, np.ones(1), ratio)
    assert found.depth[0] == pytest.approx(depth, rel=3e-9)
    assert found.force[0] == pytest.approx(force, rel=3e-9)


class Quartic(BodyOfRevolution):
    """Stranger's body f = −r⁴/L³ with L = 10 µm, h′ = (32/3) x³/L³."""

    type: Literal["quartic"] = "quartic"

    def profile(self, x: Array, y: Array) -> Array:
        return -((x**2 + y**2) ** 2) / 1e-15

    def abel_slope(self, x: Array) -> Array:
        return 32 / 3 * x**3 / 1e-15


def test_a_stranger_s_body_needs_its_slope_alone() -> None:
    """δ = 8a⁴/3L³ and F = 64E*a⁵/15L³ (Sneddon 1965), and a contact radius."""
    a = 1e-6 * np.array([0.5, 1.0, 3.0])
    depth = 8 / 3 * a**4 / 1e-15
    assert curve(Quartic(), depth) == pytest.approx(64 / 15 * a**5 / 1e-15, rel=1e-6)
    assert Quartic().contact_radius(depth, 0.0).radius == pytest.approx(a, rel=1e-6)


@pytest.mark.slow
def test_a_stranger_s_body_is_fitted() -> None:
    """With its rivals, adhesion among them."""
    random, position = np.random.default_rng(5), np.linspace(-0.3e-6, 1e-6, 200)
    force = 2e3 * curve(Quartic(), position, 3e-6)
    force += 3e-3 * force.max() * random.standard_normal(force.size)
    fit = pl.fit(position + 2e-6, force, indenter=Quartic())
    assert frozenset({"adhesion"}) in {one.types for one in fit.answer.explanations}
    assert (fit.reduced_modulus.low or 0) < 2e3 < (fit.reduced_modulus.high or np.inf)


@TIPS
def test_each_depth_has_a_force(body: Sphere | Paraboloid | Cone) -> None:
    """From far above the edge to far below it, and beyond the end of the profile, it grows."""
    (edge,) = body.kinks
    for depth in (1e-9, 1.0, 1e3):
        for length in (0.0, 1e-6, 1e6):
            at = np.geomspace(1e-3, 1.0, 20) * depth * edge
            force = curve(body, at, length * edge)
            assert np.all(np.isfinite(force))
            assert np.all(np.diff(force) > 0)


@TIPS
@pytest.mark.parametrize("ratio", [0.0, 0.2, 5.0])
def test_curves_rise_smoothly(body: Sphere | Paraboloid | Cone, ratio: float) -> None:
    """The derivatives of the force are those that are told, and the stiffness is a punch's."""
    (edge,) = body.kinks
    length, depth = ratio * edge, edge * np.geomspace(1e-3, 3.0, 40)
    found = body.force_curve(depth, length)
    up, down = (curve(body, depth * (1 + d), length) for d in (1e-4, -1e-4))
    assert found.by_depth == pytest.approx((up - down) / 2e-4 / depth, rel=2e-5)
    contact = body.contact_radius(depth, length)
    assert np.all(np.diff(contact.radius) > -1e-7 * edge)
    if length:
        punches = [FlatPunch(radius=float(a)) for a in contact.radius]
        stiffness = [float(curve(one, np.ones(1), length)[0]) for one in punches]
        assert found.by_depth == pytest.approx(stiffness, rel=1e-6)
        up, down = (curve(body, depth, length * (1 + d)) for d in (1e-4, -1e-4))
        assert found.by_length == pytest.approx((up - down) / 2e-4 / length, rel=1e-4)


@pytest.mark.slow
@TIPS
def test_the_grid_solves_the_same(body: Sphere | Paraboloid | Cone) -> None:
    """Under tension the force on a grid, whose error falls with its cells, goes to the curve."""
    (edge,) = body.kinks
    depth, length = 1.5 * edge, 0.5 * edge
    true = float(curve(body, np.array([depth]), length)[0])
    errors = []
    for points in (64, 128, 256):
        run: dict[str, Any] = pressing(
            points, 9 * edge, tensed(1.0, length / 2), body.model_dump(), depth=depth
        )
        errors.append(abs(float(pl.run(run).dataset["force"][-1]) / true - 1))
    assert errors[-1] < 5e-3
    assert errors[-1] < errors[0]


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: pl.indenter("sphere", radius=1e-6, flat_radius=1e-6), "flat_radius"),
        (lambda: pl.indenter("cone", half_angle=1.2, tip_radius=0.0), "tip_radius"),
    ],
)
def test_what_is_no_tip_is_refused(make: Callable[[], object], field: str) -> None:
    """The field is named."""
    with pytest.raises(pl.ConfigError, match=field):
        make()
