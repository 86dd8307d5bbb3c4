"""Figures fit to print: size, text, colours and legends."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.results import StoredRuns, is_log_spaced
from pellicle.show import draw, save_figure
from pellicle.show.figure_style import FigureStyle
from pellicle_plugins.outputs.figures import study_curves
from pellicle_plugins.outputs.step_figures import pressure_map
from tests.pictures import pixels
from tests.plugins.outputs.shared import bead


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
