"""What a pressure achieves, tractions that are averaged over cells, dilation of sets of cells."""

from typing import Literal

import numpy as np
import pytest

from pellicle import Grid
from pellicle.arrays import Array, Mask
from pellicle.contact.attraction import Attraction, attraction
from pellicle.contact.equilibrium import measure, measure_stiffness
from pellicle.contact.law import Law
from pellicle.contact.masks import dilate
from pellicle.contact.problem import Depth, Force, Problem
from pellicle.grid import Boundary
from pellicle.surface import operator_of
from pellicle_plugins.interactions.finite_range import Linear
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
        np.testing.assert_array_equal(dilate(mask, boundary, cells), boxes(mask, boundary, cells))


def test_a_line() -> None:
    """A set on one axis is dilated along it."""
    line = np.arange(8) == 0
    assert np.flatnonzero(dilate(line, cells=2)).tolist() == [0, 1, 2, 6, 7]


SHAPE = (11, 14)


def law(*, averaged: bool = True, joined: bool = False) -> Law:
    """Return linear softening with a range of 1 and a strength of 2."""
    interaction = Linear(work_of_adhesion=1.0, range=1.0)
    return Law(
        interaction, lambda _: interaction, interaction, needs_contact=joined, averaged=averaged
    )


def gap() -> Array:
    """Return a gap with contact at the edge of the domain, in one patch that ends in cells."""
    x, y = np.indices(SHAPE)
    heights = np.hypot(x - 1.3, y - 2.2) / 2.7 - 1.0 + 0.05 * np.sin(7 * x + 3 * y**2)
    return np.asarray(np.maximum(heights, 0.0))


def attracted(values: Array, boundary: Boundary, law: Law, profile: Array) -> Attraction:
    """Return what a law exerts, with contact where the gap is 0."""
    return attraction(law, profile, values, gap() == 0, boundary)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
@pytest.mark.parametrize("averaged", [False, True])
@pytest.mark.parametrize("joined", [False, True])
def test_the_traction_is_the_derivative_of_the_energy(
    boundary: Boundary, averaged: bool, joined: bool
) -> None:
    """On each cell off the contact, also beside a step, an edge of the domain and no indenter."""
    profile = np.zeros(SHAPE)
    profile[:, 4:6] = -5.0
    profile[5, :3] = -np.inf
    values = np.where(np.isfinite(profile), gap(), np.inf)
    sticky = law(averaged=averaged, joined=joined)
    exerted = attracted(values, boundary, sticky, profile)
    assert np.isfinite(exerted.traction).all()
    generator = np.random.default_rng(1)
    direction = np.where(gap() == 0, 0.0, generator.normal(size=SHAPE))
    step = 1e-5
    low, high = (
        attracted(values + sign * step * direction, boundary, sticky, profile) for sign in (-1, 1)
    )
    acts = exerted.traction != 0
    slope = (high.energy - low.energy) / (2 * step)
    work = -float((exerted.traction * direction)[acts].sum())
    assert abs(work) > 0.1
    assert slope == pytest.approx(work, rel=1e-6)
    change = np.where(gap() == 0, 0.0, (high.traction - low.traction) / (2 * step))
    np.testing.assert_allclose(exerted.change(direction), change, atol=1e-6)
    assert not exerted.change(direction)[~exerted.zone].any()


def test_a_closed_gap_has_strength_and_energy_of_every_cell() -> None:
    """Contact of all cells is that of a law on whole cells, on both boundaries."""
    contact = np.ones(SHAPE, dtype=bool)
    zero = np.zeros(SHAPE)
    boundaries: tuple[Boundary, ...] = ("free", "periodic")
    for boundary in boundaries:
        closed = attraction(law(), zero, zero, contact, boundary)
        np.testing.assert_allclose(closed.traction, -2.0)
        assert closed.energy == pytest.approx(-contact.size)
    # Neither does the edge of a punch lose a share, beyond which there is no indenter.
    profile = np.where(np.indices(SHAPE)[0] < 4, 0.0, -np.inf)
    contact = np.isfinite(profile)
    punch = attraction(law(), profile, np.where(contact, 0.0, np.inf), contact, "free")
    np.testing.assert_allclose(punch.traction, np.where(contact, -2.0, 0.0))
    assert punch.energy == pytest.approx(-np.count_nonzero(contact))


def test_the_energy_hardly_depends_on_the_place_of_an_edge_on_the_cells() -> None:
    """Across a straight zone two cells wide it changes by 0.016 w, with whole cells by 0.049 w."""
    x = np.indices((40, 1))[0] - 12.0

    def spread(sticky: Law) -> float:
        energies = []
        for shift in np.linspace(0.0, 1.0, 21):
            values = 0.25 * np.maximum(x - shift, 0.0) ** 2
            exerted = attraction(sticky, np.zeros(x.shape), values, values == 0, "free")
            energies.append(exerted.energy + shift)
        return float(np.ptp(energies))

    assert spread(law()) < 0.4 * spread(law(averaged=False))
