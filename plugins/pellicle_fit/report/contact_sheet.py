"""A contact sheet: a small figure of each curve with its fit, many on a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pellicle.files import for_document
from pellicle.show import save_pages
from pellicle.units import decimal, readable
from pellicle_fit.population.row import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

PAGE = 8.27, 11.69
"""Width and height of a page [inch]."""
_ACROSS, _DOWN = 4, 7
_LETTERS = 38
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
    """Draw some curves on one page."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    axes = figure.subplots(_DOWN, _ACROSS).ravel()
    for row, cell in zip(rows, axes, strict=False):
        _curve(row, cell)
    for cell in axes[len(rows) :]:
        cell.set_axis_off()
    handles = (
        Line2D([], [], color="0.6", marker=".", linestyle="", label="data"),
        Line2D([], [], color="C0", label="fit"),
        *(Patch(facecolor="none", edgecolor=c, label=state) for state, c in _COLOURS.items()),
    )
    figure.legend(
        handles=handles,
        title=f"{caption}; each frame spans the range of its curve",
        loc="outside upper center",
        ncols=2 + len(_COLOURS),
        fontsize=5,
        title_fontsize=6,
    )


def _curve(row: Row, axes: Axes) -> None:
    """Draw a curve with its fit in a frame, with its name, its numbers and why it is rejected."""
    state = "not fitted" if not row.is_fitted else "accepted" if row.accepted else "rejected"
    axes.spines[:].set_color(_COLOURS["outlier" if row.outlier else state])
    axes.set(xticks=[], yticks=[])
    name = row.name if len(row.name) <= _LETTERS else f"…{row.name[1 - _LETTERS :]}"
    reason = row.reason if len(row.reason) <= _LETTERS else f"{row.reason[: _LETTERS - 1]}…"
    texts = ((1.20, name, "black"), (1.11, _numbers(row), "black"), (1.02, reason, "C3"))
    for up, text, colour in texts:
        # A name may hold dollars, which are formulas to matplotlib.
        words = for_document(text).replace("$", r"\$")
        axes.text(0, up, words, fontsize=4.5, color=colour, transform=axes.transAxes)
    if row.sketch is None or not row.sketch.position.size:
        return
    z, force, fit = row.sketch
    axes.plot(z, force, ".", color="0.6", markersize=1.5)
    if fit is not None:
        axes.plot(z, fit, "C0", linewidth=0.7)
    spans = f"{readable(float(np.ptp(z)), 'm', 3)}\n{readable(float(np.ptp(force)), 'N', 3)}"
    axes.text(0.04, 0.94, spans, fontsize=4.5, color="0.4", va="top", transform=axes.transAxes)


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
