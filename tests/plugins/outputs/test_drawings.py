"""What the outputs that draw studies show, and what they refuse."""

import json
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
import tomli_w
import xarray as xr

import pellicle as pl
from pellicle.components import Chart
from pellicle.results import StoredRuns
from pellicle_plugins.outputs.curves import Curves
from tests.command import call
from tests.plugins.outputs.shared import bead, rows

TENSION, RADIUS = "kernel.tension", "indenter.radius"


def study(*outputs: dict[str, Any] | pl.Output) -> dict[str, Any]:
    """Return a small study of two tensions, two radii and two steps."""
    plan = {"vary": {TENSION: [0.0, 1.0], RADIUS: ["1 mm", "2 mm"]}}
    return bead(outputs=list(outputs), study=plan, loading={"depth": ["10 um", "15 um"]})


def carried(folder: Path, *outputs: dict[str, Any] | pl.Output) -> xr.Dataset:
    """Return the table of the study, its outputs left in the folder."""
    return pl.run_study(study(*outputs), folder, progress=False, threads=1)


def test_curves_are_mean_and_range_of_the_table(tmp_path: Path) -> None:
    """One curve for each tension, its points means over the radii, with lowest and highest."""
    curves = {"type": "curves", "x": "depth", "y": "force", "by": TENSION, "over": RADIUS}
    table = carried(tmp_path, curves)
    table_rows = rows(tmp_path / "study-curves.csv")
    for name, expected in (
        ("y", table["force"].mean("indenter_radius")),
        ("y_lowest", table["force"].min("indenter_radius")),
        ("y_highest", table["force"].max("indenter_radius")),
    ):
        drawn = [float(row[name]) for row in table_rows]
        np.testing.assert_allclose(drawn, expected.values.ravel(), rtol=1e-14)


def test_the_spread_may_be_a_deviation(tmp_path: Path) -> None:
    """The standard deviation of the runs, of n − 1, and over √n that of their mean."""
    curves = {"type": "curves", "by": TENSION, "over": RADIUS}
    table = carried(
        tmp_path,
        {**curves, "name": "std", "spread": "std"},
        {**curves, "name": "sem", "spread": "sem"},
    )
    deviation = table["force"].std("indenter_radius", ddof=1).values.ravel()
    for name, expected in (("std", deviation), ("sem", deviation / np.sqrt(2))):
        drawn = rows(tmp_path / f"study-{name}.csv")
        half = [float(row["y_highest"]) - float(row["y"]) for row in drawn]
        np.testing.assert_allclose(half, expected, rtol=1e-9)
        assert {row["spread"] for row in drawn} == {name}


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
    distributions = {"type": "distributions", "by": TENSION}
    with pytest.warns(UserWarning, match=r"^outputs\.1\.type: is not what it"):
        table = carried(tmp_path, {"type": "maps"}, Failing(), distributions)
    assert table["converged"].all()
    assert (tmp_path / "study-distributions.png").exists()


def shown(**curves: Any) -> Chart:
    """Return the curves of a study of three axes, of 2, 3 and 2 values, and two steps."""
    plan = {"indenter.radius": [1e-3, 2e-3], TENSION: [0.0, 0.01, 1.0], "indenter.centre.0": [0, 1]}
    axes = {name: (name, values, {"units": "N/m"}) for name, values in plan.items()}
    table = xr.Dataset(coords=axes | {"step": [1, 2]})
    shape = 2, 3, 2, 2
    columns = {"force": np.arange(24.0).reshape(shape), "converged": np.ones(shape, bool)}
    columns |= {"depth": np.broadcast_to([1.0, 2.0], shape), "status": np.full(shape, "")}
    table = table.assign({name: ((*plan, "step"), column) for name, column in columns.items()})
    table = table.assign(run=(tuple(plan), np.full(shape[:-1], "a")))
    table.attrs = {"configuration": "{}", "axes": json.dumps([*plan])}
    ((_, chart),) = Curves(**curves).charts(StoredRuns(table, lambda name: table))
    assert isinstance(chart, Chart)
    return chart


def test_two_axes_have_colours_and_markers_and_others_panels() -> None:
    """No two curves of a panel look alike, and all looks are in the legend."""
    chart = shown(by=[RADIUS, TENSION])
    assert [title.split()[-2] for title in chart.titles] == ["0", "1"]
    curves = [one for one in chart.series if one.x.size]
    assert len({(one.panel, one.look.hue, one.look.line, one.look.marker) for one in curves}) == 12
    assert len({one.key for one in curves}) == 12
    assert curves[2].y.tolist() == [8.0, 9.0]
    assert [one.legend.split()[1] for one in chart.series if one.legend] == [
        "1",
        "2",
        "0",
        "0.01",
        "1",
    ]


def test_an_axis_is_shown_at_one_value() -> None:
    """The value has a unit; without `by` the first axis has colours, the next panels."""
    chart = shown(where={TENSION: "10 mN/m"})
    assert [one.y.tolist() for one in chart.series if not one.panel] == [[4.0, 5.0], [16.0, 17.0]]
    for where, message in (
        ({TENSION: "15 mN/m"}, "no value of kernel.tension, which has 0, 0.01, 1 N/m"),
        ({TENSION: "1 m"}, "kernel.tension: '1 m' is in m"),
        ({"step": 1}, "'step' is not an axis"),
    ):
        with pytest.raises(pl.ConfigError, match=message):
            shown(where=where)


def test_what_cannot_be_drawn_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message says which axis there is, and nothing is solved before."""
    monkeypatch.chdir(tmp_path)
    curves = {"type": "curves", "where": {TENSION: "2 N/m"}}
    plan = study({"type": "maps", "name": "good"}, curves)
    (tmp_path / "plan.toml").write_text(tomli_w.dumps(plan), encoding="utf-8")
    with pytest.raises(pl.ConfigError, match=r"^outputs\.1\.where: .*which has 0, 1 N/m"):
        pl.run_study(plan, tmp_path, progress=False)
    for command in (["run", "--dry-run"], ["check"]):
        assert "outputs.1" in call(*command, "plan.toml", code=2).output
    assert not list(tmp_path.rglob("*.h5"))


def test_a_number_that_the_reference_lacks_is_refused_at_once(tmp_path: Path) -> None:
    """The semi-analytic solution knows no iterations."""
    curves = {"type": "curves", "y": "iterations", "by": TENSION, "reference": "axisymmetric"}
    with pytest.raises(pl.ConfigError, match=r"^outputs\.0\.y: 'iterations' has no value in"):
        pl.run_study(study(curves), tmp_path, progress=False)


def test_fields_are_reduced_for_each_run(tmp_path: Path) -> None:
    """An expression over fields gives the number of each step."""
    curves = {"type": "curves", "x": "depth", "y": "sum(pressure)", "by": TENSION, "over": RADIUS}
    table = carried(tmp_path, curves)
    drawn = [float(row["y"]) * (0.4e-3 / 16) ** 2 for row in rows(tmp_path / "study-curves.csv")]
    force = table["force"].mean("indenter_radius").values.ravel()
    np.testing.assert_allclose(drawn, force, rtol=1e-12)


def test_a_run_of_fewer_steps_is_drawn_at_its_last(tmp_path: Path) -> None:
    """Each run of a study is shown at its own last step, however many steps the others have."""
    configuration = study({"type": "profiles", "y": "pressure", "by": "loading.depth"})
    configuration["study"] = {"vary": {"loading.depth": [["10 um"], ["10 um", "15 um"]]}}
    pl.run_study(configuration, tmp_path, progress=False, threads=1)
    assert len({row["curve"] for row in rows(tmp_path / "study-profiles.csv")}) == 2
