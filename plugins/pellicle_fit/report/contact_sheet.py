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
"""Most curves across and down a page."""
_LETTERS, _SIZE, _LARGEST = 38, 4.5, 9.0
"""Letters across a narrowest frame, their size, and the greatest size [pt]."""
_COLOURS = {"accepted": "0.6", "outlier": "C1", "rejected": "C3", "not fitted": "0.2"}
"""Colours of the frames."""
_DOTS: dict[str, Any] = {"color": "0.6", "mew": 0.35}


def sheets(rows: Sequence[Row], words: str = "") -> list[Callable[[Figure], None]]:
    """Return functions that draw the pages of the contact sheet of curves, which words tell."""
    count = -(-len(rows) // (_ACROSS * _DOWN))
    pages = [rows[k * len(rows) // count : (k + 1) * len(rows) // count] for k in range(count)]
    return [partial(_page, page, f"page {k} of {count}{words}") for k, page in enumerate(pages, 1)]


def choose_curves(rows: Sequence[Row], pages: int) -> tuple[Sequence[Row], str]:
    """Return the curves that so many pages show, and which these are; of all no words.

    Those that were not fitted, not accepted or stand out have half of the room.
    """
    room = pages * _ACROSS * _DOWN
    if len(rows) <= room:
        return rows, ""
    odd = [i for i, row in enumerate(rows) if row.outlier or not row.accepted]
    rest = [i for i, row in enumerate(rows) if row.accepted and not row.outlier]
    first = min(len(odd), max(room // 2, room - len(rest)))
    some = sorted([*_evenly(odd, first), *_evenly(rest, room - first)])
    words = f"; {room} of {len(rows)} curves: {first} of {len(odd)} that are not accepted or stand "
    return [rows[i] for i in some], f"{words}out, {room - first} of the others"


def _evenly(numbers: Sequence[int], count: int) -> list[int]:
    return [numbers[k * len(numbers) // count] for k in range(count)]


def grid(count: int) -> tuple[int, int]:
    """Return how many frames down and across fill a page: few are empty, and none is slim."""

    def cost(shape: tuple[int, int]) -> float:
        down, across = shape
        slim = PAGE[0] / across / (PAGE[1] / down) / (PAGE[0] / _ACROSS / (PAGE[1] / _DOWN))
        return abs(float(np.log(slim))) + (down * across - count) / count

    shapes = [(-(-count // across), across) for across in range(1, _ACROSS + 1)]
    return min((shape for shape in shapes if shape[0] <= _DOWN), key=cost)


def _page(rows: Sequence[Row], caption: str, figure: Figure) -> None:
    down, across = grid(len(rows))
    cells = figure.subplots(down, across, squeeze=False).ravel()
    for row, axes in zip(rows, cells, strict=False):
        _curve(row, axes, _ACROSS / across)
    for axes in cells[len(rows) :]:
        axes.set_axis_off()
    colours = "accepted: grey, stands out: orange, rejected: purple, not fitted: black"
    title = f"{caption}; data: points, hollow if not accepted; fit: line; frames of the range of "
    figure.suptitle(f"{title}each curve, {colours}", fontsize=5)


def _curve(row: Row, axes: Axes, width: float) -> None:
    """Draw a curve with its fit in a frame, with its name, its numbers and why it is rejected.

    The width is that of the frame over the narrowest.
    """
    size = min(_SIZE * width, _LARGEST)
    letters = int(_LETTERS * width * _SIZE / size)
    state = "accepted" if row.accepted else "rejected" if row.is_fitted else "not fitted"
    axes.spines[:].set_color(_COLOURS["outlier" if row.outlier else state])
    axes.set(xticks=[], yticks=[])
    texts = [row.name[-letters:], row.reason[:letters]]
    if row.is_fitted:
        shown = ((row.fit.estimates().get(name), symbol) for name, symbol in SHOWN.items())
        named = [
            f"{symbol} {in_figures(e)}" for e, symbol in shown if e and (e.value or not e.held)
        ]
        ratio = decimal(row.fit.data["chi_squared"] / row.fit.curve["points"], 3)
        texts[1:1] = [", ".join(named), f"R² {row.fit.data['r_squared']:.4f}, χ²/n {ratio}"]
    # A name may hold dollars, which are formulas to matplotlib.
    words = for_document("\n".join(filter(None, texts))).replace("$", r"\$")
    axes.set_title(words, loc="left", fontsize=size, in_layout=False)
    if row.sketch and row.sketch["position"].size:
        z, force = row.sketch["position"], row.sketch["force"]
        axes.plot(z, force, "o", mfc="0.6" if row.accepted else "none", ms=0.36 * size, **_DOTS)
        if "fit" in row.sketch:
            axes.plot(z, row.sketch["fit"], "C0", linewidth=0.7)
        ranges = readable(float(np.ptp(z)), "m", 3), readable(float(np.ptp(force)), "N", 3)
        inside: dict[str, Any] = {"transform": axes.transAxes, "va": "top", "color": "0.4"}
        axes.text(0.04, 0.95, "\n".join(ranges), fontsize=size, **inside)
