"""Figures fit to print: axes, numbers, size, text, colours, legends and files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.components import Axis, Chart, Column, Series, Table
from pellicle.results import StoredRuns, is_log_spaced
from pellicle.show import draw, save_figure, write_charts
from pellicle.show.figure_style import FigureStyle
from pellicle_plugins.outputs.figures import study_curves
from pellicle_plugins.outputs.step_figures import pressure_map
from tests.pictures import pixels
from tests.plugins.outputs.shared import bead, rows


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


def drawn(chart: Chart) -> Any:
    """Return the axes of a drawn chart."""
    figure = Figure()
    draw(figure, chart)
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
