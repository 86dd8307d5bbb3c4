"""Charts as they are drawn and written: axes, legends, numbers and files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.components import Axis, Chart, Column, Fields, Panel, Series, Table
from pellicle.show import draw, write_charts
from tests.plugins.outputs.shared import rows

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
