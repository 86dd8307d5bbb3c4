"""The summary of a path with adhesion: its lowest force, loss and gain of contact, its work."""

from dataclasses import asdict
from math import isnan, pi
from typing import Any

import numpy as np
import pytest

from pellicle.analysis import PathSummary, legs, path_summary
from pellicle.variables import names_of
from pellicle_axisymmetric import adhesive_curve

# A paraboloid on a half-space; lengths in a₀, depths in a₀²/R, forces and energies to match.
E = R = W = 1.0
RADII = np.geomspace(0.3, 4, 40)
JKR = adhesive_curve(
    RADII**2 / R, 4 * E * RADII**3 / (3 * R), RADII, 2 * E * RADII, work_of_adhesion=W
)
LOWEST = -1.608772
HIGHEST = 0.5


def jkr_path(steps: int) -> dict[str, np.ndarray[Any, Any]]:
    """Return a path from out of contact to a depth and back, with its adhesive energy."""
    down = np.linspace(-2.0, HIGHEST, steps)
    depth = np.concatenate([down, down[-2::-1]])
    stable = np.argmin(JKR.depth)
    branch = JKR.depth[stable:]
    force, radius = (
        np.interp(depth, branch, column[stable:]) for column in (JKR.force, JKR.contact_radius)
    )
    # Contact begins where the gap closes and ends where the branch does.
    returns = np.arange(depth.size) >= steps
    contact = np.where(returns, depth > LOWEST, depth >= 0)
    # U = U(retraction at the same depth): −πa²w + ½∫p u, by F = dU/dδ from the lowest depth on.
    work = np.concatenate(
        [[0.0], np.cumsum(np.diff(branch) * (JKR.force[stable + 1 :] + JKR.force[stable:-1]) / 2)]
    )
    return {
        "depth": depth,
        "force": np.where(contact, force, 0.0),
        "contact_radius": np.where(contact, radius, 0.0),
        "energy": np.where(contact, np.interp(depth, branch, work), 0.0),
    }


def summary_of(**changes: Any) -> PathSummary:
    """Return the summary of a path of 101 steps each way."""
    return path_summary(**{**jkr_path(101), **changes})


def test_a_loop_has_the_events_of_johnson_kendall_and_roberts() -> None:
    """Pull-off, loss and gain of contact lie within a step of the theory."""
    step = (HIGHEST + 2) / 100
    summary = summary_of()
    assert summary.pull_off == pytest.approx(-1.5 * pi, rel=1e-3)
    assert summary.pull_off_radius == pytest.approx(1.5232369, rel=0.02)
    assert summary.detach_accuracy == pytest.approx(step)
    assert LOWEST < summary.detach < LOWEST + step
    # The slope of the force is infinite there.
    assert -pi < summary.detach_force < -0.8333 * pi
    assert summary.jump_in_accuracy == pytest.approx(step)
    assert 0 <= summary.jump_in < step
    assert summary.jump_in_force < -pi


def test_the_work_of_a_loop_is_the_area_between_its_branches() -> None:
    """It is the integral of the stable branch from its end to first touch, within its accuracy."""
    depth = np.linspace(LOWEST + 1e-6, 0.0, 100_001)
    stable = np.argmin(JKR.depth)
    force = np.interp(depth, JKR.depth[stable:], JKR.force[stable:])
    area = -float(np.trapezoid(force, depth))
    errors = []
    for steps in (26, 101, 401):
        summary = path_summary(**jkr_path(steps))
        assert abs(summary.work - area) <= 1.02 * summary.work_accuracy
        assert summary.dissipated_energy == pytest.approx(summary.work)
        errors.append(summary.work_accuracy)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.15)


def test_the_error_of_the_pull_off_is_that_of_its_step() -> None:
    """Steps are counted as they are in the path, those that failed included."""
    path = jkr_path(101)
    errors = np.random.default_rng(2).uniform(0.1, 0.2, path["force"].size)
    converged = np.ones(errors.size, bool)
    converged[[3, 110]] = False
    summary = summary_of(force_error=errors, converged=converged)
    lowest = int(np.argmin(path["force"]))
    assert lowest > 110
    assert summary.pull_off_step == lowest + 1
    assert summary.pull_off_accuracy == errors[lowest]


def test_energy_stored_at_the_end_is_not_lost() -> None:
    """Along a branch, between jumps, the work is the change of the energy."""
    path = jkr_path(101)
    part = slice(100, 170)
    summary = path_summary(**{name: column[part] for name, column in path.items()})
    assert abs(summary.work) > 1
    assert abs(summary.dissipated_energy) < 1e-3
    assert summary.work_accuracy == 0
    without = path_summary(**{n: c[part] for n, c in path.items() if n != "energy"})
    assert without.work == summary.work
    assert isnan(without.dissipated_energy)


def test_noise_moves_events_by_its_own_size() -> None:
    """Depth and force of the lowest step stay near those of the smooth path."""
    path = jkr_path(101)
    noise = 0.01 * np.random.default_rng(1).standard_normal(path["force"].size)
    summary = summary_of(force=path["force"] + noise * (path["contact_radius"] > 0))
    assert summary.pull_off == pytest.approx(-1.5 * pi, abs=0.03)
    assert summary.pull_off_depth == pytest.approx(summary_of().pull_off_depth, abs=0.2)
    assert summary.detach == summary_of().detach


def test_a_path_without_an_event_does_not_have_it() -> None:
    """No step, one step, never in contact, never out of it: NaN, and no work without motion."""
    assert all(map(isnan, asdict(path_summary([], [], [])).values()))
    single = asdict(path_summary([0.1], [-1.0], [1.0], [-2.0]))
    works = "work", "work_accuracy", "dissipated_energy"
    assert [single.pop(name) for name in works] == [0, 0, 0]
    assert all(map(isnan, single.values()))
    outside = path_summary([-2.0, -1.0, -2.0], [0.0] * 3, [0.0] * 3, [0.0] * 3)
    assert isnan(outside.pull_off)
    assert isnan(outside.detach)
    assert outside.work == 0
    inside = path_summary([1.0, 2.0, 1.0], [3.0, 5.0, 3.0], [1.0, 2.0, 1.0])
    assert isnan(inside.pull_off)
    assert isnan(inside.jump_in)
    assert isnan(inside.detach)


def test_a_path_that_begins_in_contact_jumps_in_when_it_comes_back() -> None:
    """Up, out of contact, and down again: loss before gain, each in its own interval."""
    depth = [1.0, 0.0, -1.0, -2.0, -1.0, 0.0, 1.0]
    summary = path_summary(
        depth, [2.0, -1.0, -0.5, 0.0, 0.0, -1.0, 2.0], [3.0, 2.0, 1.0, 0.0, 0.0, 2.0, 3.0]
    )
    assert (summary.detach, summary.detach_force, summary.detach_accuracy) == (-1, -0.5, 1)
    assert (summary.jump_in, summary.jump_in_force, summary.jump_in_accuracy) == (0, -1, 1)
    assert (summary.pull_off, summary.pull_off_depth, summary.pull_off_radius) == (-1, 0, 2)
    assert (summary.pull_off_step, summary.detach_step, summary.jump_in_step) == (2, 3, 6)


def test_the_turn_belongs_to_the_retraction() -> None:
    """Many small contacts pull hardest where they are pressed in furthest."""
    summary = path_summary([0.0, 1.0, 0.0, -1.0], [-1.0, -3.0, -2.0, 0.0], [1.0, 2.0, 1.0, 0.0])
    assert (summary.pull_off, summary.pull_off_step) == (-3, 2)


@pytest.mark.parametrize(
    ("depth", "force"),
    [
        ([-1.0, 0.0, 1.0, 2.0], [0.0, -3.0, -1.0, 2.0]),
        ([2.0, 1.0, 0.0], [2.0, -1.0, -2.0]),
        ([2.0, 1.0, 0.0, 1.0, 2.0], [2.0, -1.0, -2.0, -1.0, 2.0]),
        ([2.0, 1.0, 0.0, 0.0, 1.0], [2.0, -1.0, -2.0, -2.0, -1.0]),
        ([2.0, 1.0, 0.0, -1.0], [4.0, 3.0, 2.0, 3.0]),
    ],
    ids=["approach only", "ends there", "turns there", "holds there and turns", "pressed"],
)
def test_a_lowest_force_that_is_not_passed_is_not_the_pull_off(
    depth: list[float], force: list[float]
) -> None:
    """Beyond the lowest step of the path the contact might carry more."""
    assert isnan(path_summary(depth, force, np.ones(len(depth))).pull_off)


def test_steps_that_did_not_converge_are_left_out() -> None:
    """A wrong force is not the pull-off, and a work with a gap in it is not known."""
    path = jkr_path(101)
    wrong = int(np.argmin(path["force"]))
    converged = np.arange(path["force"].size) != wrong
    force = np.where(converged, path["force"], -100.0)
    summary = summary_of(force=force, converged=converged)
    assert summary.pull_off == pytest.approx(-1.5 * pi, rel=1e-3)
    assert isnan(summary.work)
    assert isnan(summary.dissipated_energy)
    last = int(np.flatnonzero(path["contact_radius"] > 0)[-1])
    converged = np.arange(path["force"].size) != last
    wide = summary_of(converged=converged)
    assert wide.detach_accuracy == pytest.approx(2 * summary.detach_accuracy)


def test_legs_share_their_turns() -> None:
    """A hold belongs to the leg before it; a path that never moves is one approach."""
    path = legs([0.0, 1.0, 1.0, 0.5, 0.0, 0.0, 2.0])
    assert [(leg.steps.start, leg.steps.stop, leg.direction) for leg in path] == [
        (0, 3, "approach"),
        (2, 6, "retraction"),
        (5, 7, "approach"),
    ]
    assert legs([]) == []
    assert [leg.direction for leg in legs([1.0])] == ["approach"]
    assert [leg.direction for leg in legs([1.0, 1.0, 0.0])] == ["retraction"]


def test_every_number_has_a_name_and_a_unit() -> None:
    """The variables of results are those of the summary, in its order."""
    assert tuple(asdict(PathSummary())) == names_of("path")
