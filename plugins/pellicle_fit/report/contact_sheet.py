"""A contact sheet: a small figure of each curve with its fit, many on a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.files import for_document
from pellicle.units import decimal, readable
from pellicle_fit.population.row import SHOWN, Row
from pellicle_fit.words.names import in_figures

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PAGE = 8.27, 11.69
"""Width and height of a page [inch]."""
_ACROSS, _DOWN = 4, 7
_LETTERS = 38
_COLOURS = {"accepted": "0.6", "outlier": "C1", "rejected": "C3", "not fitted": "0.2"}
"""Colours of the frames."""
_DOTS: dict[str, Any] = {"color": "0.6", "ms": 1.6, "mew": 0.35}


def sheets(rows: Sequence[Row]) -> list[Callable[[Figure], None]]:
    """Return functions that draw the pages of the contact sheet of all curves."""
    size = _ACROSS * _DOWN
    pages = [rows[start : start + size] for start in range(0, len(rows), size)]
    return [partial(_page, page, f"page {k} of {len(pages)}") for k, page in enumerate(pages, 1)]


def _page(rows: Sequence[Row], caption: str, figure: Figure) -> None:
    cells = figure.subplots(_DOWN, _ACROSS).ravel()
    for row, axes in zip(rows, cells, strict=False):
        _curve(row, axes)
    for axes in cells[len(rows) :]:
        axes.set_axis_off()
    colours = "accepted: grey, stands out: orange, rejected: red, not fitted: black"
    title = f"{caption}; data: points, hollow if not accepted; fit: line; frames of the range of "
    figure.suptitle(f"{title}each curve, {colours}", fontsize=5)


def _curve(row: Row, axes: Axes) -> None:
    """Draw a curve with its fit in a frame, with its name, its numbers and why it is rejected."""
    state = "accepted" if row.accepted else "rejected" if row.is_fitted else "not fitted"
    axes.spines[:].set_color(_COLOURS["outlier" if row.outlier else state])
    axes.set(xticks=[], yticks=[])
    texts = [row.name[-_LETTERS:], row.reason[:_LETTERS]]
    if row.is_fitted:
        shown = ((row.estimates.get(name), symbol) for name, symbol in SHOWN.items())
        named = [
            f"{symbol} {in_figures(e)}" for e, symbol in shown if e and (e.value or not e.held)
        ]
        ratio = decimal(row.fit["chi_squared"] / row.curve["points"], 3)
        texts[1:1] = [", ".join(named), f"R² {row.fit['r_squared']:.4f}, χ²/n {ratio}"]
    # A name may hold dollars, which are formulas to matplotlib.
    words = for_document("\n".join(filter(None, texts))).replace("$", r"\$")
    axes.set_title(words, loc="left", fontsize=4.5, in_layout=False)
    if row.sketch and row.sketch["position"].size:
        z, force = row.sketch["position"], row.sketch["force"]
        axes.plot(z, force, "o", mfc="0.6" if row.accepted else "none", **_DOTS)
        if "fit" in row.sketch:
            axes.plot(z, row.sketch["fit"], "C0", linewidth=0.7)
        ranges = readable(float(np.ptp(z)), "m", 3), readable(float(np.ptp(force)), "N", 3)
        inside: dict[str, Any] = {"transform": axes.transAxes, "va": "top", "color": "0.4"}
        axes.text(0.04, 0.95, "\n".join(ranges), fontsize=4.5, **inside)
