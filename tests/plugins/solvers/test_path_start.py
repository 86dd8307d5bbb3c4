"""Load steps that start from the last two, extrapolated: same answers, fewer applications."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle.numerics.equilibrium import Equilibrium, measure
from pellicle.numerics.path import PathPoint, Start, start_of
from pellicle.numerics.problem import Depth, Force
from pellicle.operators import Array, make_operator
from pellicle_plugins.solvers.active_set import ActiveSet

TOLERANCE = 1e-9
INDENTERS: dict[str, dict[str, Any]] = {
    "smooth": {"type": "paraboloid", "radius": 2.236},
    "rough": {"type": "self_affine", "rms_height": 0.01, "hurst": 0.8, "cutoff_wavelength": 0.125},
}
CASES = [("smooth", "free", Depth), ("rough", "periodic", Force), ("rough", "free", Depth)]


@cache
def problem(shape: str, boundary: Any, tension: float = 0.01, shift: int = 0) -> pl.Problem:
    """Return a problem of 64 x 64 cells at a depth of 0.1, its profile rolled."""
    grid = pl.Grid(points=64, size=1.0, boundary=boundary)
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=tension)
    options = {"seed": 1} if shape == "rough" else {}
    shaped = {**INDENTERS[shape], **options}
    profile = pl.indenter(shaped.pop("type"), **shaped).profile(*grid.coordinates())
    operator = make_operator(kernel, grid)
    return pl.Problem(grid, operator, np.roll(profile, shift, (0, 1)), Depth(0.1))


def solved(here: pl.Problem, start: pl.State | None) -> tuple[Equilibrium, int]:
    """Return the equilibrium and its operator applications."""
    before = here.operator.applications
    solution = ActiveSet(tolerance=TOLERANCE).solve(here, start, lambda *_: None)
    used = here.operator.applications - before
    return measure(here, solution.pressure), used


def point(equilibrium: Equilibrium) -> PathPoint:
    """Return a solved step as a point of its path."""
    return PathPoint(equilibrium.state, equilibrium.gap)


def steps(here: pl.Problem, values: list[float]) -> list[PathPoint]:
    """Return the points of a path, each solved on its own."""
    kind = type(here.control)
    return [point(solved(replace(here, control=kind(v)), None)[0]) for v in values]


@pytest.mark.parametrize(("shape", "boundary", "control"), CASES)
@pytest.mark.parametrize("direction", [0.05, -0.05])
def test_answer_does_not_depend_on_the_start(
    shape: str, boundary: str, control: type[Depth] | type[Force], direction: float
) -> None:
    """A step from two states ends where it does from none, with fewer applications than from one.

    Measured, from one and from two states: 14 to 22 and 9 to 18.
    """
    value = 0.1 if control is Depth else 0.01
    here = replace(problem(shape, boundary), control=control(value))
    path = steps(here, [value * (1 - 2 * direction), value * (1 - direction)])
    state = path[-1].state
    start = start_of(here, state, path)
    assert isinstance(start, Start)
    assert start.ahead
    cold, _ = solved(here, None)
    one, used = solved(here, state)
    two, fewer = solved(here, start)
    assert fewer < used
    greatest = float(cold.pressure.max())
    for equilibrium in (one, two):
        assert equilibrium.residual <= TOLERANCE
        np.testing.assert_array_equal(equilibrium.contact, cold.contact)
        np.testing.assert_allclose(equilibrium.pressure, cold.pressure, atol=1e-5 * greatest)


@pytest.mark.parametrize("value", [0.099, 0.1, 0.1021])
def test_nothing_is_extrapolated_backwards_or_far(value: float) -> None:
    """After a reversal, without a step, or beyond twice the last step, the last state is it."""
    here = problem("smooth", "free")
    path = steps(here, [0.099, 0.1])
    assert start_of(replace(here, control=Depth(value)), path[-1].state, path) is path[-1].state
    forward = start_of(replace(here, control=Depth(0.101)), path[-1].state, path)
    assert isinstance(forward, Start)


def test_nothing_is_extrapolated_from_one_state() -> None:
    """A first step has no start, and a second the state of the first."""
    here = problem("smooth", "free")
    only = steps(here, [0.09])
    assert start_of(here, None, ()) is None
    assert start_of(here, only[0].state, only) is only[0].state


def test_nothing_is_extrapolated_in_a_solid_that_relaxes() -> None:
    """What earlier steps leave behind changes the surface as well, so that two states say less."""
    here = problem("smooth", "free")
    path = steps(here, [0.08, 0.09])
    relaxing = replace(here, left=np.zeros(here.grid.shape))
    assert start_of(relaxing, path[-1].state, path) is path[-1].state


def test_force_and_spring_are_extrapolated_by_their_own_control() -> None:
    """The same two states lead to the same pressure by force, depth, and depth of a base."""
    here = problem("smooth", "free")
    path = steps(here, [0.08, 0.09])
    forces = [float(p.state.pressure.sum()) * here.grid.cell_area for p in path]
    bases = [p.state.depth + 0.3 * force for p, force in zip(path, forces, strict=True)]
    pressures: list[Array] = []
    for control in (
        Depth(0.1),
        Force(2 * forces[1] - forces[0]),
        Depth(2 * bases[1] - bases[0], compliance=0.3),
    ):
        start = start_of(replace(here, control=control), path[-1].state, path)
        assert isinstance(start, Start)
        assert start.ahead
        pressures.append(start.ahead.pressure)
    for pressure in pressures[1:]:
        np.testing.assert_allclose(pressure, pressures[0], atol=1e-10 * pressures[0].max())


def test_extrapolated_contact_moves_with_a_periodic_surface() -> None:
    """Contact that grows across the edge of the period is extrapolated as it is elsewhere."""
    ahead = []
    for shift in (0, 21):
        here = replace(problem("rough", "periodic", shift=shift), control=Force(0.012))
        path = steps(here, [0.010, 0.011])
        start = start_of(here, path[-1].state, path)
        assert isinstance(start, Start)
        assert start.ahead
        assert np.count_nonzero(start.ahead.contact) > np.count_nonzero(path[-1].state.contact)
        ahead.append(start.ahead.contact)
    np.testing.assert_array_equal(np.roll(ahead[0], 21, (0, 1)), ahead[1])


def test_extrapolated_edge_moves_as_far_as_the_edge_does() -> None:
    """On a smooth indenter the contact ahead misses at most one cell in 50; the last one in 10."""
    here = problem("smooth", "free", tension=1e-9)
    path = steps(here, [0.06, 0.08])
    start = start_of(here, path[-1].state, path)
    assert isinstance(start, Start)
    assert start.ahead
    answer = solved(here, None)[0].contact
    cells = np.count_nonzero(answer)
    missed = np.count_nonzero(start.ahead.contact ^ answer) / cells
    assert missed < 0.02 < 0.1 < np.count_nonzero(path[-1].state.contact ^ answer) / cells


class Recorder(pl.Solver):
    """A solver that knows no extrapolation: it unpacks its start, as any state."""

    type: Literal["recorder"] = "recorder"

    def solve(self, problem: pl.Problem, start: pl.State | None, monitor: Any) -> pl.Solution:
        """Return the solution from the state of the last step."""
        if start is not None:
            pressure, wall, depth = start
            assert start.depth == depth
            start = pl.State(pressure, wall, depth)
        return ActiveSet(tolerance=self.tolerance).solve(problem, start, monitor)


def test_solver_that_knows_no_extrapolation_starts_from_the_last_state() -> None:
    """A start with an extrapolation is a state of three values, equal to the one it extends."""
    here = problem("smooth", "free")
    path = steps(here, [0.08, 0.09])
    start = start_of(here, path[-1].state, path)
    assert isinstance(start, Start)
    solution = Recorder(tolerance=TOLERANCE).solve(here, start, lambda *_: None)
    plain = ActiveSet(tolerance=TOLERANCE).solve(here, path[-1].state, lambda *_: None)
    np.testing.assert_array_equal(solution.pressure, plain.pressure)


def test_resumed_path_is_the_same(tmp_path: Any) -> None:
    """A run that goes on from its file extrapolates from the steps in it, to the same numbers."""
    run = pl.Run(
        title="path",
        grid={"points": 32, "size": 1.0},
        kernel={"type": "half_space", "reduced_modulus": 1.0},
        indenter=INDENTERS["smooth"],
        loading={"depth": [0.06, 0.07, 0.08, 0.07]},
        outputs=[],
    )
    whole = pl.run(run, directory=tmp_path / "whole", progress=False).dataset
    (tmp_path / "part").mkdir()
    (file,) = (tmp_path / "whole").glob("*.h5")
    pl.Result(whole.isel(step=slice(0, 2))).save(tmp_path / "part" / file.name)
    resumed = pl.run(run, directory=tmp_path / "part", progress=False).dataset
    for name in ("pressure", "gap", "operator_applications"):
        np.testing.assert_array_equal(resumed[name], whole[name], err_msg=name)
