"""A contact sheet: a small figure of each curve with its fit, many on a page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.files import for_document
from pellicle.fitting.many import FITTED, ManyFits
from pellicle.fitting.population.judgement import Row
from pellicle.fitting.population.sketch import Sketch
from pellicle.report.plotting import save_pages
from pellicle.units import axis_unit, readable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

PAGE = 8.27, 11.69
"""Width and height of a page [inch]."""
_ACROSS, _DOWN = 4, 7
_LEFT, _RIGHT, _TOP, _BOTTOM = 0.06, 0.94, 0.27, 0.93
"""Edges of the frame of a curve in its cell, whose width and height are 1."""
_MARGIN = 0.06
"""Space between the frame and the data, relative to the frame."""
_LETTERS = 36
_WORDS = "accepted", "outlier", "rejected", "not fitted"
_COLOURS = dict(zip(_WORDS, ("0.6", "C1", "C3", "0.2"), strict=True))

LEGEND = (
    "Grey: data; blue: fit. Each frame spans the range of its curve, which is written in it. "
    "Frame grey: accepted; orange: its modulus stands out; red: rejected; black: not fitted."
)


def sheets(fits: ManyFits) -> list[Callable[[FigureBase], None]]:
    """Return functions that draw the pages of the contact sheet of all curves."""
    size = _ACROSS * _DOWN
    starts = range(0, len(fits.rows), size)
    pages = [range(start, min(start + size, len(fits.rows))) for start in starts]
    return [
        partial(_page, fits, rows, f"page {number} of {len(pages)}")
        for number, rows in enumerate(pages, 1)
    ]


def save_sheets(fits: ManyFits, path: Path) -> Path:
    """Write the contact sheet of all curves as a PDF file, and return it.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    return save_pages(sheets(fits), path, PAGE)


def _page(fits: ManyFits, numbers: Sequence[int], caption: str, figure: FigureBase) -> None:
    """Draw some curves on one page, in a single coordinate system for speed."""
    axes = figure.subplots()
    axes.set(xlim=(0, _ACROSS), ylim=(_DOWN, 0))
    axes.set_axis_off()
    axes.set_title(f"{caption}. {LEGEND}", fontsize=5)
    for cell, number in enumerate(numbers):
        row, column = divmod(cell, _ACROSS)
        _cell(axes, column, row, fits.rows[number], fits.sketches.get(number))


def _cell(axes: Axes, x: float, y: float, row: Row, sketch: Sketch | None) -> None:
    """Draw a curve, its name, its numbers, and why it is not accepted."""
    from matplotlib.patches import Rectangle

    colour = _COLOURS[_verdict(row)]
    size = _RIGHT - _LEFT, _BOTTOM - _TOP
    axes.add_patch(
        Rectangle((x + _LEFT, y + _TOP), *size, fill=False, edgecolor=colour, linewidth=0.9)
    )
    if sketch is not None and sketch.position.size:
        _curve(axes, x, y, sketch)
    lines = [
        (0.09, _shortened(str(row["curve"]), _LETTERS, end=False), "black"),
        (0.16, _numbers(row), "black"),
        (0.23, _shortened(str(row["reason"]), _LETTERS + 16, end=True), "C3"),
    ]
    for down, text, shade in lines:
        # A name may hold dollars, which are formulas to matplotlib.
        text = for_document(text).replace("$", r"\$")
        axes.text(x + _LEFT, y + down, text, fontsize=5, color=shade, va="baseline")


def _curve(axes: Axes, x: float, y: float, sketch: Sketch) -> None:
    """Draw data and fit of a curve in its frame."""
    forces = sketch.force if sketch.fit is None else np.append(sketch.force, sketch.fit)
    z, low = sketch.position, float(forces.min())
    width, height = float(np.ptp(z)) or 1.0, float(np.ptp(forces)) or 1.0
    scale = 1 - 2 * _MARGIN

    def across(values: Any) -> Any:
        share = _MARGIN + scale * (values - float(z.min())) / width
        return x + _LEFT + (_RIGHT - _LEFT) * share

    def down(values: Any) -> Any:
        return y + _BOTTOM - (_BOTTOM - _TOP) * (_MARGIN + scale * (values - low) / height)

    axes.plot(across(z), down(sketch.force), ".", color="0.6", markersize=1.5)
    if sketch.fit is not None:
        axes.plot(across(z), down(sketch.fit), "-", color="C0", linewidth=0.7)
    span = f"{readable(width, 'm', 3)}\n{readable(height, 'N', 3)}"
    corner = x + _LEFT + 0.03, y + _TOP + 0.03
    axes.text(*corner, span, fontsize=4.5, color="0.4", va="top", linespacing=1.2)


def _verdict(row: Row) -> str:
    if row["status"] != FITTED:
        return "not fitted"
    if not row["accepted"]:
        return "rejected"
    return "outlier" if row["outlier"] else "accepted"


def _numbers(row: Row) -> str:
    """Return modulus, tension and quality of a fit as a line."""
    texts = []
    for name, symbol in (("reduced_modulus", "E*"), ("tension", "τ₀"), ("work_of_adhesion", "W")):
        estimate: Mapping[str, Any] = row.get(name, {})
        if estimate and not (estimate["held"] and not estimate["value"]):
            factor, unit = axis_unit([estimate["value"]], estimate["unit"])
            texts.append(f"{symbol} {estimate['value'] * factor:.3g} {unit}")
    if "r_squared" in row:
        texts.append(f"R² {row['r_squared']:.4f}")
        texts.append(f"χ²/n {row['chi_squared'] / row['points']:.3g}")
    return ", ".join(texts)


def _shortened(text: str, most: int, *, end: bool) -> str:
    """Return the beginning of a text, or its end, with at most ``most`` letters."""
    if len(text) <= most:
        return text
    return f"{text[: most - 1]}…" if end else f"…{text[1 - most :]}"
