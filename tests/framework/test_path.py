"""Interactions from a run file to a result, and the summary of a path with adhesion."""

from dataclasses import asdict
from math import isnan, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.analysis import PathSummary, legs, path_summary
from pellicle.variables import names_of
from pellicle_axisymmetric import adhesive_curve
from tests.command import call
from tests.framework.bad_input.conftest import says
from tests.tables_of_runs import half_space, paraboloid, pressing

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


def sticky(points: int, size: str, depth: Any, strength: str) -> dict[str, Any]:
    """Return the run of a paraboloid that sticks by a linear law, or by that of JKR without one."""
    law = {"type": "linear", "strength": strength} if strength else {"type": "jkr"}
    return pressing(points, size, half_space("700 kPa"), paraboloid("1 mm"), depth=depth) | {
        "interaction": {**law, "work_of_adhesion": "50 mJ/m^2"},
        "solver": {"type": "active_set", "tolerance": 1e-6},
        "outputs": [],
    }


PULLED = sticky(64, "0.6 mm", ["5 um", "0 um", "-2 um"], "30 kPa")
STICKY = sticky(32, "0.6 mm", ["5 um", "0 um"], "")
PERIODIC = {"points": 32, "size": "0.6 mm", "boundary": "periodic"}
ADDED = {"wall_pressure", "zone_area", "zone_width", "energy", "residual_traction"}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Return a run file with an interaction."""
    path = tmp_path / "run.toml"
    path.write_text(pl.Run(**PULLED).to_toml(), encoding="utf-8")
    return path


@pytest.mark.parametrize("kept", [1, 2])
def test_resumes_where_it_was_killed(file: Path, kept: int) -> None:
    """A run that goes on from its file has the numbers of one that was never interrupted."""
    whole = pl.run(file, progress=False)
    assert whole.converged
    part = pl.Result(whole.dataset.isel(step=slice(0, kept)))
    part.save(file.with_suffix(".h5"))
    before = file.with_suffix(".h5").stat().st_mtime_ns
    resumed = pl.run(file, directory=file.parent, progress=False)
    assert file.with_suffix(".h5").stat().st_mtime_ns > before
    for name in set(whole.dataset.data_vars) - {"wall_time"}:
        one, other = (result.dataset[name].values for result in (whole, resumed))
        if one.dtype.kind == "f":
            scale = float(np.nanmax(np.abs(one)))
            np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-12 * scale, err_msg=name)
        else:
            np.testing.assert_array_equal(other, one)
    loaded = pl.load(file.with_suffix(".h5"))
    assert loaded.dataset["wall_pressure"].values[-1].max() > 0
    np.testing.assert_array_equal(loaded.dataset["contact"], loaded.dataset["wall_pressure"] > 0)


def test_adds_variables(file: Path) -> None:
    """A result with an interaction has its variables, in the file and the table; others not."""
    run = pl.Run.from_toml(file)
    table = pl.Run.from_mapping(PULLED | {"outputs": [{"type": "csv"}]})
    with_law = pl.run(table, directory=file.parent, progress=False)
    assert set(with_law.dataset.data_vars) >= ADDED
    header = next(file.parent.glob("*.csv")).read_text(encoding="utf-8").partition("\n")[0]
    assert {"zone_area [m2]", "zone_width [m]", "energy [J]"} <= {*header.split(",")}
    shown = call("show", file.with_suffix(".h5")).output
    assert "area of the zone [" in shown
    hard = pl.run(
        run.model_copy(update={"interaction": None, "loading": pl.Loading(depth="5 um")}),
        progress=False,
    )
    assert not ADDED & set(hard.dataset.data_vars)
    assert hard.dataset["force"][0] > with_law.dataset["force"][0]


@pytest.mark.parametrize("quiet", [[], ["--quiet"]])
@pytest.mark.filterwarnings("default:.*beyond the theory")
def test_study_with_steep_slopes(tmp_path: Path, quiet: list[str]) -> None:
    """The command says once of how many runs, as `show` does, and counts them as converged."""
    file, out = tmp_path / "steep.toml", str(tmp_path / "out")
    steep = pl.Run(**sticky(64, "80 um", "3 um", "100 kPa")).to_toml()
    vary = '[study.vary]\n"indenter.radius" = ["20 um", "100 um"]\n'
    file.write_text(f"{steep}\n{vary}", encoding="utf-8")
    for command in (["run", str(file), "-o", out, *quiet], ["show", out]):
        done = call(*command)
        assert done.output.count("of 2 runs, in 1 slopes in contact are beyond the theory") == 1


@pytest.mark.parametrize("prescribed", ["depth", "force", "mean_pressure", "base_displacement"])
def test_pulling_takes_an_interaction(prescribed: str) -> None:
    """A load below 0 is refused without an interaction, which is named, and allowed with one."""
    loading: dict[str, Any] = {prescribed: [1e-6, -1e-6]}
    if prescribed == "base_displacement":
        loading["spring_constant"] = "1 N/m"
    grid = PERIODIC if prescribed == "mean_pressure" else STICKY["grid"]
    configuration = STICKY | {"grid": grid, "loading": loading}
    assert pl.Run(**configuration).indentation.loading.values == (1e-6, -1e-6)
    del configuration["interaction"]
    for table in (loading, pl.Loading(**loading)):
        with pytest.raises(pl.ConfigError) as caught:
            pl.Run(**configuration | {"loading": table})
        message = str(caught.value)
        says(message, f"loading.{prescribed}.1: -1e-06 is not allowed; give a value ≥ 0")
        says(message, "with an [interaction] it may be negative")


def test_pull_that_no_contact_carries() -> None:
    """The step says how much the contact carries, the next that there is none; both press again."""
    with pytest.warns(pl.ConvergenceWarning):
        result = pl.run(
            STICKY | {"loading": {"force": ["-10 uN", "10 uN", "-500 uN", "-10 uN", "10 uN"]}},
            progress=False,
        )
    data = result.dataset
    codes = ["NOTHING_TO_PULL", "PULLED_OFF", "NOTHING_TO_PULL"]
    assert [*data["status_code"].values[[0, 2, 3]]] == codes
    assert data["converged"].values[[1, 4]].all()
    says(str(data["status"].values[0]), "no contact", "-10 µN; press before you pull")
    says(str(data["status"].values[2]), "no contact carries a force of -500 µN", "softer holder")
    assert not data["contact"].values[[0, 2, 3]].any()
    np.testing.assert_allclose(data["depth"][4], data["depth"][1], rtol=1e-3)


@pytest.mark.parametrize("strength", ["200 kPa", "2 MPa"])
def test_grid_that_is_too_coarse(strength: str) -> None:
    """A zone narrower than its law takes is told, also where no cell is in it, and what helps."""
    law = {"type": "linear", "work_of_adhesion": "50 mJ/m^2", "strength": strength}
    with pytest.warns(pl.ConvergenceWarning, match="cells wide, where it takes 1.25"):
        result = pl.run(STICKY | {"interaction": law, "loading": {"depth": "5 um"}}, progress=False)
    assert result.dataset["status_code"].item() == "COARSE_ZONE"
    assert float(result.dataset["zone_width"].item()) < 1.25 * 0.6e-3 / 32
    says(str(result.dataset["status"].item()), "use more points")


@pytest.mark.parametrize("work", [1e-30, 1e-12, 1e6, 1e30])
@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
def test_works_of_all_sizes(work: float) -> None:
    """A work of adhesion far from any that exists ends in finite numbers and a status in words."""
    result = pl.run(
        STICKY | {"interaction": {"type": "jkr", "work_of_adhesion": work}}, progress=False
    )
    data = result.dataset
    assert np.isfinite(data["force"].values).all()
    if work < 1:
        # Hertz, 4/3 E* √R δ^(3/2), from which adhesion takes nothing.
        assert float(data["force"][0]) == pytest.approx(
            4 / 3 * 7e5 * 1e-3**0.5 * 5e-6**1.5, rel=0.1
        )
    else:
        assert not result.converged or result.coarse() or result.steep()


def test_steep_slopes() -> None:
    """A slope beyond those of the theory is told; the step counts as converged."""
    run = sticky(96, "0.25 mm", "20 um", "60 kPa") | {"indenter": paraboloid("0.2 mm")}
    with pytest.warns(pl.ConvergenceWarning, match=r"slopes in contact reach 0\.[3-9]"):
        result = pl.run(run, progress=False)
    assert result.converged
    assert result.dataset["status_code"].item() == "STEEP"
