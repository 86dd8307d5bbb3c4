"""A contact sheet: a small figure of each curve with its fit, many on a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array
from pellicle.files import for_document
from pellicle.show import save_pages
from pellicle.units import decimal, readable
from pellicle_fit.population.row import Row, Sketch

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

PAGE = 8.27, 11.69
"""Width and height of a page [inch]."""
_ACROSS, _DOWN = 4, 7
_LEFT, _RIGHT, _TOP, _BOTTOM = 0.06, 0.94, 0.27, 0.93
"""Edges of the frame of a curve in its cell, whose width and height are 1."""
_MARGIN = 0.06
"""Space between the frame and the data, relative to the frame."""
_LETTERS = 36
_COLOURS = {"accepted": "0.6", "outlier": "C1", "rejected": "C3", "not fitted": "0.2"}
"""Colours of the frames."""


def sheets(rows: Sequence[Row]) -> list[Callable[[FigureBase], None]]:
    """Return functions that draw the pages of the contact sheet of all curves."""
    size = _ACROSS * _DOWN
    pages = [rows[start : start + size] for start in range(0, len(rows), size)]
    return [
        partial(_page, page, f"page {number} of {len(pages)}")
        for number, page in enumerate(pages, 1)
    ]


def save_sheets(rows: Sequence[Row], path: Path) -> Path:
    """Write the contact sheet of all curves as a PDF file, and return it.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    return save_pages(sheets(rows), path, PAGE)


def _page(rows: Sequence[Row], caption: str, figure: FigureBase) -> None:
    """Draw some curves on one page.

    All are in one coordinate system and few artists, a tenth of the time of axes for each.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

    axes = figure.subplots()
    axes.set(xlim=(0, _ACROSS), ylim=(_DOWN, 0))
    axes.set_axis_off()
    axes.set_title(f"{caption}; each frame spans the range of its curve", fontsize=6, pad=14)
    frames, colours, points, lines = [], [], [], []
    for cell, row in enumerate(rows):
        y, x = divmod(cell, _ACROSS)
        sketch = row.sketch
        left, right, top, bottom = x + _LEFT, x + _RIGHT, y + _TOP, y + _BOTTOM
        frames.append([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)])
        colours.append(_COLOURS[_state(row)])
        texts = [
            (0.09, 5.0, _shortened(row.name, _LETTERS, end=False), "black"),
            (0.16, 5.0, _numbers(row), "black"),
            (0.23, 5.0, _shortened(row.reason, _LETTERS + 16, end=True), "C3"),
        ]
        if sketch is not None and sketch.position.size:
            data, fit, span = _curve(x, y, sketch)
            points.append(data)
            lines += [] if fit is None else [fit]
            texts += [(_TOP + 0.07 + 0.06 * n, 4.5, t, "0.4") for n, t in enumerate(span)]
        for down, size, text, shade in texts:
            if text:
                # A name may hold dollars, which are formulas to matplotlib.
                words = for_document(text).replace("$", r"\$")
                shift = 0.03 if shade == "0.4" else 0.0
                place = left + shift, y + down
                axes.text(*place, words, fontsize=size, color=shade).set_in_layout(False)
    axes.add_collection(LineCollection(frames, colors=colours, linewidths=0.9))
    if points:
        axes.plot(*np.concatenate(points).T, ".", color="0.6", markersize=1.5)
    axes.add_collection(LineCollection(lines, colors="C0", linewidths=0.7))
    axes.legend(
        handles=[
            Line2D([], [], color="0.6", marker=".", linestyle="", label="data"),
            Line2D([], [], color="C0", label="fit"),
            *(
                Line2D(
                    [], [], color=c, marker="s", mfc="none", linestyle="", label=f"frame: {state}"
                )
                for state, c in _COLOURS.items()
            ),
        ],
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=2 + len(_COLOURS),
        fontsize=5,
        frameon=False,
    )


def _curve(x: float, y: float, sketch: Sketch) -> tuple[Array, Array | None, list[str]]:
    """Return data and fit of a curve in its frame, and the ranges of position and force."""
    forces = sketch.force if sketch.fit is None else np.append(sketch.force, sketch.fit)
    z, low = sketch.position, float(forces.min())
    width, height = float(np.ptp(z)), float(np.ptp(forces))
    inner = 1 - 2 * _MARGIN
    across = x + _LEFT + (_RIGHT - _LEFT) * (_MARGIN + inner * (z - z.min()) / (width or 1.0))

    def placed(force: Array) -> Array:
        share = _MARGIN + inner * (force - low) / (height or 1.0)
        return np.column_stack([across, y + _BOTTOM - (_BOTTOM - _TOP) * share])

    fit = None if sketch.fit is None else placed(sketch.fit)
    return placed(sketch.force), fit, [readable(width, "m", 3), readable(height, "N", 3)]


def _state(row: Row) -> str:
    if not row.is_fitted:
        return "not fitted"
    if not row.accepted:
        return "rejected"
    return "outlier" if row.outlier else "accepted"


def _numbers(row: Row) -> str:
    """Return modulus, tension and quality of a fit as a line."""
    texts = []
    for name, symbol in (("reduced_modulus", "E*"), ("tension", "τ₀"), ("work_of_adhesion", "W")):
        estimate = row.estimates.get(name)
        if estimate is not None and not (estimate.held and not estimate.value):
            texts.append(f"{symbol} {readable(estimate.value, estimate.unit, 3)}")
    if row.is_fitted:
        numbers = row.numbers
        texts.append(f"R² {numbers['r_squared']:.4f}")
        texts.append(f"χ²/n {decimal(numbers['chi_squared'] / numbers['points'], 3)}")
    return ", ".join(texts)


def _shortened(text: str, most: int, *, end: bool) -> str:
    """Return the beginning of a text, or its end, with at most ``most`` letters."""
    if len(text) <= most:
        return text
    return f"{text[: most - 1]}…" if end else f"…{text[1 - most :]}"
