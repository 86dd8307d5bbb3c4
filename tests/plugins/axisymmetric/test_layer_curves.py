"""Force curves on a bonded layer against independent solutions, limits and the FFT solver."""

from typing import Any

import curve_tables
import numpy as np
import pytest
from layer_equation import half_space, moments

import pellicle as pl
from pellicle.arrays import Array
from pellicle_axisymmetric import layer_curves, splines
from tests.layered_contact import layered_contact, tensed_layer_contact

SHAPES: dict[str, dict[str, float]] = {
    "paraboloid": {"radius": 2.0},
    "sphere": {"radius": 2.0},
    "cone": {"half_angle": 1.2},
    "flat_punch": {"radius": 2.0},
}


def shape(name: str) -> Any:
    """Return an indenter with the curves of a layer."""
    indenter = pl.indenter(name, **SHAPES[name])
    assert isinstance(indenter, pl.HasLayerForceCurve)
    return indenter


def layer(thickness: float, ratio: float, length: float = 0.0) -> pl.Kernel:
    """Return a bonded layer with E* = 1 Pa under a tension."""
    fields = {"type": "bonded_layer", "poissons_ratio": ratio, "thickness": thickness}
    return pl.kernel("coated", tension=length / 2, substrate=fields | {"reduced_modulus": 1.0})


@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.37, 0.49, 0.5])
@pytest.mark.parametrize("confinement", [0.05, 0.5, 2.0, 6.0])
def test_without_tension_it_is_the_dense_solution(ratio: float, confinement: float) -> None:
    """Force of a paraboloid at the depth of an independent solution, to 2e-5."""
    thickness = 1 / confinement
    exact = layered_contact(layer(thickness, ratio), thickness, 1.0, radius=2.0)
    curve = shape("paraboloid").layer_force_curve(np.array([exact.depth]), 0.0, thickness, ratio)
    assert curve.force[0] == pytest.approx(exact.force, rel=2e-5)


@pytest.mark.parametrize(("length", "allowed"), [(1.0, 3e-5), (10.0, 1e-5)])
@pytest.mark.parametrize(("thickness", "ratio"), [(0.3, 0.5), (0.4, 0.3), (5.0, 0.45)])
def test_under_tension_it_is_a_galerkin_solution(
    length: float, allowed: float, thickness: float, ratio: float
) -> None:
    """Force of a paraboloid at the depth of a solution by Bessel functions of the whole symbol."""
    force, depth = tensed_layer_contact(layer(thickness, ratio, length), radius=2.0)
    curve = shape("paraboloid").layer_force_curve(np.array([depth]), length, thickness, ratio)
    assert curve.force[0] == pytest.approx(force, rel=allowed)


@pytest.mark.parametrize(
    ("confinement", "ratio", "factor"), [(0.2, 0.3, 1.206558), (1.0, 0.5, 3.618736)]
)
def test_punch_has_known_factors(confinement: float, ratio: float, factor: float) -> None:
    """A flat punch is κ times as stiff as on a half-space."""
    thickness = 2.0 / confinement
    curve = shape("flat_punch").layer_force_curve(np.array([0.1]), 0.0, thickness, ratio)
    assert curve.force[0] == pytest.approx(2 * 2.0 * 0.1 * factor, rel=1e-5)


@pytest.mark.parametrize("name", SHAPES)
def test_between_nodes_it_is_the_equation(name: str) -> None:
    """Forces at random thickness, tension and Poisson's ratio, to 1e-4."""
    rng = np.random.default_rng(3)
    indenter = shape(name)
    for _ in range(12):
        a = 2.0 if name == "flat_punch" else 1.6 * rng.uniform(0.05, 1)
        thickness, ratio = a / 10 ** rng.uniform(-2, 1), float(rng.uniform(0, 0.5))
        length = thickness * 10 ** rng.uniform(-3, 2) * rng.choice([0, 1, 1])
        kind = {"cone": "pointed", "flat_punch": "punch"}.get(name, "smooth")
        equation = half_space(kind, length / a)  # type: ignore[arg-type]
        t = equation.nodes.t
        slopes = np.ones_like(t) if kind == "punch" else indenter.abel_slope(a * t)
        solved = moments(equation, slopes[:, None], a / thickness, ratio)
        depth = a * solved.depth
        curve = indenter.layer_force_curve(depth, length, thickness, ratio)
        assert curve.force[0] == pytest.approx(float(solved.force[0]) * a**2, rel=1e-4)


@pytest.mark.parametrize(("shape", "length", "confinement"), [("smooth", 9, 20), ("punch", 0, 30)])
def test_the_table_is_what_its_script_makes(
    shape: layer_curves.Shape, length: int, confinement: int
) -> None:
    """A node of the table, made anew, is that of the file, which is rounded."""
    s, a = layer_curves.LENGTHS[length], layer_curves.CONFINEMENTS[confinement]
    shipped = splines.table_in(layer_curves.FILE)[f"{shape}_layer"][:, length, confinement]
    assert curve_tables.change_by_layer(shape, s, a) == pytest.approx(shipped, abs=2.0**-24)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("share", [0.01, 0.1, 0.4, 1.0])
def test_derivatives(name: str, share: float) -> None:
    """Derivatives are those of the force; none before contact."""
    indenter, ratio = shape(name), 0.47
    for thickness, length in ((1.0, 0.02), (0.3, 3.0), (30.0, 0.1)):
        limit = indenter.layer_depth_limit(thickness, ratio)
        values = np.array([share * limit, length, thickness])

        def force(values: Array) -> float:
            depth, length, thickness = values
            at = np.array([-depth, depth])
            return float(indenter.layer_force_curve(at, length, thickness, ratio).force[1])

        at = np.array([-values[0], values[0]])
        curve = indenter.layer_force_curve(at, length, thickness, ratio)
        assert all(part[0] == 0 for part in curve)
        steps = 1e-4 * np.diag(values)
        numerical = [(force(values + h) - force(values - h)) / 2e-4 for h in steps]
        analytic = [part[1] * value for part, value in zip(curve[1:], values, strict=True)]
        assert analytic == pytest.approx(numerical, rel=1e-3, abs=2e-4 * curve.force[1])


@pytest.mark.parametrize("name", SHAPES)
def test_a_thick_layer_is_a_half_space(name: str) -> None:
    """The force tends to that on a half-space in proportion to a/h."""
    indenter = shape(name)
    depth = np.linspace(-0.1, 0.8, 50) * 2.0
    exact = indenter.force_curve(depth, 0.05)
    for thickness in (1e9, 1e15):
        curve = indenter.layer_force_curve(depth, 0.05, thickness, 0.4)
        assert curve.force == pytest.approx(exact.force, rel=1e-6)
        assert curve.by_depth == pytest.approx(exact.by_depth, rel=1e-5)
        assert curve.by_length == pytest.approx(exact.by_length, rel=1e-4)


def test_it_knows_no_units() -> None:
    """Lengths a million times as small give forces a million million times as small."""
    depth = np.geomspace(1e-3, 0.3, 20)
    small = pl.indenter("sphere", radius=2e-6)
    assert isinstance(small, pl.HasLayerForceCurve)
    curve = small.layer_force_curve(1e-6 * depth, 1e-7, 4e-7, 0.5)
    large = shape("sphere").layer_force_curve(depth, 0.1, 0.4, 0.5)
    assert 1e12 * curve.force == pytest.approx(large.force, rel=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_extremes_are_finite(name: str) -> None:
    """Any depth, tension and thickness gives numbers, and more depth or tension more force."""
    indenter = shape(name)
    depth = np.geomspace(1e-50, 1e3, 40)
    for thickness in (1e-6, 1.0, 1e12):
        for length in (0.0, 1e-9, 1e9):
            curve = indenter.layer_force_curve(depth, length, thickness, 0.5)
            assert all(np.isfinite(part).all() for part in curve)
            assert (np.diff(curve.force) > 0).all()


def test_the_limit_is_in_the_table() -> None:
    """The limit is the depth at which a contact is ten times as wide as the layer is thick."""
    wide, thick = shape("paraboloid"), pl.indenter("paraboloid", radius=1e3)
    equation = half_space("smooth", 0.0)
    exact = moments(equation, 2 * equation.nodes.t[:, None] / 1e3, 10.0, 0.5).depth[0]
    assert isinstance(thick, pl.HasLayerForceCurve)
    assert thick.layer_depth_limit(0.1, 0.5) == pytest.approx(exact, rel=1e-4)
    # Here the indenter would reach the base first.
    assert wide.layer_depth_limit(0.1, 0.5) == 0.1


def test_it_is_what_the_solver_finds() -> None:
    """Forces of the FFT solver, extrapolated over two grids, to 3e-3."""
    depth, thickness, ratio, length = 0.3, 0.8, 0.5, 0.3
    forces = []
    for points in (32, 64):
        run = pl.Run(
            grid={"points": points, "size": 4.0},
            kernel=layer(thickness, ratio, length).model_dump(exclude_none=True),
            indenter={"type": "paraboloid", "radius": 2.0},
            loading={"depth": depth},
            outputs=[],
        )
        forces.append(float(pl.run(run, progress=False).dataset["force"][0]))
    exact = shape("paraboloid").layer_force_curve(np.array([depth]), length, thickness, ratio)
    assert 2 * forces[1] - forces[0] == pytest.approx(exact.force[0], rel=3e-3)


def test_other_tensions_of_a_layer_share_splines(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fit of a given thickness builds the splines over s/h and a/h once, for all tensions."""
    bead, depth = shape("sphere"), np.array([0.01, 0.02])
    bead.layer_force_curve(depth, 0.1, 0.4, 0.3)
    monkeypatch.setattr(layer_curves, "stretched_spline", None)
    bead.layer_force_curve(depth, 0.2, 0.4, 0.3)
