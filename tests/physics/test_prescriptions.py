"""A cantilever and a volume of the gap, against closed forms, limits and what a result has."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq

import pellicle as pl
from pellicle.components.calls import solution_of
from pellicle.contact import Problem, measure
from pellicle.surface import operator_of
from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.tables_of_runs import ROUGH, Table, half_space, paraboloid, steps, tensed

SKIN, BARE, TIP = tensed(1e4, 0.1), half_space(1e4), paraboloid(1e-3)
pytestmark = pytest.mark.filterwarnings("ignore:.*too coarse for this contact")


def _base(boundary: str, kernel: dict[str, Any], indenter: dict[str, Any]) -> dict[str, Any]:
    grid = {"points": 32, "size": 1e-3, "boundary": boundary}
    return {"grid": grid, "kernel": kernel, "indenter": indenter}


CASES = {
    f"{boundary} {kernel['type']} {indenter['type']}": _base(boundary, kernel, indenter)
    for boundary in ("free", "periodic")
    for kernel in (BARE, SKIN)
    for indenter in (TIP, ROUGH)
}


def _solved(base: dict[str, Any], solver: str = "active_set", **loading: Any) -> xr.Dataset:
    return steps(solver, 1e-9, **base, loading=loading)


@pytest.mark.parametrize("base", CASES.values(), ids=CASES)
def test_cantilever_is_in_balance(base: dict[str, Any], solver: str) -> None:
    """F = k (z − δ) to rounding, for a spring a tenth to ten times as stiff as the contact."""
    by_depth = _solved(base, solver, depth=1.2e-5, stiffness=True)
    contact = by_depth["stiffness"].item()
    for ratio in (0.1, 1.0, 10.0):
        spring, base_at = contact * ratio, [4e-6, 2e-5]
        data = _solved(base, solver, base_displacement=base_at, spring_constant=spring)
        force = spring * (np.array(base_at) - data["depth"].values)
        np.testing.assert_allclose(data["force"], force, rtol=0, atol=1e-14 * spring * 2e-5)
        np.testing.assert_allclose(data["base_displacement"], base_at, rtol=1e-14)
        # The displacement is that of the surface, without the deflection of the spring.
        for step in data["step"].values:
            fields = data.sel(step=step)
            again = pl.displacement(
                fields["pressure"].values,
                kernel=pl.Run(**base, loading={"depth": 0}).kernel,
                grid=pl.Grid(**base["grid"]),
            )
            np.testing.assert_array_equal(fields["displacement"], again)


@pytest.mark.parametrize("base", CASES.values(), ids=CASES)
def test_spring_adds_nothing_to_the_state(base: dict[str, Any], solver: str) -> None:
    """At the base's displacement of a known depth the state is that of the depth, stiffness too."""
    known = _solved(base, solver, depth=1.2e-5, stiffness=True)
    force, contact = known["force"].item(), known["stiffness"].item()
    for ratio in (1e-5, 1e-2, 1.0, 100.0):
        spring = contact / ratio
        data = _solved(
            base,
            solver,
            base_displacement=1.2e-5 + force / spring,
            spring_constant=spring,
            stiffness=True,
        )
        assert data["force"].item() == pytest.approx(force, rel=1e-7)
        assert data["depth"].item() == pytest.approx(1.2e-5, rel=1e-7)
        assert data["contact_area"].item() == known["contact_area"].item()
        assert data["stiffness"].item() == pytest.approx(contact, rel=1e-6)


@pytest.mark.parametrize("base", CASES.values(), ids=CASES)
def test_stiff_and_soft_springs(base: dict[str, Any]) -> None:
    """A spring that does not yield prescribes the depth, one that only yields the force."""
    known = _solved(base, depth=1.2e-5)
    force = known["force"].item()
    stiff = _solved(base, base_displacement=1.2e-5, spring_constant=1e12)
    assert stiff["force"].item() == pytest.approx(force, rel=1e-9)
    soft = _solved(base, base_displacement=1.0, spring_constant=force)
    assert soft["force"].item() == pytest.approx(force, rel=1e-4)
    assert soft["depth"].item() == pytest.approx(1.2e-5, rel=1e-3)


@pytest.mark.parametrize("base", CASES.values(), ids=CASES)
def test_cantilever_costs_what_a_depth_costs(base: dict[str, Any]) -> None:
    """For springs soft and stiff, applications of the operator are as many, within 4.

    A grid that is not coarsened has no better start than an overlap by all of z.
    """
    base = base | {"grid": base["grid"] | {"points": 64}}
    known = _solved(base, depth=1.2e-5, stiffness=True)
    for ratio in (1e-2, 1.0, 1e2):
        spring = known["stiffness"].item() * ratio
        z = 1.2e-5 + known["force"].item() / spring
        data = _solved(base, base_displacement=z, spring_constant=spring)
        allowed = known["operator_applications"].item() + 4
        assert data["operator_applications"].item() <= allowed, ratio


def _hertz(depth: float) -> float:
    return float(4 / 3 * 1e4 * 1e-3**0.5 * depth**1.5)


def _tensed(depth: float) -> float:
    return indent(Paraboloid(radius=1e-3), 1e4, 0.1, depth=depth).force


@pytest.mark.parametrize(
    ("kernel", "true_force", "spring", "error"),
    [(BARE, _hertz, 0.5, 2e-3), pytest.param(SKIN, _tensed, 2.0, 5e-3, marks=pytest.mark.slow)],
    ids=["Hertz", "tension"],
)
def test_cantilever_on_a_paraboloid(
    kernel: Table, true_force: Callable[[float], float], spring: float, error: float, solver: str
) -> None:
    """δ solves F(δ) = k (z − δ), F of Hertz or by the axisymmetric integral equation."""
    z = 3e-5
    depth = brentq(lambda d: true_force(d) - spring * (z - d), 1e-6, z, xtol=1e-12)
    base = _base("free", kernel, TIP) | {"grid": {"points": 64, "size": 4e-4}}
    data = _solved(base, solver, base_displacement=z, spring_constant=spring)
    assert data["depth"].item() == pytest.approx(depth, rel=error)
    assert data["force"].item() == pytest.approx(spring * (z - depth), rel=error)


def test_cantilever_in_full_contact(solver: str) -> None:
    """Where no load moves the mean plane the spring takes all of the displacement beyond it."""
    base = _base("periodic", BARE, ROUGH)
    run = pl.Run(**base, loading={"depth": 0})
    full = -float(run.indentation.indenter.profile(*run.grid.coordinates()).mean())
    with pytest.raises(pl.ConfigError, match="beyond full contact"):
        _solved(base, solver, depth=full + 1e-6)
    data = _solved(base, solver, base_displacement=full + 0.1, spring_constant=1.0, stiffness=True)
    assert data["contact"].all()
    assert data["depth"].item() == pytest.approx(full, rel=1e-7)
    assert data["force"].item() == pytest.approx(0.1, rel=1e-9)
    assert data["stiffness"].item() == np.inf


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_coarser_problem_has_the_same_spring(boundary: str) -> None:
    """The deflection under a uniform pressure, and so the force, stay those of the fine grid."""
    run = pl.Run(**_base(boundary, SKIN, TIP), loading={"depth": 0})
    profile = run.indentation.indenter.profile(*run.grid.coordinates())
    operator = operator_of(run.kernel, run.grid)
    fine = Problem(run.grid, operator, profile, pl.Depth(2e-5, compliance=0.7))
    coarse = fine.coarsened()
    for problem in (fine, coarse, fine.scaled(2.0**-20, 2.0**5).scaled(2.0**20, 2.0**-5)):
        uniform = np.ones(problem.grid.shape)
        bare = problem.operator.with_spring(0.0)(uniform)
        deflection = problem.operator(uniform) - bare
        np.testing.assert_allclose(deflection, 0.7 * run.grid.area, rtol=1e-12)
    assert fine.operator is not operator
    assert fine.operator.with_spring(0.0)(profile * 0 + 1.0) == pytest.approx(
        operator(profile * 0 + 1.0)
    )
    depths = [
        measure(p, solution_of(run.solver, p, None, lambda *_: None).pressure).depth
        for p in (fine, coarse)
    ]
    assert depths[1] == pytest.approx(depths[0], rel=0.05)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_cantilever_at_any_scale(boundary: str) -> None:
    """Lengths times a factor make forces times its square, springs times the factor."""
    results = []
    for length in (1.0, 1e-12, 1e6):
        grid = {"points": 32, "size": length, "boundary": boundary}
        base = {"grid": grid, "kernel": BARE, "indenter": paraboloid(length)}
        data = _solved(base, base_displacement=0.05 * length, spring_constant=1e3 * length)
        results.append((data["force"].item() / length**2, data["depth"].item() / length))
    for scaled in results[1:]:
        assert scaled == pytest.approx(results[0], rel=1e-9)


@pytest.mark.parametrize("base", [CASES[name] for name in CASES if ROUGH["type"] in name])
def test_gap_volume_is_met(base: dict[str, Any], solver: str) -> None:
    """The sum of the gaps of a result times the area of a cell is the volume prescribed."""
    known = _solved(base, solver, depth=[6e-6, 1.2e-5])
    cell = (1e-3 / 32) ** 2
    volumes = known["gap"].sum(["x", "y"]).values * cell
    assert volumes[1] < volumes[0]
    data = _solved(base, solver, gap_volume=volumes[::-1])
    np.testing.assert_allclose(data["gap"].sum(["x", "y"]) * cell, volumes[::-1], rtol=2e-6)
    np.testing.assert_allclose(data["gap_volume"], volumes[::-1], rtol=2e-6)
    np.testing.assert_allclose(data["residual_gap_volume"], 0, atol=2e-6)
    np.testing.assert_allclose(data["depth"], known["depth"][::-1], rtol=1e-4)


def test_no_gap_is_full_contact(solver: str) -> None:
    """A volume of 0 is full contact, that of first touch no force worth speaking of."""
    base = _base("periodic", BARE, ROUGH)
    data = _solved(base, solver, gap_volume=0)
    assert data["contact"].all()
    assert data["gap_volume"].item() == pytest.approx(0, abs=1e-18)
