"""Figures fit to print: size, text, colours and legends."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.report.fields import pressure_map
from pellicle.report.lines import edge_cells
from pellicle.report.plotting import study_curves
from pellicle.report.saving import save_figure
from pellicle.report.style import OKABE_ITO, FigureStyle, colour, is_log_spaced
from tests.pictures import pixels

RUN: dict[str, Any] = {
    "title": "Print",
    "grid": {"points": 32, "size": "0.4 mm"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "10 mN/m"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": ["5 um", "10 um"]},
}
DPI = 150


@pytest.fixture(scope="module")
def table() -> Any:
    """Return the table of a study of three tensions, a factor of ten apart."""
    study = pl.Study(run=RUN, vary={"kernel.tension": ["1 mN/m", "10 mN/m", "100 mN/m"]})
    return pl.run_study(study, progress=False)


def _written(folder: Path, **style: Any) -> Path:
    outputs = [{"type": "figures", "formats": ["png", "svg"], "style": style}]
    pl.run({**RUN, "outputs": outputs}, directory=folder, progress=False)
    return folder / "print-force_depth.png"


def _texts(path: Path) -> list[str]:
    return [text for text in ET.parse(path).getroot().itertext() if text.strip()]


@pytest.mark.parametrize("width", [85, 170])
def test_width(width: int, tmp_path: Path) -> None:
    """A figure has the width of a column of a journal, text as text, and smaller letters."""
    path = _written(tmp_path, width=f"{width} mm")
    assert pixels(path).shape[1] == pytest.approx(width / 25.4 * DPI, abs=1)
    svg = path.with_suffix(".svg")
    assert "depth [µm]" in _texts(svg)
    assert "font-size: 8px" in svg.read_text(encoding="utf-8")


def test_paths_in_svg(tmp_path: Path) -> None:
    """Text becomes paths where it is not to depend on the fonts of the reader."""
    svg = _written(tmp_path, svg_text=False).with_suffix(".svg")
    assert "<text" not in svg.read_text(encoding="utf-8")


def test_style_file(tmp_path: Path) -> None:
    """A style file of matplotlib applies; width and font size go before it."""
    file = tmp_path / "lab.mplstyle"
    file.write_text("axes.facecolor: ff0000\nfont.size: 20\n")
    path = _written(tmp_path, file=file, font_size=9)
    assert (pixels(path) == (1.0, 0.0, 0.0)).all(axis=-1).mean() > 0.2
    assert "font-size: 9px" in path.with_suffix(".svg").read_text(encoding="utf-8")


@pytest.mark.parametrize("content", [None, "font.size: large-ish\n", "\x80"])
def test_a_bad_style_file_is_named(content: str | None, tmp_path: Path) -> None:
    """A style file that does not exist, or has a bad value, is named."""
    file = tmp_path / "lab.mplstyle"
    if content is not None:
        file.write_text(content, encoding="latin-1")
    with pytest.raises(pl.ConfigError, match=r"lab\.mplstyle cannot be read as a style file"):
        save_figure(lambda figure: None, tmp_path / "a", ["png"], style=FigureStyle(file=file))


@pytest.mark.parametrize("width", [85, "85", "0 mm", "3 N"])
def test_bad_widths(width: object) -> None:
    """Bare numbers are metres, of which no page has 85."""
    output = {"type": "figures", "style": {"width": width}}
    with pytest.raises(pl.ConfigError, match=r"style\.width"):
        pl.Run(**RUN, outputs=[output])


def test_colours_of_ordered_values_get_lighter() -> None:
    """In grey too, each curve is lighter than the one before; other values have the cycle."""
    with FigureStyle().applied():
        greys = [
            np.dot(to_rgb(colour(k, 6, ordered=True)), (0.299, 0.587, 0.114)) for k in range(6)
        ]
        assert (np.diff(greys) > 0.05).all()
        assert [to_hex(colour(k, 7)).upper() for k in range(7)] == list(OKABE_ITO)
    assert mpl.rcParams["axes.prop_cycle"].by_key()["color"][0] != OKABE_ITO[0]


def test_legend_has_colours_and_markers_of_the_lines(table: Any) -> None:
    """Each curve of a study differs from the others by colour and by marker, as in the legend."""
    axes = Figure().add_subplot()
    study_curves(table, axes, "force")
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

    def draw(figure: Figure) -> None:
        axes = figure.add_subplot()
        x = np.linspace(0, 60, 4000)
        axes.plot(x, np.sin(x), label="a long name of a curve")
        legends.append((axes, axes.legend(), figure))

    save_figure(draw, tmp_path / "a", ["png"])
    axes, legend, _ = legends[0]
    assert legend.get_window_extent().x0 > axes.get_window_extent().x1


def test_no_contact_is_grey_and_the_bar_is_as_high_as_the_map() -> None:
    """Cells without contact are not those of the lowest pressure."""
    figure = Figure(layout="constrained")
    axes = figure.add_subplot()
    pressure_map(pl.run(RUN, progress=False), axes)
    figure.draw_without_rendering()
    assert to_hex(axes.get_facecolor()) == to_hex("0.93")
    shown: Any = axes.images[0].get_array()
    assert np.ma.getmaskarray(shown).mean() > 0.3
    (bar,) = axes.child_axes
    assert bar.get_window_extent().height == pytest.approx(axes.get_window_extent().height)


def test_edge_cells() -> None:
    """The cells at both ends of one resolved contact, and none of several or of a coarse one."""
    contact = np.zeros(64, dtype=bool)
    contact[10:40] = True
    assert [*np.flatnonzero(edge_cells(contact))] == [10, 11, 12, 37, 38, 39]
    contact[20] = False
    assert not edge_cells(contact).any()
    assert not edge_cells(np.arange(64) < 10).any()
    assert not edge_cells(np.ones(64, dtype=bool)).any()


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
