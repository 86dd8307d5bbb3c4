"""What a pressure achieves, on springs, known in closed form; dilation of sets of cells."""

from typing import Literal

import numpy as np
import pytest

from pellicle import Grid
from pellicle.arrays import Array, Mask
from pellicle.contact.equilibrium import measure, measure_stiffness
from pellicle.contact.masks import dilated
from pellicle.contact.problem import Depth, Force, Problem
from pellicle.grid import Boundary
from pellicle.surface import operator_of
from pellicle_plugins.kernels.winkler import Winkler

FOUNDATION, RADIUS, DEPTH = 2e8, 1e-3, 4e-6
GRID = Grid(points=(24, 20), size=(0.48e-3, 0.4e-3), boundary="periodic")


def springs(control: Depth | Force) -> tuple[Problem, Array]:
    """Return a paraboloid on springs, and the pressure k (δ + f) at a depth of 4 µm."""
    x, y = GRID.coordinates()
    profile = np.asarray(-(x**2 + y**2) / (2 * RADIUS))
    pressure = FOUNDATION * np.maximum(DEPTH + profile, 0.0)
    operator = operator_of(Winkler(foundation=FOUNDATION), GRID)
    return Problem(GRID, operator, profile, control), pressure


@pytest.mark.parametrize("kind", ["depth", "force"])
def test_the_solution_has_no_residual(kind: Literal["depth", "force"]) -> None:
    """Depth, force and gap are those of springs; nothing is left over but rounding."""
    _, pressure = springs(Depth(DEPTH))
    force = float(pressure.sum()) * GRID.cell_area
    problem, _ = springs(Depth(DEPTH) if kind == "depth" else Force(force))
    state = measure(problem, pressure)
    assert state.force == pytest.approx(force, rel=1e-12)
    assert state.depth == pytest.approx(DEPTH, rel=1e-12)
    np.testing.assert_allclose(
        state.gap, np.maximum(-DEPTH - problem.profile, 0.0), atol=1e-12 * DEPTH
    )
    assert np.array_equal(state.contact, pressure > 0)
    for residual in ("contact", "penetration", "complementarity", "load"):
        assert getattr(state, f"residual_{residual}") < 1e-12


def test_too_high_a_pressure_opens_gaps_in_contact() -> None:
    """Pressures 1 % too high leave 1 % of each displacement as a gap, under force 1 % of the load.

    Gaps are judged by the height range in contact; complementarity by the mean of Σ p g.
    """
    problem, pressure = springs(Depth(DEPTH))
    state = measure(problem, 1.01 * pressure)
    contact = pressure > 0
    scale = float(np.ptp(problem.profile[contact]))
    displacement = pressure[contact] / FOUNDATION
    assert state.residual_contact == pytest.approx(0.01 * displacement.max() / scale, rel=1e-9)
    weighted = (pressure[contact] * 0.01 * displacement).sum() / pressure.sum()
    assert state.residual_complementarity == pytest.approx(weighted / scale, rel=1e-9)
    assert state.residual_load == 0
    force = float(pressure.sum()) * GRID.cell_area
    assert measure(springs(Force(force))[0], 1.01 * pressure).residual_load == pytest.approx(0.01)


def test_a_cell_without_pressure_is_penetrated() -> None:
    """Where a cell in contact carries nothing the indenter is below the surface by δ + f."""
    problem, pressure = springs(Depth(DEPTH))
    i, j = np.unravel_index(np.argmax(pressure), pressure.shape)
    missing = float(pressure[i, j]) / FOUNDATION
    pressure[i, j] = 0.0
    state = measure(problem, pressure)
    assert state.gap[i, j] == pytest.approx(-missing, rel=1e-9)
    scale = float(np.ptp(problem.profile[pressure > 0]))
    assert state.residual_penetration == pytest.approx(missing / scale, rel=1e-9)
    assert state.residual_contact < 1e-12


def test_under_force_the_mean_gap_in_contact_vanishes() -> None:
    """The depth is the mean of u − f over the contact, whatever the pressure (Polonsky & Keer)."""
    problem, pressure = springs(Force(1e-3))
    contact = pressure > 0
    state = measure(problem, np.where(contact, 300.0, 0.0))
    assert state.depth == pytest.approx(float((300 / FOUNDATION - problem.profile)[contact].mean()))
    assert float(state.gap[contact].mean()) == pytest.approx(0, abs=1e-12 * state.depth)


def test_no_pressure_just_touches() -> None:
    """Without pressure the depth under force is 0, and no residual is NaN."""
    problem, pressure = springs(Force(1e-3))
    state = measure(problem, 0 * pressure)
    assert (state.depth, state.force, state.residual_complementarity) == (0, 0, 0)
    assert state.residual_load == 1


def test_stiffness_is_stationary() -> None:
    """The stiffness of springs is k times the area; of pressures off by e it is off by e² only."""
    problem, pressure = springs(Depth(DEPTH))
    contact = pressure > 0
    response = np.where(contact, FOUNDATION, 0.0)
    expected = FOUNDATION * np.count_nonzero(contact) * GRID.cell_area
    exact = measure_stiffness(problem, contact, response)
    assert exact.value == pytest.approx(expected, rel=1e-12)
    assert exact.residual < 1e-12
    for error in (1e-2, -1e-2, 1e-1):
        inexact = measure_stiffness(problem, contact, (1 + error) * response)
        assert inexact.value == pytest.approx((1 - error**2) * expected, rel=1e-12)
        assert inexact.residual == pytest.approx(abs(error), rel=1e-9)


def boxes(mask: Mask, boundary: Boundary, cells: int) -> Mask:
    """Return the union of boxes around the cells of a mask, cell by cell."""
    union = np.zeros_like(mask)
    offsets = np.arange(-cells, cells + 1)
    for cell in np.argwhere(mask):
        lines = [place + offsets for place in cell]
        if boundary == "periodic":
            lines = [line % n for line, n in zip(lines, mask.shape, strict=True)]
        else:
            lines = [
                line[(line >= 0) & (line < n)] for line, n in zip(lines, mask.shape, strict=True)
            ]
        union[np.ix_(*lines)] = True
    return union


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("cells", [0, 1, 2, 4, 7, 40])
def test_boxes(boundary: Boundary, cells: int) -> None:
    """A dilated set is the union of boxes around its cells, on grids of any shape."""
    rng = np.random.default_rng(5)
    for shape in ((1, 1), (1, 9), (9, 1), (12, 17), (30, 30)):
        mask = rng.random(shape) < 0.02
        mask.flat[0] = True
        np.testing.assert_array_equal(dilated(mask, boundary, cells), boxes(mask, boundary, cells))


def test_a_line() -> None:
    """A set on one axis is dilated along it."""
    line = np.arange(8) == 0
    assert np.flatnonzero(dilated(line, cells=2)).tolist() == [0, 1, 2, 6, 7]
