"""Parts of the solver with attraction: fronts, rounds that are taken back or extrapolated."""

from math import pi
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.special import i0, k0

from pellicle import Grid
from pellicle.arrays import Array
from pellicle_plugins.solvers import adhesion, front
from pellicle_plugins.solvers.anderson import RoundRecord, extrapolate_rounds, is_convex
from pellicle_plugins.solvers.front import STIFFNESS, potential, shifted_contact
from tests.adhesive_paths import JKR, half_space, solved, wavy

WORK, LONGEST, FORCE = 0.05, 0.05, 2.0


def grid_of(points: int) -> Grid:
    """Return a periodic square of edge 1."""
    return Grid(points=points, size=1.0, boundary="periodic")


def straight(points: int, waves: int) -> float:
    """Return how far a straight front moves where it is pushed most, over the closed form."""
    y = (np.arange(points) + 0.5) / points
    push = np.zeros((points, points))
    push[points // 2] = FORCE * np.cos(2 * np.pi * waves * y) * points
    moved = potential(push, WORK, LONGEST, grid_of(points))[points // 2]
    stiffness = STIFFNESS * WORK * np.hypot(2 * np.pi * waves, 1 / LONGEST)
    return float(moved.max() / (FORCE / stiffness))


def ring(points: int, radius: float, longest: float = LONGEST) -> float:
    """Return how far a circular front moves as a whole, over the closed form."""
    x, y = (axis - 0.5 for axis in np.meshgrid(*2 * [(np.arange(points) + 0.5) / points]))
    distance = np.hypot(x, y)
    # A hat of the width of two cells.
    push = FORCE * points * np.maximum(1 - np.abs(distance - radius) * points, 0.0)
    moved = potential(push, WORK, longest, grid_of(points))
    on_front = np.abs(distance - radius) < 0.5 / points
    ratio = radius / longest
    expected = 2 * FORCE * radius * i0(ratio) * k0(ratio) / (STIFFNESS * WORK)
    return float(moved[on_front].mean() / expected)


@pytest.mark.parametrize(("of", "argument"), [(straight, 0), (straight, 3), (ring, 0.25)])
def test_a_pushed_front_moves_by_its_stiffness(of: Any, argument: float) -> None:
    """By f/cw√(κ² + 1/ℓ²), and as a circle by 2f a I₀K₀(a/ℓ)/cw: to first order in the cell."""
    errors = [abs(of(points, argument) - 1) for points in (64, 128, 256)]
    assert errors[-1] < 0.04
    assert errors[0] > 3 * errors[-1]


def test_a_disc_resists_as_an_unloaded_one_after_johnson() -> None:
    """With 5w/a for each length of its edge, at a fixed depth."""
    radius = 0.25
    longest = front.LONGEST * radius / 2
    ratio = radius / longest
    stiffness = front.STIFFNESS * WORK / (2 * radius * i0(ratio) * k0(ratio))
    assert ring(256, radius, longest) == pytest.approx(1, abs=0.05)
    assert stiffness == pytest.approx(5 * WORK / radius, rel=0.01)


@pytest.mark.parametrize("shift", [-0.06, 0.03, 0.11])
def test_a_shifted_disc_is_a_disc(shift: float) -> None:
    """Its radius is less by the shift, to the size of a cell."""
    grid = grid_of(128)
    x, y = (axis - 0.5 for axis in grid.coordinates())
    x, y = x - x.mean(), y - y.mean()
    distance, cell = np.hypot(x, y), 1 / 128
    moved = shifted_contact(distance < 0.25, np.full((128, 128), shift), grid)
    assert moved[distance < 0.25 - shift - cell].all()
    assert not moved[distance > 0.25 - shift + cell].any()


def rounds(count: int, cells: int) -> tuple[list[RoundRecord], Array]:
    """Return rounds of a linear map to tractions, and the traction that misses nothing."""
    random = np.random.default_rng(4)
    root = random.standard_normal((cells, cells))
    stiffness, solution = root @ root.T / cells + np.eye(cells), random.standard_normal(cells)
    traction, found = np.zeros(cells), []
    for _ in range(count):
        missed = stiffness @ (solution - traction)
        found.append(RoundRecord(traction, missed, 3 * traction))
        traction = traction + 0.2 * missed
    return found, solution


def test_linear_rounds_are_extrapolated_to_their_end() -> None:
    """As many rounds as cells, and one, tell all of a linear map, of the wall pressure too."""
    found, solution = rounds(5, 4)
    nothing = np.zeros(4, dtype=bool)
    best = extrapolate_rounds(found, nothing)
    assert best.traction == pytest.approx(solution, rel=1e-8)
    assert best.wall == pytest.approx(3 * solution, rel=1e-8)
    assert np.abs(best.missed).max() < 1e-8
    assert is_convex(found[0], found[1], nothing)
    short = extrapolate_rounds(found[:3], nothing)
    assert np.linalg.norm(short.missed) < np.linalg.norm(found[2].missed)


def test_an_extrapolation_to_a_saddle_is_dropped() -> None:
    """Where tractions are missed the more the further they follow, the last round stands."""
    one, unstable = np.ones(3), np.zeros(3, dtype=bool)
    first = RoundRecord(0 * one, 1 * one, one)
    second = RoundRecord(0.5 * one, 3 * one, one)
    assert extrapolate_rounds([first, second], unstable) is second
    assert not is_convex(first, second, unstable)


WITHOUT_ESTIMATE: dict[str, Any] = {**JKR, "estimate_error": False}


def approach() -> xr.Dataset:
    """Return a path of two depths, whose second step has no extrapolation to start from."""
    return solved(24, 1.0, [0.1, 0.6], interaction=WITHOUT_ESTIMATE)


@pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")
def test_rounds_whose_energy_rises_are_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even if every shift is refused at first the path converges, to the same forces."""
    usual = approach()
    monkeypatch.setattr(adhesion, "_RISE", -1e9)
    refused = approach()
    assert refused["converged"].all()
    assert refused["force"].values == pytest.approx(usual["force"].values, rel=1e-6)
    more = refused["operator_applications"] > usual["operator_applications"]
    assert more.all()


@pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")
def test_energies_are_compared_beyond_the_rim_of_an_indenter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where there is no indenter, the gap is infinite."""
    punch = {"type": "flat_punch", "radius": 1.0}
    usual = solved(24, 1.0, [0.1], interaction=WITHOUT_ESTIMATE, indenter=punch)
    monkeypatch.setattr(adhesion, "_IDLE", 0)
    judged = solved(24, 1.0, [0.1], interaction=WITHOUT_ESTIMATE, indenter=punch)
    assert judged["converged"].all()
    assert judged["force"].values == pytest.approx(usual["force"].values, rel=1e-6)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")
@pytest.mark.parametrize("length", [0.0, 0.05, 0.3])
def test_lines_that_nearly_meet_converge(length: float) -> None:
    """Wide line contacts on a sine, whose fronts went to and fro by a cell without end."""
    pulls = [pi * 0.1 * share for share in (0.025, 0.15, 0.275, 0.4, 0.525, 0.4)]
    fractions = []
    for points in (512, 1024):
        path = wavy(
            points, pulls, 0.1, 1e-3, quantity="mean_pressure", kernel=half_space(length),
            interaction={"type": "jkr", "work_of_adhesion": 1e-3, "estimate_error": False},
        )  # fmt: skip
        assert path["converged"].all()
        fractions.append(path["contact_fraction"].values)
    assert (np.array(fractions) < 0.7).all()
    np.testing.assert_allclose(fractions[0], fractions[1], atol=0.01)
