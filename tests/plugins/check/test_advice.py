"""Checks: errors that a grid is to have, and cases of known solution that cannot be compared."""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

import pellicle as pl
from pellicle.components import HasAbelSlope
from pellicle.runs import runner, validation
from pellicle_axisymmetric.indentation import indent
from pellicle_check.advice import advise
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid
from tests.command import call
from tests.tables_of_runs import RUN, pressing, self_affine, tensed

MODULUS, DEPTH = 1e4, 2e-6
SHAPES: dict[str, tuple[dict[str, Any], HasAbelSlope]] = {
    "paraboloid": ({"type": "paraboloid", "radius": 1e-4}, Paraboloid(radius=1e-4)),
    "cone": ({"type": "cone", "half_angle": 1.4}, Cone(half_angle=1.4)),
}


def run(points: int = 64, shape: str = "paraboloid", tension: float = 0.05, **more: Any) -> pl.Run:
    """Return a run whose exact force is known."""
    skin, depths = tensed(MODULUS, tension), [DEPTH / 2, DEPTH]
    return pl.Run(**pressing(points, 4e-5, skin, SHAPES[shape][0], depth=depths) | more)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("tension", [1e-6, 0.05])
def test_errors_are_at_most_those_expected(shape: str, tension: float) -> None:
    """The true error of the force is below the expected one, which is not far above 5 %."""
    given = run(shape=shape, tension=tension)
    forces = pl.run(given, progress=False).dataset["force"].values
    for depth, force, step in zip(
        given.indentation.loading.values, forces, advise(given, 0.01).steps, strict=True
    ):
        exact = indent(SHAPES[shape][1], MODULUS, tension, depth=depth).force
        assert abs(force / exact - 1) <= step.force_error <= 0.1


def test_a_path_that_sticks_is_judged_by_its_largest_force() -> None:
    """Where the force crosses 0 its error counts over the pull-off; no huge grid is asked for."""
    path = run(
        points=48,
        grid={"points": 48, "size": 1.6e-4},
        kernel={"type": "tensed_membrane", "reduced_modulus": 1e3, "tension": 0.02},
        indenter={"type": "paraboloid", "radius": 2e-4},
        interaction={"type": "jkr", "work_of_adhesion": 5e-4, "estimate_error": False},
        loading={"depth": [4e-6, 3.2e-6, 0.0, -2e-6]},
    )
    steps = advise(path, 0.01).steps
    largest = max(abs(step.force) for step in steps)
    assert min(abs(step.force) for step in steps) < 0.1 * largest
    assert max(step.force_error for step in steps) < 0.15
    assert advise(path, 0.01).points[0] < 1000


def test_a_domain_without_contact_is_not_called_good() -> None:
    """Neither cells too wide to see the contact nor a strip are advised: both are refused."""
    ridge = {"type": "quadric", "radius_x": 1e-6, "radius_y": 1e-2}
    wide = run(indenter=ridge, loading={"depth": 1e-7}, grid={"points": [128, 8], "size": 1e-5})
    with pytest.raises(pl.ConfigError, match="on which the cells resolve it"):
        advise(wide, 0.01)
    strip = run(grid={"points": [256, 1], "size": 4e-5}, loading={"depth": 1e-7})
    with pytest.raises(pl.ConfigError, match=r'^grid\.boundary: 256 × 1 .* give "periodic"'):
        advise(strip, 0.01)


@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
def test_the_suggested_grid_meets_the_allowed_error() -> None:
    """On it every expected error of the force is about the allowed one, or below."""
    advice = advise(run(), 0.002)
    again = advise(run(points=advice.points[0]), 0.002)
    assert max(step.force_error for step in again.steps) <= 0.004


def test_a_domain_far_wider_than_the_contact_is_told() -> None:
    """The suggested one holds the contact with some margin; on a periodic one there is none."""
    wide = run(grid={"points": 128, "size": 3e-4})
    size = advise(wide, 0.01).size
    assert size is not None
    radius = indent(Paraboloid(radius=1e-4), MODULUS, 0.05, depth=DEPTH).contact_radius
    assert 2 * radius < size[0] < 4 * radius
    advice = advise(wide, 0.01)
    points, edge = advice.points[0], size[0]
    close = advise(run(grid={"points": points, "size": edge}), 0.01)
    assert max(step.error for step in close.steps) <= 0.02
    assert advise(run(), 0.01).size is None
    periodic = run(grid={"points": 64, "size": 3e-4, "boundary": "periodic"})
    assert advise(periodic, 0.01).size is None


@pytest.mark.slow
def test_a_contact_at_the_edge_is_told_with_a_domain_that_holds_it(tmp_path: Path) -> None:
    """`check` refuses what `run` refuses, and names a size in which every step is solved."""
    loading = {"depth": [DEPTH / 2, 3 * DEPTH, 8 * DEPTH]}
    small = run(grid={"points": 64, "size": 4e-5}, loading=loading)
    (tmp_path / "small.toml").write_text(small.to_toml(), encoding="utf-8")
    (tmp_path / "study.toml").write_text(
        small.to_toml() + '\n[study.vary]\n"kernel.tension" = [0.0, 0.05]\n', encoding="utf-8"
    )
    command = ["run", str(tmp_path / "small.toml"), "-o", str(tmp_path / "out")]
    assert "pellicle check" in call(*command, code=1).output
    done = call("check", tmp_path / "small.toml", code=1)
    assert "reaches the edge" in done.output
    named = re.search(r"grid.size = (\[.*?\]) holds", done.output)
    assert named, done.output
    data = call("check", tmp_path / "small.toml", "--json", code=1)
    assert json.loads(data.stdout)["at_edge"] == [2, 3]
    call(*command, "--overwrite", "--set", f"grid.size={named[1]}")
    checked = call("check", tmp_path / "study.toml", code=1)
    assert re.search("surface tension 0 .*: the contact of steps 2, 3 reaches", checked.output)


@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
def test_depth_errs_where_the_force_is_prescribed() -> None:
    """The error of the force is 0 there, and that of the depth decides on the points."""
    exact = indent(Paraboloid(radius=1e-4), MODULUS, 0.05, depth=DEPTH)
    given = run(loading={"force": [exact.force]})
    depth = float(pl.run(given, progress=False).dataset["depth"][0])
    (step,) = advise(given, 0.01).steps
    assert step.force_error < 1e-9
    assert abs(depth / exact.depth - 1) <= step.error == step.depth_error <= 0.1
    # The error falls with the square of the cell size.
    assert advise(given, step.error / 2).points[0] >= 64 * 2**0.5


def test_the_shape_of_the_grid_is_kept_and_coarse_areas_are_not_made_coarser() -> None:
    """Suggested cells are as square as those of the run; its area stays known to a tenth."""
    grid = {"points": [96, 64], "size": [6e-5, 4e-5]}
    nx, ny = advise(run(grid=grid), 0.5).points
    assert nx / ny == pytest.approx(1.5, rel=0.05)
    worst = max(step.area_error for step in advise(run(grid=grid), 0.5).steps)
    assert ny >= 64 * min(1, worst / 0.1)


def test_a_study_is_checked_run_by_run(tmp_path: Path) -> None:
    """Each run has the advice of its own file; the worst is named, and those above it counted."""
    path = tmp_path / "study.toml"
    path.write_text(
        run().to_toml() + '\n[study.vary]\n"kernel.tension" = [0.0, 0.05]\n',
        encoding="utf-8",
    )
    data = json.loads(call("check", path, "--json").stdout)
    alone = [advise(run(tension=tension), 0.01) for tension in (0.0, 0.05)]
    for checked, expected in zip(data["runs"], alone, strict=True):
        assert checked["points"] == list(expected.points)
        assert [step["force_error"] for step in checked["steps"]] == pytest.approx(
            [step.force_error for step in expected.steps], rel=1e-9
        )
    worst = max(step.force_error for advice in alone for step in advice.steps)
    over = sum(max(step.force_error for step in advice.steps) > 0.01 for advice in alone)
    printed = call("check", path).stdout
    assert f"2 runs; in {over} the error of force or depth may exceed 1 %" in printed
    number = printed.partition("the worst: ")[2].partition(" %")[0]
    assert float(number) == pytest.approx(100 * worst, rel=0.06)


def test_a_run_of_a_study_that_cannot_be_checked_is_named(tmp_path: Path) -> None:
    """The message says which run has too few cells to compare with."""
    path = tmp_path / "study.toml"
    path.write_text(
        run().to_toml() + '\n[study.vary]\n"grid.points" = [64, 16]\n', encoding="utf-8"
    )
    done = call("check", path, code=2)
    assert re.search(r"grid\.points: .*leave nothing to compare with.*at least 32", done.output)
    assert "(run with number of cells 16)" in done.output


@pytest.mark.parametrize("cells", [4, 8])
def test_a_rough_surface_is_checked_on_grids_that_resolve_it(cells: int, tmp_path: Path) -> None:
    """Its shortest wave has more than two cells on each of them, and few of the run are told."""
    rough = run(
        tension=0.0,
        grid={"points": 96, "size": 4e-5, "boundary": "periodic"},
        indenter=self_affine(1e-7, 0.8, cells * 4e-5 / 96),
        loading={"mean_pressure": [50.0]},
    )
    (step,) = advise(rough, 0.01).steps
    assert 0 < step.area_error < 1
    path = tmp_path / "rough.toml"
    path.write_text(rough.to_toml(), encoding="utf-8")
    printed = call("check", path).stdout
    assert ("shortest wave of the indenter has 4 cells" in printed) == (cells == 4)


def case(name: str, computed: Callable[[pl.Result], float], expected: float = 1.0) -> pl.Case:
    """Return a case about the small run."""
    return pl.Case(name, RUN, computed, expected, "N", 1e-3, "Hertz 1882")


def test_a_case_that_raises_fails_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the function of a case raises is the problem of this case, and the rest is checked."""
    cases = [
        case("lost", lambda result: result.dataset["load"].item()),
        case("good", lambda result: 1.0),
    ]
    lost, good = validation.validate(cases)
    assert (lost.passed, good.passed) == (False, True)
    assert lost.problem.startswith("KeyError: ")
    assert math.isnan(lost.computed)
    monkeypatch.setattr(validation, "validate", lambda: iter((lost, good)))
    shown = call("validate", code=1)
    assert "FAILED KeyError: " in shown.stdout
    assert "1 of 2 cases failed" in shown.stdout


def test_cases_in_a_row_share_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """A configuration is solved once for all cases about it that follow each other."""
    solve = Mock(side_effect=runner.solve)
    monkeypatch.setattr(validation, "solve", solve)
    checked = validation.validate(case(name, lambda result: 1.0) for name in "abc")
    assert [one.case.name for one in checked] == ["a", "b", "c"]
    solve.assert_called_once()


def test_a_case_expects_a_value_with_a_relative_error() -> None:
    """A true value of 0 is refused where the case is made."""
    with pytest.raises(pl.ConfigError, match="expected: 0 has no relative error"):
        case("nothing", lambda result: 0.0, expected=0.0)
