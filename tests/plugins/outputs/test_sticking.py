"""Figures, tables and pages of contacts that stick, along paths with negative depths."""

import base64
import json
import re
import zlib
from html import unescape
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.show.fields import default_step
from pellicle.units import Quantity
from pellicle.variables import VARIABLES, names_of
from tests.command import call
from tests.plugins.outputs.shared import rows
from tests.tables_of_runs import half_space, paraboloid, pressing

# A coarse grid makes pictures in seconds; the units E* = R = w = 1 make slopes steep.
pytestmark = [
    pytest.mark.filterwarnings(
        "ignore:.*(cells wide|slopes in contact|at pull-off):pellicle.ConvergenceWarning"
    ),
    pytest.mark.filterwarnings(
        "ignore:.*(in . the cells are too coarse|pull-off force):UserWarning"
    ),
]

BACK = {"start": "0.2 m", "stop": "-2.2 m", "num": 5, "back": True}
BEAD = pressing(24, "5 m", half_space("1 Pa"), paraboloid("1 m"), depth=BACK)
BEAD["interaction"] = {"type": "jkr", "work_of_adhesion": "1 J/m^2"}
OUTPUTS: list[dict[str, Any]] = [
    {"type": "html"},
    {"type": "vtk"},
    {"type": "curves", "y": ["force", "contact_radius"]},
    {"type": "maps"},
    {"type": "distributions", "by": "step"},
]
EVERYTHING: list[dict[str, Any]] = [
    *OUTPUTS,
    {"type": "curves", "name": "log", "x": "contact_area", "y": "depth", "log": ["x", "y"]},
    *({"type": name} for name in ("csv", "figures", "profiles", "patches", "spectrum")),
]
STUDY: dict[str, Any] = {
    **BEAD,
    "outputs": [
        {"type": "figures"},
        {"type": "html"},
        {"type": "curves"},
        {
            "type": "curves",
            "name": "pull",
            "x": "interaction.work_of_adhesion",
            "y": ["pull_off", "share"],
        },
        {"type": "curves", "name": "wall", "y": "max(wall_pressure)"},
    ],
    "study": {
        "vary": {"interaction.work_of_adhesion": ["0.7 J/m^2", "1 J/m^2"]},
        "derived": {"share": "pull_off / (pi * interaction.work_of_adhesion)", "twice": "2*force"},
    },
}


@pytest.fixture(scope="module")
def bead(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, pl.Result]:
    """Return the folder of a path up, out of contact and back, and its result."""
    folder = tmp_path_factory.mktemp("bead")
    result = pl.run({**BEAD, "outputs": OUTPUTS}, directory=folder, progress=False, threads=1)
    return folder, result


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, xr.Dataset]:
    """Return the folder of a study of two works of adhesion, and its table."""
    folder = tmp_path_factory.mktemp("study")
    with pytest.warns(UserWarning, match="in 2 slopes in contact are beyond the theory"):
        return folder, pl.run_study(STUDY, folder, progress=False, threads=1)


def test_pull_off_on_few_cells_has_its_error_beside_it(bead: tuple[Path, pl.Result]) -> None:
    """Six cells in the radius are warned of on terminal and page."""
    folder, result = bead
    ((_, few),) = (pair for pair in result.caveats() if pair[1].status.name == "FEW_AT_PULL_OFF")
    message = few.sentence
    assert "6.0 cells" in message
    summary = result.path_summary
    for data in (result.dataset, pl.load(folder).dataset):
        known = {name: value for name, value in summary.items() if not np.isnan(value)}
        assert {"pull_off", "work"} <= known.keys()
        assert {name: data[name].item() for name in names_of("path") if name in data} == known
    assert -summary["pull_off"] * 0.05 < summary["pull_off_accuracy"] < -summary["pull_off"] * 0.2
    assert message in " ".join(call("show", folder / "run.h5").output.split())
    assert message[1:] in unescape((folder / "run.html").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_the_path_is_summarised_where_the_result_is(bead: tuple[Path, pl.Result]) -> None:
    """Result, page and terminal have the same numbers, which are those of the steps."""
    folder, result = bead
    data, summary = result.dataset, result.path_summary
    assert tuple(summary) == names_of("path")
    assert summary["pull_off"] == data["force"].min().item()
    assert summary["pull_off"] == pytest.approx(-1.5 * pi, rel=0.15)
    contact = data["contact_area"].values > 0
    lost = int(np.argmin(contact)) - 1
    assert summary["detach"] == data["depth"].values[lost]
    assert summary["detach"] == pytest.approx(-1.6088, abs=0.6)
    assert summary["detach_accuracy"] == pytest.approx(0.6)
    assert summary["jump_in"] == pytest.approx(0.2)
    assert summary["work"] == pytest.approx(summary["dissipated_energy"], rel=1e-6)
    shown = call("show", folder / "run.h5").output
    page = unescape((folder / "run.html").read_text(encoding="utf-8"))
    for name, value in summary.items():
        unit, words = VARIABLES[name].unit, VARIABLES[name].words
        row = re.search(rf"^{words} {{2,}}(.+?) {{2,}}", shown, re.MULTILINE)
        assert row, name
        text = row[1]
        assert Quantity(unit)(float(text) if unit == "1" else text) == pytest.approx(
            value, rel=1e-3
        )
        assert f">{words}</td>" in page
        assert f">{text}</td>" in page


def test_the_last_step_in_contact_is_drawn(bead: tuple[Path, pl.Result]) -> None:
    """A path that ends out of contact would otherwise have empty figures."""
    data = bead[1].dataset
    assert default_step(data) == data.sizes["step"] - 1
    retraction = data.isel(step=slice(0, 5))
    assert retraction["contact_area"].values[-1] == 0
    assert retraction["contact_area"].values[default_step(retraction)] > 0
    assert default_step(data.isel(step=[4])) == -1


def test_approach_and_retraction_are_told_apart(bead: tuple[Path, pl.Result]) -> None:
    """Each row of a curve has its direction; a turn belongs to the leg that reaches it."""
    table = rows(bead[0] / "run-curves.csv", series="force")
    assert [row["direction"] for row in table] == ["retraction"] * 5 + ["approach"] * 4
    np.testing.assert_allclose([float(r["y"]) for r in table], bead[1].dataset["force"])


def test_page_and_paraview_have_both_pressures(bead: tuple[Path, pl.Result]) -> None:
    """The traction in colours centred at 0, the wall pressure beside it; others are empty."""
    text = (bead[0] / "run.html").read_text(encoding="utf-8")
    (script,) = re.findall(r'<script [^>]*class="maps">(.*?)</script>', text, re.DOTALL)
    data = json.loads(script)
    names = [field["name"] for field in data["fields"]]
    assert names == ["pressure", "wall pressure", "gap"]
    assert [field.get("centred", False) for field in data["fields"]] == [True, False, False]
    assert any(
        frame["fields"][0]["low"] < 0 < frame["fields"][0]["high"] for frame in data["frames"]
    )
    first = data["frames"][0]["fields"][0]
    planes = np.frombuffer(zlib.decompress(base64.b64decode(first["data"])), np.uint8)
    high, low = planes.reshape(2, -1).astype(np.uint16)
    empty = np.cumsum(high << 8 | low, dtype=np.uint16) == 0xFFFF
    np.testing.assert_array_equal(empty, bead[1].dataset["pressure"].values[0].ravel() == 0)
    assert b'Name="wall_pressure"' in (bead[0] / "run-0001.vts").read_bytes()


def test_distribution_of_pressure_gives_the_force(bead: tuple[Path, pl.Result]) -> None:
    """Mean times density times width, times the area with a traction, is the force."""
    data = bead[1].dataset.isel(step=0)
    bins = rows(bead[0] / "run-distributions.csv", curve="step = 1", series="pressure")
    mean = sum(
        float(r["mean"]) * float(r["density"]) * (float(r["upper"]) - float(r["lower"]))
        for r in bins
    )
    area = (data["pressure"] != 0).sum().item() * bead[1].grid.cell_area
    assert mean * area == pytest.approx(data["force"].item(), rel=1e-9)


@pytest.mark.slow
def test_a_path_that_never_touches_is_drawn(tmp_path: Path) -> None:
    """At negative depths there is nothing to draw, and everything that draws it still ends."""
    changes = {"loading": {"depth": ["-1 m", "-2 m", "-0.5 m"]}, "outputs": EVERYTHING}
    result = pl.run({**BEAD, **changes}, directory=tmp_path, progress=False, threads=1)
    assert result.dataset["contact_area"].max() == 0
    assert np.isnan(result.path_summary["pull_off"])
    shown = call("show", tmp_path / "run.h5")
    assert re.search(r"^pull-off force +none ", shown.output, re.MULTILINE)
    assert "<td" in (tmp_path / "run.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_study_has_one_path_for_each_run(study: tuple[Path, xr.Dataset]) -> None:
    """Pull-off has no step: it is a curve against what varies, in table, CSV, page and terminal."""
    folder, table = study
    assert table["pull_off"].dims == table["share"].dims == table["run"].dims
    assert table["twice"].dims == table["force"].dims
    np.testing.assert_array_equal(table["pull_off"], table["force"].min("step"))
    work = table["interaction.work_of_adhesion"]
    np.testing.assert_array_equal(table["share"], table["pull_off"] / (np.pi * work))
    drawn = rows(folder / "study-pull.csv")
    assert [float(row["x"]) for row in drawn] == [0.7, 1.0] * 2
    assert [float(row["y"]) for row in drawn[:2]] == table["pull_off"].values.tolist()
    assert {row["converged"] for row in drawn} == {"True"}
    by_step = rows(folder / "study.csv")
    assert {float(row["pull_off [N]"]) for row in by_step} == {*table["pull_off"].values}
    errors = table["pull_off_accuracy"] / -table["pull_off"]
    assert ((errors > 0.05) & (errors < 0.2)).all()
    output = call("show", folder).output
    assert "accuracy of the pull-off force" in output
    shown = output.partition("path:")[2]
    assert [line.split()[1] for line in shown.splitlines()[2:4]] == [
        f"{value:.4g}" for value in table["pull_off"].values
    ]
    page = (folder / "study.html").read_text(encoding="utf-8")
    assert "The path of each run" in page
    highest = max(float(row["y"]) for row in rows(folder / "study-wall.csv"))
    runs = [xr.load_dataset(path, engine="h5netcdf") for path in (folder / "runs").glob("*.h5")]
    assert highest == max(run["wall_pressure"].max().item() for run in runs)


def test_without_an_interaction_nothing_is_added(tmp_path: Path) -> None:
    """There is no path, no wall pressure and no direction, even there and back."""
    depth = {"start": "0.5 m", "stop": "1 m", "num": 2, "back": True}
    hard = {k: v for k, v in BEAD.items() if k != "interaction"} | {"loading": {"depth": depth}}
    outputs = [{"type": "curves"}, {"type": "html"}, {"type": "vtk"}]
    result = pl.run({**hard, "outputs": outputs}, directory=tmp_path, progress=False, threads=1)
    assert result.path_summary == {}
    assert "direction" not in rows(tmp_path / "run-curves.csv")[0]
    assert b"wall_pressure" not in (tmp_path / "run-0001.vts").read_bytes()
    assert "pull off" not in (tmp_path / "run.html").read_text(encoding="utf-8")
    assert "path:" not in call("show", tmp_path / "run.h5").output
    with pytest.raises(pl.ConfigError, match="pull_off"):
        pl.Study.of(
            {**hard, "study": {"vary": {"indenter.radius": [1, 2]}, "derived": {"p": "pull_off"}}}
        )


def test_the_solution_without_adhesion_is_no_reference(tmp_path: Path) -> None:
    """A curve of contact that does not stick beside one that does would pass for its theory."""
    output = {"type": "curves", "reference": "axisymmetric"}
    loading = {"depth": ["0.2 m", "-1 m"]}
    with pytest.raises(pl.ConfigError, match="without adhesion"):
        pl.run({**BEAD, "loading": loading, "outputs": [output]}, directory=tmp_path)
