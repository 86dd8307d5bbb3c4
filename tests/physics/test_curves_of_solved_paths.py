"""Adhesive curves of solved paths against the closed theory under tension and a dense oracle."""

from math import inf, pi, sqrt
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.components import Indenter
from pellicle_axisymmetric import AdhesiveCurve
from pellicle_axisymmetric.adhesive_contact import Adhesion
from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid
from pellicle_plugins.validation.adhesive_path import curve_of
from tests.layered_contact import LayeredContact, layered_contact
from tests.tables_of_runs import heights, pressing, steps, tensed

# The equations are linear, so that lengths and loads may be convenient numbers.
pytestmark = pytest.mark.filterwarnings("ignore:.*are those of the (equations|model)")

PARABOLOID = Paraboloid(radius=1.0)
FORCE = pi
"""πwR for w = R = 1; with E* = 1 too, the length a₀ is 1."""
STEPS = 10


def solved_curve(
    kernel: dict[str, Any],
    indenter: Indenter,
    depths: tuple[float, float],
    size: float,
    points: int,
    work: float = 1.0,
) -> AdhesiveCurve:
    """Return the adhesive curve of a path that is solved between two depths."""
    path = {"start": depths[0], "stop": depths[1], "num": STEPS}
    solved = steps(**pressing(points, size, kernel, indenter, depth=path, stiffness=True))
    return curve_of(solved, work)


def force_at(curve: AdhesiveCurve, depth: float) -> float:
    """Return the force of the branch that is stable at a fixed depth."""
    end = curve.instability(inf).contact_radius
    stable = curve.contact_radius > (end if np.isfinite(end) else 0.0)
    return float(np.interp(depth, curve.depth[stable], curve.force[stable]))


@pytest.mark.slow
@pytest.mark.parametrize(("length", "size"), [(0.0, 7.0), (0.1, 7.0), (1.0, 5.0), (10.0, 5.0)])
def test_under_tension_it_is_the_closed_theory(length: float, size: float) -> None:
    """Force near a = 1.5 a₀, at zero load and pull-off is right to 0.01 πwR."""
    theory = Adhesion(PARABOLOID, 1.0, length / 2, 1.0)
    lowest = 0.6 * float(theory.instability().contact_radius)
    highest = 1.12 * max(1.5, float(theory.at_force(0.0).contact_radius))
    depths = tuple(
        indent(PARABOLOID, 1.0, length / 2, contact_radius=a).depth for a in (lowest, highest)
    )
    kernel = tensed(1.0, length / 2)
    curve = solved_curve(kernel, PARABOLOID, (depths[0], depths[1]), size, 128)
    for contact in (theory.equilibrium(1.5), theory.at_force(0.0)):
        assert abs(force_at(curve, float(contact.depth)) - contact.force) < 0.01 * FORCE
    assert abs(curve.instability().force - theory.instability().force) < 0.01 * FORCE
    radius = curve.at_zero_load().contact_radius
    assert radius == pytest.approx(theory.at_force(0.0).contact_radius, rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("thickness", [7.5, 1.5])
def test_on_a_bonded_layer_it_is_the_dense_solution(thickness: float) -> None:
    """Force near a = 1.5 a₀, where a/h = 0.2 and 1, and pull-off are right to 0.01 πwR."""
    kernel = pl.kernel("bonded_layer", reduced_modulus=1.0, poissons_ratio=0.3, thickness=thickness)

    def hard(a: float) -> LayeredContact:
        return layered_contact(kernel, thickness, a)

    def sticky(a: float) -> tuple[float, float]:
        contact = hard(a)
        retraction = sqrt(4 * pi * a / contact.stiffness_slope)
        return contact.depth - retraction, contact.force - contact.stiffness * retraction

    curve = solved_curve(
        kernel.model_dump(), PARABOLOID, (hard(0.8).depth, hard(2.2).depth), 5.0, 128
    )
    depth, force = sticky(1.5)
    assert abs(force_at(curve, depth) - force) < 0.01 * FORCE
    forces = np.array([sticky(a)[1] for a in np.linspace(1.2, 1.8, 61)])
    assert 0 < forces.argmin() < 60
    assert abs(curve.instability().force - forces.min()) < 0.01 * FORCE


def test_the_oracle_gives_known_stiffnesses() -> None:
    """P = 2E*aδκ, κ = 1.206558 at a/h = 0.2, ν = 0.3 and 3.618736 at a/h = 1, ν = ½."""
    for thickness, ratio, true in ((5.0, 0.3, 1.206558), (1.0, 0.5, 3.618736)):
        kernel = pl.kernel(
            "bonded_layer", reduced_modulus=1.0, poissons_ratio=ratio, thickness=thickness
        )
        low, middle, high = (layered_contact(kernel, thickness, a) for a in (0.999, 1.0, 1.001))
        assert middle.stiffness / 2 == pytest.approx(true, rel=5e-7)
        slope = (high.stiffness - low.stiffness) / 2e-3
        assert slope == pytest.approx(middle.stiffness_slope, rel=1e-5)
        change = (high.force - low.force) / (high.depth - low.depth)
        assert change == pytest.approx(middle.stiffness, rel=1e-5)


@pytest.mark.slow
def test_on_a_cone_it_is_the_closed_theory() -> None:
    """Force and radius of pull-off of a cone under tension are right to 1 % at 32 cells."""
    cone = Cone(half_angle=1.2)
    theory = Adhesion(cone, 1.0, 0.25, 0.1)
    pull_off = theory.instability()
    a = float(pull_off.contact_radius)
    low, high = (indent(cone, 1.0, 0.25, contact_radius=a * share).depth for share in (0.4, 1.6))
    curve = solved_curve(tensed(1.0, 0.25), cone, (low, high), 4 * a, 128, 0.1)
    assert curve.instability().force == pytest.approx(pull_off.force, rel=0.01)
    assert curve.instability().contact_radius == pytest.approx(a, rel=0.01)


def test_a_curve_that_still_falls_at_its_end_has_no_lowest_force() -> None:
    """An edge holds −1 N, and a contact beyond the path less."""
    force, radius = np.array([-1.0, 1.0, -0.5, -2.0, -3.0, 1.0]), np.array([1.0, *range(1, 6)])
    assert AdhesiveCurve(radius, force, force).instability().force < -2.9
    assert np.isnan(AdhesiveCurve(radius[:-1], force[:-1], force[:-1]).instability()).all()


def test_heights_in_memory_have_a_curve() -> None:
    """Of a truncated cone as an array the configuration keeps the hash alone."""
    x = (np.arange(48) - 23.5) / 8
    cone = heights(-0.7 * np.maximum(np.hypot(x[:, None], x) - 0.8, 0))
    load = {"depth": [*np.geomspace(0.01, 1.2, 16)], "stiffness": True}
    grid = {"points": 48, "size": 6.0}
    solved = steps(grid=grid, kernel=tensed(1.0, 0.0), indenter=cone, loading=load)
    end = curve_of(solved, 0.1).instability()
    assert end.force == pytest.approx(-sqrt(8 * pi * 0.1 * end.contact_radius**3), rel=0.03)
