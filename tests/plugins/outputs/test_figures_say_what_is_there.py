"""Figures and pages draw what is there: contact, full contact without a gap, steps over time."""

import json
import re
import xml.etree.ElementTree as ET
import xml.etree.ElementTree as Xml
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.results import StoredRuns
from pellicle.results.path import label_of_step
from pellicle.show import draw, figures, without_round_off
from pellicle_plugins.outputs import html_curves
from pellicle_plugins.outputs.figures import force_depth, over_time, study_curves
from pellicle_plugins.outputs.step_figures import profile
from tests.command import call
from tests.pictures import pixels
from tests.plugins.outputs.shared import bead, rows
from tests.tables_of_runs import half_space, relaxing, self_affine

RUN = bead(
    grid={"points": 16, "size": "1 mm", "boundary": "periodic"},
    indenter=self_affine("1 um", 0.8, "0.2 mm", roll_off_wavelength="0.5 mm", seed=3),
    loading={"mean_pressure": ["40 Pa", "10 kPa"]},
)
CONTROL = "a\x00b\x1b[1mc\x07\x9f\ufffe --> d"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a run whose second step is full contact."""
    folder = tmp_path_factory.mktemp("full")
    outputs = [{"type": "html"}, {"type": "profiles", "y": "gap", "by": "step"}]
    pl.run({**RUN, "outputs": outputs}, directory=folder, progress=False, threads=1)
    return folder


def test_round_off_is_no_gap(folder: Path) -> None:
    """In full contact figures, their numbers and pages show a gap of 0; results keep what it is."""
    result = pl.load(folder / "run.h5")
    part, full = (result.dataset.isel(step=step) for step in (0, 1))
    assert full["contact"].all()
    assert 0 < abs(full["gap"]).max() < 1e-13
    assert not without_round_off(full)["gap"].any()
    opened = part["gap"].values > 1e-8
    assert opened.sum() > 50
    assert (without_round_off(part)["gap"].values[opened] == part["gap"].values[opened]).all()
    table = rows(folder / "run-profiles.csv")
    assert {float(row["y"]) for row in table if row["curve"] == "step = 2"} == {0.0}
    assert max(float(row["y"]) for row in table) > 1e-7
    assert _gaps(folder / "run.html")[1] == (0.0, 0.0)
    assert _gaps(folder / "run.html")[0][1] > 0


def test_a_layer_that_sinks_far_has_gaps() -> None:
    """Gaps are compared with the heights, not with the sinking of a thick layer, 10⁵ times that."""
    layer = {
        "type": "bonded_layer",
        "reduced_modulus": "10 kPa",
        "poissons_ratio": 0.2,
        "thickness": "100 m",
    }
    changes = {
        "kernel": layer,
        "loading": {"mean_pressure": "40 Pa"},
        "solver": {"type": "active_set", "tolerance": 1e-6},
    }
    step = pl.run({**RUN, **changes}, progress=False).dataset.isel(step=0)
    opened = ~step["contact"].values & (step["gap"].values > 1e-8)
    assert opened.sum() > 50
    assert (without_round_off(step)["gap"].values[opened] == step["gap"].values[opened]).all()


def _gaps(path: Path) -> list[tuple[float, float]]:
    """Return the lowest and the highest gap of each frame of a page."""
    text = path.read_text(encoding="utf-8")
    (data,) = re.findall(r'<script [^>]*class="maps">(.*?)</script>', text, re.DOTALL)
    fields = [frame["fields"][1] for frame in json.loads(data)["frames"]]
    return [(field["low"], field["high"]) for field in fields]


def test_map_of_one_value_has_the_colour_of_its_value(tmp_path: Path) -> None:
    """Nowhere a gap is the lowest colour, and the same pressure everywhere the highest."""
    full = {**RUN, "loading": {"mean_pressure": "10 kPa"}}
    outputs = [{"type": "maps", "field": f, "name": f} for f in ("gap", "mean_pressure")]
    pl.run({**full, "outputs": outputs}, directory=tmp_path, progress=False)
    for field, end in (("gap", 0.0), ("mean_pressure", 1.0)):
        image = pixels(tmp_path / f"run-{field}.png")
        middle = image[image.shape[0] // 2, image.shape[1] // 3]
        np.testing.assert_allclose(middle, matplotlib.colormaps["viridis"](end)[:3], atol=0.01)


def test_round_off_is_no_gap_in_a_study(tmp_path: Path) -> None:
    """The page of a study draws the last steps of its runs, where they are full contact, closed."""
    study = {**RUN, "outputs": [{"type": "html"}], "study": {"vary": {"kernel.tension": [0, 0.01]}}}
    pl.run_study(study, tmp_path, progress=False)
    assert _gaps(tmp_path / "study.html") == [(0.0, 0.0), (0.0, 0.0)]


def test_the_profile_meets_the_contact_and_shows_the_whole_gap() -> None:
    """A centre line without contact gives way to that of the greatest pressure."""
    x = (np.arange(32) + 0.5) / 32 - 0.5
    bump = 5e-7 * np.exp(-((x[:, None] + 0.2) ** 2 + (x - 0.3) ** 2) / 0.02)
    result = pl.run(
        {
            "grid": {"points": 32, "size": 1e-4},
            "kernel": {"type": "half_space", "reduced_modulus": 1e4},
            "indenter": {"type": "heights", "values": bump.tolist(), "unit": 1.0},
            "loading": {"depth": 2e-7},
        },
        progress=False,
    )
    chart = profile(result)
    gap = chart.series[1].y
    assert np.isfinite(gap[:-1]).all()
    assert gap.max() > 0.3e-6
    assert chart.y[1].limits == (0.0, None)
    assert chart.title == "depth 200 nm, y = 29.7 µm"


@pytest.mark.parametrize(("x", "places"), [("x", 16), ("depth", 1)])
def test_bare_numbers_are_drawn(x: str, places: int, tmp_path: Path) -> None:
    """An expression without a variable is the same everywhere, also over another such."""
    outputs = [{"type": "profiles", "y": "2", "x": x}, {"type": "maps", "field": "1"}]
    pl.run({**RUN, "outputs": outputs}, directory=tmp_path, progress=False)
    table = rows(tmp_path / "run-profiles.csv")
    assert [float(row["y"]) for row in table] == [2.0] * 16
    assert len({row["x"] for row in table}) == places
    assert (tmp_path / "run-maps.png").exists()


@pytest.mark.slow
def test_control_characters_in_a_title_do_no_harm(tmp_path: Path) -> None:
    """SVG is XML, pages hold what HTML allows, results are kept, and no terminal is told."""
    outputs = [{"type": "figures", "formats": ["svg"]}, {"type": "html"}]
    run = pl.Run(**RUN, title=CONTROL, outputs=outputs)
    pl.run(run, directory=tmp_path, progress=False)
    for path in tmp_path.glob("*.svg"):
        ET.parse(path)
    (path,) = tmp_path.glob("*.html")
    page = path.read_text(encoding="utf-8")
    assert not re.search("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ufffe]", page)
    assert "--&gt; d" in page
    (path,) = tmp_path.glob("*.h5")
    assert json.loads(pl.load(path).dataset.attrs["configuration"])["title"] == CONTROL
    shown = call("show", path)
    assert shown.stdout.startswith("title:    a\ufffdb\ufffd[1mc\ufffd")
    (tmp_path / "a.toml").write_text(run.to_toml(), encoding="utf-8")
    planned = call("run", tmp_path / "a.toml", "--dry-run")
    assert "\x1b" not in planned.stdout


LEGS = [
    {"to": "20 um", "time": "1 s", "num": 4},
    {"to": "18 um", "time": "0 s", "num": 1},
    {"to": "0 um", "time": "1 s", "num": 4},
]
TIMED = bead(
    title="bead",
    grid={"points": 16, "size": "0.45 mm"},
    kernel=relaxing(half_space("10 kPa"), 0.8, "0.5 s"),
    loading={"depth": LEGS},
    outputs=[{"type": "html"}, {"type": "vtk"}],
)


@pytest.fixture(scope="module")
def timed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the timed of a bead pressed in, drawn back at once by a bit and then slowly."""
    timed = tmp_path_factory.mktemp("bead")
    result = pl.run(TIMED, directory=timed, progress=False, threads=1)
    assert result.converged
    return timed


@pytest.fixture(scope="module")
def result(timed: Path) -> pl.Result:
    """Return the result of that run."""
    return pl.load(timed / "bead.h5")


def test_figure_over_time_has_what_the_result_has(result: pl.Result) -> None:
    """Force, depth and area have a curve each over the time; without times there is no figure."""
    chart = over_time(result)
    assert "time" in figures(result)
    assert "time" not in figures(pl.Result(result.dataset.drop_vars("time")))
    assert [axis.words for axis in chart.y] == ["force", "depth", "contact area"]
    for name, series in zip(["force", "depth", "contact_area"], chart.series, strict=True):
        np.testing.assert_array_equal(series.x, result.dataset["time"])
        np.testing.assert_array_equal(series.y, result.dataset[name])


def test_loop_tells_approach_from_retraction(result: pl.Result) -> None:
    """The curve of force against depth is two, named in the legend, which enclose an area."""
    figure = Figure()
    draw(figure, force_depth(result))
    (axes,) = figure.axes
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["approach", "retraction"]
    depth, force = result.dataset["depth"].values, result.dataset["force"].values
    area = float(np.trapezoid(force, depth))
    assert area > 0.2 * force.max() * depth.max()


def test_last_step_in_contact_is_drawn(timed: Path, result: pl.Result) -> None:
    """A path that ends out of contact shows the last step in contact, and says when it was."""
    last = int(np.flatnonzero(result.dataset["contact_area"].values)[-1])
    assert 4 < last < 8
    time = result.dataset["time"].values[last]
    assert f"{time:g} s, depth " in profile(result).title
    text = (timed / "bead.html").read_text(encoding="utf-8")
    (chosen,) = re.findall(r"<option value=\"(\d+)\" selected>", text)
    assert int(chosen) == last


def test_profile_is_of_the_step_of_the_map(
    timed: Path, result: pl.Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where few of the mapped steps have a profile, the step that is shown first has its own."""
    text = (timed / "bead.html").read_text(encoding="utf-8")
    (chosen,) = re.findall(r"<option value=\"(\d+)\" selected>", text)
    monkeypatch.setattr(html_curves, "_PROFILES", 5)
    steps = list(range(result.dataset.sizes["step"]))
    picture = html_curves.curves_of_run(result, steps, int(chosen))[0]
    assert len({id(part) for part in picture.by_frame}) == 4
    label = label_of_step(result.dataset, int(chosen))
    assert label in picture.caption
    assert picture.by_frame[int(chosen)].source == picture.source


def test_page_has_a_line_of_time(timed: Path) -> None:
    """The choice of steps says time and depth, and a slider goes through the steps."""
    text = (timed / "bead.html").read_text(encoding="utf-8")
    labels = re.findall(r"<option value=\"\d+\"[^>]*>([^<]*)</option>", text)
    assert labels[:2] == ["1: 250 ms, depth 5 µm", "2: 500 ms, depth 10 µm"]
    assert '<input type="range" min="0" max="8"' in text
    assert "Force, depth and contact area over time." in text


def test_paraview_has_the_time(timed: Path, result: pl.Result) -> None:
    """Timesteps are times; that after a jump is the next number, not the same."""
    listed = Xml.parse(timed / "bead.pvd").iter("DataSet")
    times = [float(entry.attrib["timestep"]) for entry in listed]
    np.testing.assert_allclose(times, result.dataset["time"], rtol=1e-15)
    assert (np.diff(times) > 0).all()
    assert times[3] == 1.0 == result.dataset["time"].values[4]


def test_study_is_drawn_over_time(tmp_path: Path) -> None:
    """Curves of a study of runs with times are over the time."""
    loading = {"depth": [{"to": "20 um", "time": 0, "num": 1}, {"hold": "2 s", "num": 3}]}
    study = pl.Study(
        run={**TIMED, "loading": loading, "outputs": []},
        vary={"kernel.relaxation.0.time": ["0.5 s", "5 s"]},
    )
    table = pl.run_study(study, directory=tmp_path, progress=False)
    chart = study_curves(StoredRuns.of_study(table, Path()), "force")
    assert (chart.x.words, chart.x.unit) == ("time", "s")
    ends = {line.legend.rpartition(" relaxation 1 ")[2]: line.y for line in chart.series}
    assert ends["0.5 s"][-1] < ends["5 s"][-1]
