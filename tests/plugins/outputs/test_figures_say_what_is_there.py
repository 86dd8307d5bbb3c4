"""Figures draw what is there and are fit to print: axes, size, text, colours, legends, files."""

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.components import Axis, Chart, Column, Fields, Panel, Series, Table
from pellicle.results import StoredRuns, is_log_spaced
from pellicle.results.path import label_of_step
from pellicle.show import draw, figures, save_figure, without_round_off, write_charts
from pellicle.show.figure_style import FigureStyle
from pellicle_plugins.outputs import html_curves
from pellicle_plugins.outputs.figures import force_depth, over_time, study_curves
from pellicle_plugins.outputs.step_figures import pressure_map, profile
from tests.command import call
from tests.pictures import pixels
from tests.plugins.outputs.shared import bead, rows
from tests.tables_of_runs import half_space, heights, layer, pressing, relaxing, self_affine

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
    changes = {
        "kernel": layer("bonded_layer", "100 m", 0.2, reduced_modulus="10 kPa"),
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
    run = pressing(32, 1e-4, half_space(1e4), heights(bump), depth=2e-7)
    chart = profile(pl.run(run, progress=False))
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
    listed = ET.parse(timed / "bead.pvd").iter("DataSet")
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


@pytest.fixture(scope="module")
def table() -> Any:
    """Return the table of a study of three tensions, a factor of ten apart."""
    study = pl.Study(run=bead(), vary={"kernel.tension": ["1 mN/m", "10 mN/m", "100 mN/m"]})
    return pl.run_study(study, progress=False)


def test_for_print(tmp_path: Path) -> None:
    """A column of a journal wide, letters as asked for, text or paths, and colours of a style."""
    (tmp_path / "lab.mplstyle").write_text("axes.facecolor: ff0000\nfont.size: 20\n")
    style = {"width": "85 mm", "font_size": 9, "file": tmp_path / "lab.mplstyle"}
    figures = {"type": "curves", "formats": ["png", "svg"], "style": style}
    paths = {"type": "curves", "name": "paths", "formats": ["svg"], "style": {"svg_text": False}}
    pl.run(bead(outputs=[figures, paths]), directory=tmp_path, progress=False)
    image = pixels(tmp_path / "run-curves.png")
    assert image.shape[1] == pytest.approx(85 / 25.4 * 150, abs=1)
    assert (image == (1.0, 0.0, 0.0)).all(axis=-1).mean() > 0.2
    svg = (tmp_path / "run-curves.svg").read_text(encoding="utf-8")
    assert "font-size: 9px" in svg
    assert "depth [µm]" in svg
    assert "<text" not in (tmp_path / "run-paths.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize("content", [None, "font.size: large-ish\n", "\x80"])
def test_a_bad_style_file_is_named(content: str | None, tmp_path: Path) -> None:
    """A style file that does not exist, or has a bad value, is named."""
    file = tmp_path / "lab.mplstyle"
    if content is not None:
        file.write_text(content, encoding="latin-1")
    with pytest.raises(pl.ConfigError, match=r"lab\.mplstyle cannot be read as a style file"):
        save_figure(lambda figure: None, tmp_path / "a", ["png"], style=FigureStyle(file=file))


def test_legend_has_colours_and_markers_of_the_lines(table: Any) -> None:
    """Each curve of a study differs from the others by colour and by marker, as in the legend."""
    figure = Figure()
    draw(figure, study_curves(StoredRuns.of_study(table, Path()), "force"))
    (axes,) = figure.axes
    lines = [line for line in axes.lines if not str(line.get_label()).startswith("_")]
    legend = axes.get_legend()
    assert legend is not None
    samples = legend.get_lines()
    assert len(samples) == 3
    for line, sample in zip(lines, samples, strict=True):
        assert to_hex(sample.get_color()) == to_hex(line.get_color())
        assert sample.get_marker() == line.get_marker()
    assert len({to_hex(line.get_color()) for line in lines}) == 3
    assert len({line.get_marker() for line in lines}) == 3


def test_legends_leave_curves_free(tmp_path: Path) -> None:
    """A legend without a free corner stands beside the axes."""
    legends = []

    def fill(figure: Figure) -> None:
        axes = figure.add_subplot()
        x = np.linspace(0, 60, 4000)
        axes.plot(x, np.sin(x), label="a long name of a curve")
        legends.append((axes, axes.legend()))

    save_figure(fill, tmp_path / "a", ["png"])
    axes, legend = legends[0]
    assert legend.get_window_extent().x0 > axes.get_window_extent().x1


def test_no_contact_is_grey() -> None:
    """Cells without contact are not those of the lowest pressure."""
    figure = Figure()
    draw(figure, pressure_map(pl.run(bead(), progress=False)))
    axes = figure.axes[0]
    assert to_hex(axes.get_facecolor()) == to_hex("0.93")
    shown: Any = axes.images[0].get_array()
    assert np.ma.getmaskarray(shown).mean() > 0.3


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([1.0, 10.0, 100.0], True),
        ([1.0, 2.0, 5.0, 10.0], True),
        ([1.0, 2.0, 3.0, 4.0, 5.0], False),
        ([0.0, 1.0, 10.0], False),
        ([100.0, 101.0, 102.0], False),
        ([1.0, 100.0], False),
    ],
)
def test_log_spaced(values: list[float], expected: bool) -> None:
    """Values that grow by factors have a logarithmic axis."""
    assert is_log_spaced(np.array(values)) is expected


X: Any = np.array([0.0, 1.0, 2.0])


def drawn(shown: Chart | Fields) -> Any:
    """Return the axes of what is drawn."""
    figure = Figure()
    draw(figure, shown)
    return figure.axes


def test_panels_share_the_wider_range_and_have_legends() -> None:
    """Points of the lower panel beyond those of the upper are seen, and named."""
    series = [Series(X, X, legend="a"), Series(2 * X, X, legend="b", panel=1)]
    upper, lower = drawn(Chart(Axis("x"), [Axis("y"), Axis("z")], series))
    assert upper.get_xlim() == lower.get_xlim()
    assert lower.get_xlim()[1] >= 4
    names = [[text.get_text() for text in axes.get_legend().get_texts()] for axes in (upper, lower)]
    assert names == [["a"], ["b"]]


@pytest.mark.parametrize(("lowest", "is_left_out"), [(-1.0, True), (0.0, False)])
def test_a_logarithmic_axis_leaves_out_what_is_negative(lowest: float, is_left_out: bool) -> None:
    """Lines to negative values are left out, those to 0 end at the edge."""
    series = Series(X, np.array([1.0, lowest, 3.0]))
    (axes,) = drawn(Chart(Axis("x"), [Axis("y", log=True)], [series]))
    with np.errstate(divide="ignore", invalid="ignore"):
        (place,) = axes.yaxis.get_transform().transform(np.array([lowest]))
    assert np.isnan(place) or np.isneginf(place) if is_left_out else place < -100


def test_units_suit_whole_numbers_and_limits() -> None:
    """The prefix follows the values of any type, or the limits that are given."""
    assert Axis("depth", "m").scale([np.arange(5)]).unit == "m"
    assert Axis("depth", "m").scale([np.full(3, np.nan), 1e-6 * X]).unit == "µm"
    assert Axis("depth", "m", limits=(-3e-6, 1e-9)).scale([X]).unit == "µm"
    assert Axis("depth", "m", limits=(0.0, 2e-9)).scale([X]).unit == "nm"


def test_lines_and_maps_are_drawn_in_the_units_of_their_labels() -> None:
    """Micrometres along both sides, kilopascals in the colours: no factor of 1000 is lost."""
    (axes,) = drawn(Chart(Axis("x", "m"), [Axis("p", "Pa")], [Series(1e-6 * X, 1e3 * X)]))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [µm]", "p [kPa]")
    np.testing.assert_allclose(axes.lines[0].get_xydata(), np.stack([X, X], axis=1))
    panel = Panel((4e-6, 2e-6), 1e3 * np.arange(8.0).reshape(4, 2))
    axes = drawn(Fields(Axis("p", "Pa"), [panel]))[0]
    (bar,) = axes.child_axes
    (image,) = axes.images
    labels = axes.get_xlabel(), axes.get_ylabel(), bar.get_ylabel()
    assert labels == ("x [µm]", "y [µm]", "p [kPa]")
    np.testing.assert_allclose(image.get_extent(), [-2, 2, -1, 1])
    np.testing.assert_allclose(image.get_array(), np.arange(8.0).reshape(4, 2).T)


def test_numbers_are_those_drawn_and_further_columns_go_first(tmp_path: Path) -> None:
    """Bounds are columns unless the series says what they are; what guides the eye is left out."""
    given = Series(X, X, key="a", low=X - 1, high=X + 1, columns={"y_lowest": np.array([9, 9, 9])})
    guide = Series(X, X, written=False)
    bad = Series(X[:1], X[:1], key="b", converged=np.array([False]))
    chart = Chart(Axis("x", "m"), [Axis("y", "N")], [given, guide, bad])
    write_charts([("", chart)], tmp_path / "chart")
    table = rows(tmp_path / "chart.csv")
    assert [row["x [m]"] for row in table] == ["0.0", "1.0", "2.0", "0.0"]
    assert [row["y_lowest"] for row in table] == ["9", "9", "9", ""]
    assert [row["converged"] for row in table] == ["", "", "", "False"]


def test_a_table_before_a_chart_takes_the_place_of_its_numbers(tmp_path: Path) -> None:
    """Bytes are written as they are; two figures of one suffix are refused."""
    chart = Chart(Axis("x"), [Axis("y")], [Series(X, X)])
    own = Table([Column("a", [1, 2])])
    files = write_charts([("", own), ("", chart), (".txt", b"abc")], tmp_path / "own")
    assert [path.name for path in files] == ["own.csv", "own.png", "own.txt"]
    assert [row["a"] for row in rows(tmp_path / "own.csv")] == ["1", "2"]
    assert (tmp_path / "own.txt").read_bytes() == b"abc"
    with pytest.raises(pl.PluginError, match="two figures have the suffix ''"):
        write_charts([("", chart), ("", chart)], tmp_path / "twice")
