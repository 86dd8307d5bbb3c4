"""What the outputs that draw studies show, and what they refuse."""

from __future__ import annotations

import csv
import warnings
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
import tomli_w
import xarray as xr
from typer.testing import CliRunner

import pellicle as pl
from pellicle.cli.app import app
from pellicle.errors import ConvergenceWarning
from pellicle.plugins import registry
from tests.pictures import drawn_width, pixels

TENSION, RADIUS = "kernel.tension", "indenter.radius"


def study(*outputs: dict[str, Any] | pl.Output, **derived: str) -> dict[str, Any]:
    """Return a small study of two tensions, two radii and two steps."""
    return {
        "grid": {"points": 16, "size": "0.4 mm"},
        "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": 0.0},
        "indenter": {"type": "paraboloid", "radius": "1 mm"},
        "loading": {"depth": ["10 um", "15 um"]},
        "outputs": list(outputs),
        "study": {
            "vary": {TENSION: [0.0, 1.0], RADIUS: ["1 mm", "2 mm"]},
            **({"derived": derived} if derived else {}),
        },
    }


def rows(path: Path) -> list[dict[str, str]]:
    """Return the numbers that were drawn."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def carried(folder: Path, *outputs: dict[str, Any] | pl.Output, **derived: str) -> xr.Dataset:
    """Return the table of the study, its outputs left in the folder."""
    return pl.run_study(study(*outputs, **derived), folder, progress=False, threads=1)


def test_curves_are_mean_and_range_of_the_table(tmp_path: Path) -> None:
    """One curve for each tension, its points means over the radii, with lowest and highest."""
    table = carried(
        tmp_path,
        {"type": "curves", "x": "depth", "y": "force", "by": TENSION, "over": RADIUS},
    )
    table_rows = rows(tmp_path / "study-curves.csv")
    for name, expected in (
        ("y", table["force"].mean("indenter_radius")),
        ("y_lowest", table["force"].min("indenter_radius")),
        ("y_highest", table["force"].max("indenter_radius")),
    ):
        drawn = [float(row[name]) for row in table_rows]
        np.testing.assert_allclose(drawn, expected.values.ravel(), rtol=1e-14)


def test_curves_of_a_study_of_one_axis_need_no_by(tmp_path: Path) -> None:
    """Each value has its own curve over the steps; of an x that is the axis, each step has."""
    plan = study({"type": "curves"}, {"type": "curves", "name": "over", "x": TENSION})
    plan["study"]["vary"].pop(RADIUS)
    pl.run_study(plan, tmp_path, progress=False, threads=1)
    assert [row["curve"] for row in rows(tmp_path / "study-curves.csv")] == [
        *2 * ["kernel.tension = 0 N/m"],
        *2 * ["kernel.tension = 1 N/m"],
    ]
    assert [row["x"] for row in rows(tmp_path / "study-over.csv")] == 2 * ["0.0", "1.0"]


def test_fields_of_one_run_of_a_study_say_which(tmp_path: Path) -> None:
    """Without by it is the first value of each axis that is shown, and named."""
    carried(tmp_path, {"type": "distributions"})
    shown = {row["curve"] for row in rows(tmp_path / "study-distributions.csv")}
    assert shown == {"kernel.tension = 0 N/m, indenter.radius = 1 mm"}


class Failing(pl.Output):
    """Finds out too late that it cannot show a study."""

    type: Literal["failing"] = "failing"

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        """Refuse."""
        raise pl.ConfigError("is not what it seemed", "type")


def test_an_output_that_fails_keeps_no_other_from_drawing(tmp_path: Path) -> None:
    """The one that fails is named by its place among the outputs."""
    with pytest.warns(UserWarning, match=r"^outputs\.1\.type: is not what it"):
        table = carried(
            tmp_path,
            {"type": "hdf5"},
            Failing(),
            {"type": "distributions", "by": TENSION},
        )
    assert table["converged"].all()
    assert drawn_width(tmp_path / "study-distributions.png") > 0.3


def test_derived_columns_build_on_each_other_and_on_constants(tmp_path: Path) -> None:
    """A derived column may name those before it, axes and numbers of the configuration."""
    table = carried(tmp_path, s=f"2 * {TENSION} / kernel.reduced_modulus", s_over_r=f"s / {RADIUS}")
    np.testing.assert_allclose(table["s_over_r"][1, 0], 2 * 1.0 / 1e4 / 1e-3, rtol=1e-14)
    np.testing.assert_allclose(table["s_over_r"][1, 1], 2 * 1.0 / 1e4 / 2e-3, rtol=1e-14)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("kernel.tensoin * 2", r"study.derived.s: 'kernel.tensoin'.*did you mean"),
        ("force +", r"study.derived.s: .*not arithmetic"),
    ],
)
def test_wrong_derived_columns_are_known_before_running(text: str, message: str) -> None:
    """The study is refused, with the column's name."""
    with pytest.raises(pl.ConfigError, match=message):
        pl.Study.from_mapping(study(s=text))


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ({"type": "curves", "by": "kernel.tensoin"}, "not an axis of the table; did you mean"),
        ({"type": "curves", "by": TENSION}, "would go over indenter.radius and step"),
        ({"type": "maps", "by": "seed"}, "not an axis of the table"),
        ({"type": "maps", "field": "presure"}, "did you mean 'pressure'"),
        ({"type": "profiles", "y": "presure"}, "did you mean 'pressure'"),
        ({"type": "curves", "y": "foce", "by": TENSION}, "did you mean 'force'"),
        ({"type": "curves", "by": "step", "label": "{foce}"}, "did you mean 'force'"),
        ({"type": "curves", "extrapolate": True, "by": RADIUS, "over": TENSION}, "at least 3"),
        ({"type": "adhesive_curve", "work_of_adhesion": 1.0}, "stiffness"),
    ],
)
def test_what_cannot_be_drawn_is_named(
    output: dict[str, Any], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The message says which axis or name there is, and nothing is solved before."""
    monkeypatch.chdir(tmp_path)
    plan = study({"type": "hdf5"}, output)
    (tmp_path / "plan.toml").write_text(tomli_w.dumps(plan), encoding="utf-8")
    with pytest.raises(pl.ConfigError, match=rf"^outputs\.1.*{message}"):
        pl.run_study(plan, tmp_path, progress=False)
    for command in (["run", "--dry-run"], ["check"]):
        done = CliRunner().invoke(app, [*command, "plan.toml"])
        assert (done.exit_code, "outputs.1" in done.output) == (2, True)
    assert not list(tmp_path.rglob("*.h5"))


@pytest.mark.parametrize("type_", ["curves", "profiles"])
def test_a_reference_that_does_not_exist_is_refused_at_once(type_: str, tmp_path: Path) -> None:
    """It is not asked for after all runs are solved, whichever of them has none."""
    plan = study({"type": type_, "by": "indenter", "reference": "axisymmetric"})
    quadric = {"type": "quadric", "radius_x": "1 mm", "radius_y": "2 mm"}
    plan["study"]["vary"] = {"indenter": [plan["indenter"], quadric]}
    with pytest.raises(pl.ConfigError, match=r"^outputs\.0\.reference: .*'quadric'"):
        pl.run_study(plan, tmp_path, progress=False)
    assert not list(tmp_path.rglob("*.h5"))


def test_fields_are_reduced_for_each_run(tmp_path: Path) -> None:
    """An expression over fields gives the number of each step."""
    carried(
        tmp_path,
        {"type": "curves", "x": "depth", "y": "sum(pressure)", "by": TENSION, "over": RADIUS},
    )
    table = carried(tmp_path)
    spacing = 0.4e-3 / 16
    drawn = [float(row["y"]) * spacing**2 for row in rows(tmp_path / "study-curves.csv")]
    np.testing.assert_allclose(
        drawn, table["force"].mean("indenter_radius").values.ravel(), rtol=1e-12
    )


def test_semi_analytic_twin_is_only_of_what_has_one(tmp_path: Path) -> None:
    """An indenter that is not axisymmetric is refused by name."""
    run = study() | {
        "indenter": {"type": "quadric", "radius_x": "1 mm", "radius_y": "2 mm"},
        "outputs": [{"type": "curves", "reference": "axisymmetric"}],
    }
    del run["study"]
    with pytest.raises(pl.ConfigError, match=r"'quadric'.*have no axisymmetric solution"):
        pl.run(run, directory=tmp_path, progress=False)


def test_map_of_nothing_finite_is_empty(tmp_path: Path) -> None:
    """An expression that is infinite or NaN everywhere is drawn as an empty panel."""
    run = {key: value for key, value in study().items() if key != "study"}
    nowhere = {"type": "maps", "field": "1 / (0 * depth + 0 * pressure)"}
    pl.run(run | {"outputs": [nowhere]}, directory=tmp_path, progress=False)
    # Right of the panel is the bar of colours.
    assert drawn_width(tmp_path / "run-maps.png", columns=(0, 0.7)) == 0
    assert drawn_width(tmp_path / "run-maps.png", columns=(0.7, 1)) > 0


@pytest.mark.parametrize("type_", ["compliance", "spectrum"])
def test_a_single_cell_has_no_waves_to_draw(type_: str, tmp_path: Path) -> None:
    """The figure and a table of no rows are there all the same."""
    run = {
        "grid": {"points": 1, "size": "1 mm"},
        "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
        "indenter": {"type": "flat_punch", "radius": "2 mm"},
        "loading": {"depth": "1 um"},
        "outputs": [{"type": type_}],
    }
    with warnings.catch_warnings():
        # The contact reaches the edge of the domain.
        warnings.simplefilter("ignore", ConvergenceWarning)
        pl.run(run, directory=tmp_path, progress=False)
    assert rows(tmp_path / f"run-{type_}.csv") == []
    image = pixels(tmp_path / f"run-{type_}.png")
    # A frame as wide as the figure, nearly, and nothing in it.
    assert (image.max(axis=-1) < 0.2).mean(axis=1).max() > 0.7
    assert drawn_width(tmp_path / f"run-{type_}.png", columns=(0, 0.75)) == 0


def test_symbol_is_drawn_of_the_runs_that_are_there(tmp_path: Path) -> None:
    """The figure of a study that was interrupted shows what was done."""
    table = carried(tmp_path)
    gone = str(table["run"].values[0, 0])
    (tmp_path / "runs" / f"{gone}.h5").unlink()
    output = registry().make(pl.Output, {"type": "compliance", "by": TENSION})
    output.write(pl.Runs.of_study(table, tmp_path), tmp_path / "study-compliance")
    assert {row["curve"] for row in rows(tmp_path / "study-compliance.csv")} == {
        "kernel.tension = 1 N/m"
    }


def test_logarithmic_axes_of_nothing_positive(tmp_path: Path) -> None:
    """Curves through runs without contact are drawn, on axes that are not logarithmic."""
    run = {key: value for key, value in study().items() if key not in ("study", "outputs")}
    nothing = {"loading": {"depth": [0.0, 0.0]}}
    curves = {"type": "curves", "log": ["x", "y"]}
    pl.run(run | nothing | {"outputs": [curves]}, directory=tmp_path, progress=False)
    assert [float(row["y"]) for row in rows(tmp_path / "run-curves.csv")] == [0.0, 0.0]


def test_a_run_of_fewer_steps_is_drawn_at_its_last(tmp_path: Path) -> None:
    """Each run of a study is shown at its own last step, however many steps the others have."""
    configuration = study({"type": "profiles", "y": "pressure", "by": "loading.depth"})
    configuration["study"] = {"vary": {"loading.depth": [["10 um"], ["10 um", "15 um"]]}}
    pl.run_study(configuration, tmp_path, progress=False, threads=1)
    assert len({row["curve"] for row in rows(tmp_path / "study-profiles.csv")}) == 2
