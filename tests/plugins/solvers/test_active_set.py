"""The hard cases of `active_set`, each against `conjugate_gradient` or a closed form.

Lengths are those of a domain of edge 1, the modulus E* is 1; s = 2τ₀/E* is the elastocapillary
length. Operator applications are those on the finest grid. They do not depend on the machine but
for round-off; each bound stands next to what was measured.
"""

from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle import ConfigError, Grid, Isotropic, Kernel, Problem, Stop
from pellicle.arrays import Array
from pellicle.contact.problem import Depth, Force
from pellicle.surface import operator_of
from pellicle_plugins.kernels.skins import BendingSkin
from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.conjugate_gradient import ConjugateGradient
from pellicle_plugins.solvers.contact_cg import inner_solve
from pellicle_plugins.solvers.preconditioner import Preconditioner
from tests.plugins.solvers.problems import (
    BOUNDARIES,
    Boundary,
    Prescribed,
    Shape,
    Solved,
    make,
    paraboloid,
    rough,
    skin,
    solve,
)

TENSIONS = [0.0, 0.02, 1.0]
TIGHT = 1e-10


class Graded(Isotropic):
    """A modulus that grows with the depth: k = q^½."""

    type: Literal["graded"] = "graded"

    def compliance(self, q: Array) -> Array:
        return q**-0.5


def plate(bending: float, s: float = 0.02) -> BendingSkin:
    """Return a half-space with a skin that is tensed and stiff in bending."""
    return BendingSkin(reduced_modulus=1.0, tension=s / 2, bending=bending)


def layer(kind: str, thickness: float) -> Kernel:
    """Return an incompressible layer of modulus 1 on a rigid base."""
    return pl.kernel(kind, reduced_modulus=1.0, poissons_ratio=0.5, thickness=thickness)


def active_set(problem: Problem, tolerance: float = TIGHT, start: Array | None = None) -> Solved:
    """Return what `active_set` finds; it is within tolerance by the fresh residuals."""
    solved = solve(problem, ActiveSet(tolerance=tolerance), start)
    assert solved.stop is Stop.DONE
    assert solved.residual <= tolerance
    return solved


def assert_agrees(problem: Problem, tolerance: float = TIGHT, pressure: float = 1e-7) -> Solved:
    """Assert that both solvers find the same; ``pressure`` relative to the highest."""
    solved = active_set(problem, tolerance)
    reference = solve(problem, ConjugateGradient(tolerance=tolerance))
    assert reference.stop is Stop.DONE
    equilibrium, expected = solved.equilibrium, reference.equilibrium
    highest = float(expected.pressure.max())
    np.testing.assert_allclose(equilibrium.pressure, expected.pressure, atol=pressure * highest)
    assert equilibrium.depth == pytest.approx(expected.depth, rel=1e-8)
    assert equilibrium.force == pytest.approx(expected.force, rel=1e-8)
    return solved


def sphere(x: Array, y: Array) -> Array:
    """Return a sphere of radius 0.4; nothing is beyond its equator."""
    below = 0.4**2 - x**2 - y**2
    return np.where(below > 0, np.sqrt(np.maximum(below, 0)) - 0.4, -np.inf)


def punch(x: Array, y: Array) -> Array:
    """Return a flat punch of radius 0.3."""
    return np.where(np.hypot(x, y) < 0.3, 0.0, -np.inf)


def flat(x: Array, y: Array) -> Array:
    """Return a plane that ends where the domain does."""
    return 0.0 * x * y


# --- Small and large contacts ----------------------------------------------------------------


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("points", [33, 97])
def test_depth_that_does_not_touch(boundary: Boundary, points: int) -> None:
    """Just above the lowest cell there is nothing to solve; just below it one cell presses."""
    # The centre is no cell's on an even grid, so that the lowest cell is above the lowest point.
    problem = make(points + 1, boundary, skin(0.02), paraboloid, "depth", 1.0)
    lowest = -float(problem.profile.max())
    assert not replace(problem, control=Depth(0.999 * lowest)).needs_solving
    assert not replace(problem, control=Depth(lowest)).needs_solving
    just = replace(problem, control=Depth(1.001 * lowest))
    assert just.needs_solving
    equilibrium = active_set(just).equilibrium
    assert np.count_nonzero(equilibrium.contact) == 4


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("s", TENSIONS)
@pytest.mark.parametrize("points", [33, 95])
def test_one_cell(boundary: Boundary, s: float, points: int) -> None:
    """A tiny depth or force presses one cell, which yields as the operator says."""
    problem = make(points, boundary, skin(s), paraboloid, "depth", 1e-9)
    middle = (points // 2, points // 2)
    alone = np.zeros(problem.grid.shape)
    alone[middle] = 1.0
    expected = problem.value / problem.operator(alone)[middle]
    equilibrium = active_set(problem).equilibrium
    assert np.count_nonzero(equilibrium.contact) == 1
    assert equilibrium.pressure[middle] == pytest.approx(expected, rel=1e-12)

    force = expected * problem.grid.cell_area
    back = active_set(replace(problem, control=Force(force))).equilibrium
    assert np.count_nonzero(back.contact) == 1
    assert back.depth == pytest.approx(problem.value, rel=1e-10)


@pytest.mark.parametrize("s", [0.0, 0.02])
@pytest.mark.parametrize("force", [1.0, 1e2, 1e6])
def test_full_contact_of_a_free_rough_punch(s: float, force: float) -> None:
    """A rough punch that ends with the domain is in full contact under a very large force."""
    solved = assert_agrees(make(64, "free", skin(s), rough(0.2), "force", force))
    assert solved.equilibrium.contact.all()
    assert solved.applications <= 18  # 11 … 15


@pytest.mark.parametrize(("s", "prescribed"), [(0.0, "force"), (0.02, "depth")])
@pytest.mark.parametrize("points", [(24, 24), (70, 41)])
def test_flat_punch_on_the_whole_domain(
    s: float, prescribed: Prescribed, points: tuple[int, int]
) -> None:
    """Contact may reach the border where the indenter ends there."""
    problem = make(points, "free", skin(s), flat, prescribed, 0.1, size=(1.0, 0.7))
    assert assert_agrees(problem).equilibrium.contact[0].any()


@pytest.mark.parametrize("s", TENSIONS)
@pytest.mark.parametrize("share", [0.5, 0.9, 0.99, 0.999, 0.9999])
def test_depth_near_the_mean_plane(s: float, share: float) -> None:
    """Depths up to 99.99 % of what no load reaches on a periodic boundary."""
    problem = make(64, "periodic", skin(s), rough(0.1), "depth", 1.0)
    problem = replace(problem, control=Depth(-share * float(problem.profile.mean())))
    assert assert_agrees(problem).applications <= 52  # 19 … 42


def test_contact_everywhere_at_first() -> None:
    """A periodic start that covers all cells, which no depth allows, does not stay or empty it."""
    heights = np.array([[-0.85, -0.84, -0.85], [-0.24, 0.0, -0.24]])
    heights = np.concatenate([heights, heights[::-1]])
    for s in (0.0, 0.2, 2.0, 2e3):
        problem = make((4, 3), "periodic", skin(s), lambda x, y: heights, "depth", 0.48, (4.0, 1.5))
        start = np.ones(problem.grid.shape)
        expected = assert_agrees(problem).pressure
        pressure = active_set(problem, start=start).pressure
        np.testing.assert_allclose(pressure, expected, atol=1e-8 * expected.max())


# --- Shapes of the contact -------------------------------------------------------------------


def peaks(lower: float) -> Shape:
    """Return two peaks, of which one is lower than the other."""

    def shape(x: Array, y: Array) -> Array:
        one, other = ((x - at) ** 2 + (y - at) ** 2 for at in (0.3, -0.3))
        return np.asarray(np.maximum(-5 * one, -5 * other - lower))

    return shape


def pillars(x: Array, y: Array) -> Array:
    """Return pillars of one cell, which the next coarser grid does not see."""
    every = np.logical_and.outer(np.arange(x.size) % 4 == 0, np.arange(y.size) % 4 == 0)
    return np.where(every, paraboloid(x, y), -np.inf)


ISLANDS: dict[str, tuple[Shape, Prescribed, float]] = {
    "two alike": (peaks(0.0), "force", 1e-4),
    "two unlike": (peaks(1e-4), "force", 1e-4),
    "pillars at a depth": (pillars, "depth", 0.1),
    "pillars under a force": (pillars, "force", 0.1),
    "egg box": (
        lambda x, y: 0.01 * (np.cos(8 * np.pi * x) * np.cos(8 * np.pi * y) - 1),
        "depth",
        0.004,
    ),
    "stairs": (lambda x, y: np.floor(300 * paraboloid(x, y)) / 300, "force", 2e-3),
    "checkers": (
        lambda x, y: -1e-3 * (np.add.outer(np.arange(x.size), np.arange(y.size)) % 2),
        "force",
        0.01,
    ),
}


@pytest.mark.parametrize(
    ("boundary", "s", "points"),
    [("free", 0.0, 40), ("free", 0.1, 96), ("periodic", 0.0, 96), ("periodic", 0.1, 40)],
)
@pytest.mark.parametrize(("shape", "prescribed", "value"), ISLANDS.values(), ids=ISLANDS.keys())
def test_islands(
    boundary: Boundary, s: float, points: int, shape: Shape, prescribed: Prescribed, value: float
) -> None:
    """Contacts in several pieces, with sharp steps and of single cells."""
    assert_agrees(make(points, boundary, skin(s), shape, prescribed, value))


@pytest.mark.parametrize(("s", "points"), [(0.0, 40), (0.02, 97), (1.0, 40)])
@pytest.mark.parametrize("shape", [sphere, punch])
def test_indenter_that_ends(s: float, points: int, shape: Shape) -> None:
    """Cells where there is no indenter never press, on coarse grids that half cover it either."""
    for boundary in BOUNDARIES:
        for force in (0.1, 3.0):
            solved = assert_agrees(make(points, boundary, skin(s), shape, "force", force))
            assert not solved.pressure[~np.isfinite(solved.equilibrium.gap)].any()


# --- Grids -----------------------------------------------------------------------------------

GRIDS: dict[str, tuple[tuple[int, int], tuple[float, float]]] = {
    "rectangular domain": ((96, 48), (1.0, 0.5)),
    "rectangular cells": ((64, 64), (1.0, 0.4)),
    "long cells": ((64, 20), (1.0, 3.0)),
    "odd": ((75, 51), (1.0, 0.7)),
    "primes": ((97, 61), (1.0, 0.7)),
    "other primes": ((61, 101), (1.0, 1.0)),
    "no power of two": ((100, 120), (1.0, 1.0)),
    "thin": ((256, 4), (1.0, 1 / 64)),
    "thin along y": ((4, 256), (1 / 64, 1.0)),
    "one cell wide": ((200, 1), (1.0, 0.02)),
    "one cell wide along y": ((1, 200), (0.02, 1.0)),
    "few cells": ((2, 3), (0.5, 0.5)),
}


@pytest.mark.parametrize(("boundary", "s"), [("free", 1.0), ("periodic", 0.0)])
@pytest.mark.parametrize(("points", "size"), GRIDS.values(), ids=GRIDS.keys())
def test_grids(
    boundary: Boundary, s: float, points: tuple[int, int], size: tuple[float, float]
) -> None:
    """Any number and shape of cells, at a depth and at a force."""
    controls: list[tuple[Prescribed, float]] = [
        ("depth", 0.05),
        ("force", 2e-3 * size[0] * size[1]),
    ]
    for prescribed, value in controls:
        problem = make(points, boundary, skin(s), paraboloid, prescribed, value, size)
        if not problem.needs_solving or value >= -float(problem.profile.mean()):
            value = -float(problem.profile.max() + problem.profile.mean()) / 2
            problem = replace(problem, control=replace(problem.control, value=value))
        assert_agrees(problem)


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("s", [0.02, 1.0])
def test_thin_grids_are_coarsened_too(boundary: Boundary, s: float) -> None:
    """A thin grid takes no more than a square one: its long edge alone is enough to coarsen."""
    for points in ((1024, 4), (1, 1024)):
        size = (max(points[0] / 1024, 0.01), max(points[1] / 1024, 0.01))
        problem = make(points, boundary, skin(s), paraboloid, "force", 1e-5, size)
        assert active_set(problem).applications <= 23  # 5 … 19; cold on the finest grid 82 … 213


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("points", [(97, 61), (128, 50)])
def test_rough_on_any_grid(boundary: Boundary, points: tuple[int, int]) -> None:
    """A rough surface on grids whose sizes share no factor."""
    for s in TENSIONS:
        problem = make(points, boundary, skin(s), rough(0.1), "force", 0.03, (1.0, 0.7))
        assert assert_agrees(problem).applications <= 37  # 20 … 30


# --- Kernels ---------------------------------------------------------------------------------


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("ratio", [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6])
def test_extreme_tensions(boundary: Boundary, ratio: float) -> None:
    """Elastocapillary lengths of a millionth to a million cells."""
    s = ratio / 64
    depth = make(64, boundary, skin(s), rough(0.1), "depth", 0.015)
    force = make(64, boundary, skin(s), rough(0.1), "force", 1e-2 * (1 + s))
    for problem in (depth, force):
        assert assert_agrees(problem).applications <= 31  # 18 … 25
    assert_agrees(make(48, boundary, skin(ratio / 48), paraboloid, "force", 1e-3 * (1 + s)))


KERNELS: dict[str, tuple[Kernel, int]] = {
    "graded": (Graded(), 25),  # measured 14 … 17
    "winkler": (pl.kernel("winkler", foundation=1.0), 25),  # 12 … 15
    "thick layer": (layer("frictionless_layer", 0.1), 30),  # 17 … 20
    "thin layer": (layer("frictionless_layer", 0.01), 25),  # 13 … 17
    "plate": (plate(1e-5), 28),  # 19 … 23
}


@pytest.mark.parametrize(("kernel", "most"), KERNELS.values(), ids=KERNELS.keys())
@pytest.mark.parametrize("points", [64, pytest.param(128, marks=pytest.mark.slow)])
def test_other_kernels(kernel: Kernel, most: int, points: int) -> None:
    """Kernels of other orders, given by their compliance alone."""
    controls: list[tuple[Prescribed, float]] = [("force", 1e-2), ("depth", 0.015)]
    for prescribed, value in controls:
        problem = make(points, "periodic", kernel, rough(16 / points), prescribed, value)
        # The compliance of the plate falls as q⁻⁴, so that its pressures are known least.
        assert assert_agrees(problem, pressure=1e-6).applications <= most


@pytest.mark.parametrize("points", [64, 128, 256])
def test_applications_on_a_stiff_plate(points: int) -> None:
    """A plate so stiff that the reference stalls on it costs the same on each finer grid."""
    stiff = plate(1e-3)
    controls: list[tuple[Prescribed, float]] = [("force", 1e-2), ("depth", 0.015)]
    for prescribed, value in controls:
        on_rough = make(points, "periodic", stiff, rough(16 / points), prescribed, value)
        on_paraboloid = make(points, "free", stiff, paraboloid, prescribed, value)
        assert active_set(on_rough).applications <= 4  # 3
        assert active_set(on_paraboloid).applications <= 5  # 3 … 4


@pytest.mark.parametrize("shape", [(96, 32), (32, 96)])
@pytest.mark.parametrize("bending", [1e-5, 1e-3])
def test_plates_on_cells_of_one_to_three(shape: tuple[int, int], bending: float) -> None:
    """Cells that are not square cost no more."""
    for boundary in BOUNDARIES:
        problem = make(shape, boundary, plate(bending), rough(0.25), "force", 1e-2)
        assert active_set(problem).applications <= 32  # 3 … 27


def waves(number: int, power: float) -> Shape:
    """Return the profile of so many waves along x, whose amplitudes fall as this power."""
    phases = np.random.default_rng(2).uniform(0, 2 * np.pi, number)

    def profile(x: Array, y: Array) -> Array:
        terms = (np.cos(2 * np.pi * k * x + phase) / k**power for k, phase in enumerate(phases, 1))
        return np.asarray(0.01 * sum(terms) + 0 * y)

    return profile


ROUGH_LINE, CRESTS = waves(60, 1.3), waves(6, 2)
LINES: list[tuple[Kernel, Shape, float, int]] = [
    # 15 … 23, and 56 … 106 where E leaves off the contact at rest.
    *((skin(s), ROUGH_LINE, f, 30) for s, f in ((0.0, 1e-2), (0.02, 1.6e-2), (0.2, 7e-2))),
    # Touched at the crests and all over: 3 … 5.
    *((plate(b), CRESTS, f, 6) for b, f in ((1e-5, 1e-3), (1e-3, 1e-3), (1e-3, 3.0))),
]


@pytest.mark.parametrize(("kernel", "line", "force", "most"), LINES)
def test_line_contact(kernel: Kernel, line: Shape, force: float, most: int) -> None:
    """On a line of cells as on a plane, for a plate whatever its size across."""
    grids = [(n, 1 / n) for n in (256, 1024, 4096)]
    for points, across in grids if line is ROUGH_LINE else [(256, y) for y in (1e-6, 1.0, 1e3)]:
        size = (1.0, across)
        problem = make((points, 1), "periodic", kernel, line, "force", force * across, size)
        assert active_set(problem).applications <= most


@pytest.mark.parametrize("seed", [13, 30, 56])
def test_a_single_cell_in_contact_sees_what_penetrates_elsewhere(seed: int) -> None:
    """A plate that rests on its highest point first is taken to rest on another."""
    problem = make(16, "periodic", plate(1.0, s=0.0), rough(1 / 6, seed), "force", 1e-2)
    contact = assert_agrees(problem).equilibrium.contact
    assert contact.sum() == 1
    assert problem.profile[contact] == problem.profile.max()


def test_a_contact_that_all_cells_have_left_is_joined_by_what_penetrates() -> None:
    """Without any contact the surface is flat, and the indenter overlaps with it."""
    problem = make(16, "free", skin(0.02), paraboloid, "depth", 0.05)
    nowhere = Preconditioner(problem.operator).on(np.zeros(problem.grid.shape, dtype=bool))
    pressure, displacement = np.zeros((2, *problem.grid.shape))
    inner = inner_solve(problem, nowhere, pressure, displacement, 1e-10, certainty=1.0)
    assert inner.error == 0
    np.testing.assert_array_equal(
        inner.misclassified, np.flatnonzero(problem.profile + 0.05 > 1e-10)
    )


# --- The end ---------------------------------------------------------------------------------


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("prescribed", ["depth", "force"])
def test_tolerance_near_round_off(boundary: Boundary, prescribed: Prescribed) -> None:
    """With 1e-12 and less the solver ends within tolerance, or says that it is stuck, near it."""
    value = {"depth": 0.02, "force": 0.02}[prescribed]
    for s in TENSIONS:
        for tolerance in (1e-12, 1e-13):
            problem = make(96, boundary, skin(s), rough(0.1), prescribed, value)
            solved = solve(problem, ActiveSet(tolerance=tolerance))
            assert solved.stop is Stop.DONE or solved.residual > tolerance
            assert solved.stop in (Stop.DONE, Stop.STALLED)
            assert solved.residual <= 1e-11
            assert solved.applications <= 3000


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize(("s", "shape"), [(0.0, rough(0.1)), (0.02, paraboloid), (1.0, rough(0.1))])
def test_force_and_depth_agree(boundary: Boundary, s: float, shape: Shape) -> None:
    """The force found at a depth has that depth, and the same pressure."""
    problem = make(97, boundary, skin(s), shape, "depth", 0.012)
    first = active_set(problem).equilibrium
    second = active_set(replace(problem, control=Force(first.force))).equilibrium
    assert second.depth == pytest.approx(problem.value, rel=1e-8)
    highest = first.pressure.max()
    np.testing.assert_allclose(second.pressure, first.pressure, atol=1e-7 * highest)


# --- Operator applications -------------------------------------------------------------------


STEPS: list[Any] = [
    pytest.param(boundary, s, shape, depth, id=f"{boundary}-{s}-{name}")
    for boundary in BOUNDARIES
    for s in TENSIONS
    for name, shape, depth in (("paraboloid", paraboloid, 0.02), ("rough", rough(0.08), 0.015))
]


@pytest.mark.parametrize(("boundary", "s", "shape", "depth"), STEPS)
def test_the_next_step_of_a_curve_costs_no_more_than_a_cold_one(
    boundary: Boundary, s: float, shape: Shape, depth: float
) -> None:
    """A start that is 5 % off is found to be far, which takes one application, and left."""
    problem = make(256, boundary, skin(s), shape, "depth", depth)
    later = replace(problem, control=Depth(1.05 * depth))
    before = active_set(problem, 1e-6).pressure
    warm, cold = active_set(later, 1e-6, start=before), active_set(later, 1e-6)
    np.testing.assert_allclose(warm.pressure, cold.pressure, atol=1e-3 * cold.pressure.max())
    assert warm.applications <= cold.applications + 1


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_a_start_at_the_solution_is_used(boundary: Boundary) -> None:
    """Started from its own solution, a step needs one application to see that it is one."""
    problem = make(128, boundary, skin(0.02), rough(0.1), "depth", 0.015)
    solved = active_set(problem, 1e-6).pressure
    assert active_set(problem, 1e-6, start=solved).applications == 1


@pytest.mark.parametrize("points", [(7, 6), (64, 48)])
@pytest.mark.parametrize("prescribed", ["depth", "force"])
def test_the_order_of_arrays_in_memory_changes_nothing(
    prescribed: Prescribed, points: tuple[int, int]
) -> None:
    """Profiles and starts in Fortran order, such as of a scan read by lines, are solved too."""
    value = {"depth": 0.01, "force": 1e-4}[prescribed]
    problem = make(points, "free", skin(0.02), rough(0.4), prescribed, value)
    expected = active_set(problem).equilibrium
    other = replace(problem, profile=np.asfortranarray(problem.profile))
    for start in (None, np.asfortranarray(0.999 * expected.pressure)):
        equilibrium = active_set(other, start=start).equilibrium
        np.testing.assert_allclose(equilibrium.pressure, expected.pressure, atol=1e-6)
        assert equilibrium.force == pytest.approx(expected.force, rel=1e-8)


@pytest.mark.parametrize("s", [0.0, 0.001, 0.1, 10.0])
@pytest.mark.parametrize(("prescribed", "value"), [("depth", 0.02), ("force", 1e-3)])
def test_applications_of_a_paraboloid(s: float, prescribed: Prescribed, value: float) -> None:
    """On a free boundary to 1e-8 they grow neither with the grid nor with the tension."""
    for points in (64, 128, 256):
        problem = make(points, "free", skin(s), paraboloid, prescribed, value)
        assert active_set(problem, 1e-8).applications <= 23  # 6 … 19; the bar is 45


@pytest.mark.parametrize("s", TENSIONS)
def test_applications_of_a_rough_surface_hardly_grow(s: float) -> None:
    """Periodic, 1e-6, p̄ = 0.1 E* × rms slope; conjugate gradients need N^0.5 to N."""
    counts = {}
    for points in (128, 256, 512):
        problem = make(points, "periodic", skin(s), rough(16 / points), "force", 1.0)
        slopes = np.hypot(*np.gradient(problem.profile, *problem.grid.spacing))
        mean = 0.1 * float(np.sqrt(np.mean(slopes**2)))
        solved = active_set(replace(problem, control=Force(mean)), 1e-6)
        counts[points] = solved.applications
    assert max(counts.values()) <= 35  # 15 16 17, 18 21 22, 15 15 18; the bar is 60
    # Measured slopes: 0.09 at s = 0; 0.145 at 0.02 L and 0.13 at L miss the goal of 0.1.
    assert np.polyfit(np.log([*counts]), np.log([*counts.values()]), 1)[0] <= 0.2


def test_a_layer_too_thin_for_the_coarser_grid_is_solved_without_it() -> None:
    """An incompressible layer is rigid under cells much wider than its thickness."""
    kernel = layer("bonded_layer", 0.15 / 96)
    with pytest.raises(ConfigError, match="use more points"):
        operator_of(kernel, Grid(points=48, size=1.0))
    problem = make(96, "free", kernel, paraboloid, "depth", 0.02)
    assert active_set(problem, 1e-6).equilibrium.contact.sum() > 500
