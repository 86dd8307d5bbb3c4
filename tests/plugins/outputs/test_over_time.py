"""Outputs of runs whose steps have times: curves over time, loops, the page, ParaView's time."""

import re
import xml.etree.ElementTree as Xml
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.results import StoredRuns
from pellicle.results.path import label_of_step
from pellicle.show import draw, figures
from pellicle_plugins.outputs import html_curves
from pellicle_plugins.outputs.figures import force_depth, over_time, study_curves
from pellicle_plugins.outputs.step_figures import profile
from tests.plugins.outputs.shared import bead
from tests.tables_of_runs import half_space, relaxing

LEGS = [
    {"to": "20 um", "time": "1 s", "num": 4},
    {"to": "18 um", "time": "0 s", "num": 1},
    {"to": "0 um", "time": "1 s", "num": 4},
]
RUN = bead(
    title="bead",
    grid={"points": 16, "size": "0.45 mm"},
    kernel=relaxing(half_space("10 kPa"), 0.8, "0.5 s"),
    loading={"depth": LEGS},
    outputs=[{"type": "html"}, {"type": "vtk"}],
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a bead pressed in, drawn back at once by a bit and then slowly."""
    folder = tmp_path_factory.mktemp("bead")
    result = pl.run(RUN, directory=folder, progress=False, threads=1)
    assert result.converged
    return folder


@pytest.fixture(scope="module")
def result(folder: Path) -> pl.Result:
    """Return the result of that run."""
    return pl.load(folder / "bead.h5")


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


def test_last_step_in_contact_is_drawn(folder: Path, result: pl.Result) -> None:
    """A path that ends out of contact shows the last step in contact, and says when it was."""
    last = int(np.flatnonzero(result.dataset["contact_area"].values)[-1])
    assert 4 < last < 8
    time = result.dataset["time"].values[last]
    assert f"{time:g} s, depth " in profile(result).title
    text = (folder / "bead.html").read_text(encoding="utf-8")
    (chosen,) = re.findall(r"<option value=\"(\d+)\" selected>", text)
    assert int(chosen) == last


def test_profile_is_of_the_step_of_the_map(
    folder: Path, result: pl.Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where few of the mapped steps have a profile, the step that is shown first has its own."""
    text = (folder / "bead.html").read_text(encoding="utf-8")
    (chosen,) = re.findall(r"<option value=\"(\d+)\" selected>", text)
    monkeypatch.setattr(html_curves, "_PROFILES", 5)
    steps = list(range(result.dataset.sizes["step"]))
    picture = html_curves.curves_of_run(result, steps, int(chosen))[0]
    assert len({id(part) for part in picture.by_frame}) == 4
    label = label_of_step(result.dataset, int(chosen))
    assert label in picture.caption
    assert picture.by_frame[int(chosen)].source == picture.source


def test_page_has_a_line_of_time(folder: Path) -> None:
    """The choice of steps says time and depth, and a slider goes through the steps."""
    text = (folder / "bead.html").read_text(encoding="utf-8")
    labels = re.findall(r"<option value=\"\d+\"[^>]*>([^<]*)</option>", text)
    assert labels[:2] == ["1: 250 ms, depth 5 µm", "2: 500 ms, depth 10 µm"]
    assert '<input type="range" min="0" max="8"' in text
    assert "Force, depth and contact area over time." in text


def test_paraview_has_the_time(folder: Path, result: pl.Result) -> None:
    """Timesteps are times; that after a jump is the next number, not the same."""
    listed = Xml.parse(folder / "bead.pvd").iter("DataSet")
    times = [float(entry.attrib["timestep"]) for entry in listed]
    np.testing.assert_allclose(times, result.dataset["time"], rtol=1e-15)
    assert (np.diff(times) > 0).all()
    assert times[3] == 1.0 == result.dataset["time"].values[4]


def test_study_is_drawn_over_time(tmp_path: Path) -> None:
    """Curves of a study of runs with times are over the time."""
    loading = {"depth": [{"to": "20 um", "time": 0, "num": 1}, {"hold": "2 s", "num": 3}]}
    study = pl.Study(
        run={**RUN, "loading": loading, "outputs": []},
        vary={"kernel.relaxation.0.time": ["0.5 s", "5 s"]},
    )
    table = pl.run_study(study, directory=tmp_path, progress=False)
    chart = study_curves(StoredRuns.of_study(table, Path()), "force")
    assert (chart.x.words, chart.x.unit) == ("time", "s")
    ends = {line.legend.rpartition(" relaxation 1 ")[2]: line.y for line in chart.series}
    assert ends["0.5 s"][-1] < ends["5 s"][-1]
