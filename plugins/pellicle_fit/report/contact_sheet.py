"""A contact sheet: a small chart of each curve with its fit, many on a page."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pellicle.components import Axis, Chart, Look, Series
from pellicle.units import decimal, readable
from pellicle_fit.population.row import Row
from pellicle_fit.wording import SHOWN

_ON_A_PAGE = 28
_LETTERS = 44
_COLUMNS = "position", "force"
_STATES = "accepted", "rejected", "stands out"


def sheets(rows: Sequence[Row]) -> list[Chart]:
    """Return the pages of the contact sheet of all curves, each frame over the range of its curve.

    Fits of curves that are rejected, or stand out, have other colours.
    """
    pages = [rows[start : start + _ON_A_PAGE] for start in range(0, len(rows), _ON_A_PAGE)]
    return [_page(page, f"page {number} of {len(pages)}") for number, page in enumerate(pages, 1)]


def _page(rows: Sequence[Row], title: str) -> Chart:
    nothing, data = np.empty(0), Look(None, None, 0)
    series, titles = [Series(nothing, nothing, legend="data", look=data)], []
    series += [Series(nothing, nothing, legend=s, look=Look(k)) for k, s in enumerate(_STATES)]
    for panel, row in enumerate(rows):
        position, force = row.sketch.get("position", nothing), row.sketch.get("force", nothing)
        spans: list[str] = []
        if position.size:
            length, most = float(np.ptp(position)) or 1.0, float(np.ptp(force)) or 1.0
            spans = [readable(length, "m", 3), readable(most, "N", 3)]
            looks = {"force": data, "fit": Look(2 * row.outlier if row.accepted else 1)}
            for name in looks.keys() & row.sketch.keys():
                x, y = (position - position.min()) / length, row.sketch[name] - force.min()
                series.append(Series(x, y / most, look=looks[name], panel=panel))
        lines = [row.name[-_LETTERS:], ", ".join(_numbers(row)), ", ".join(spans), row.reason]
        # A name may hold dollars, which are formulas to matplotlib.
        titles.append("\n".join(line[:_LETTERS].replace("$", r"\$") for line in lines))
    x_axis, y_axis = (Axis(f"{n}, over its range", limits=(-0.05, 1.05)) for n in _COLUMNS)
    return Chart(x_axis, [y_axis] * len(rows), series, title, hues=len(_STATES), titles=titles)


def _numbers(row: Row) -> list[str]:
    """Return what was fitted and the quality of the fit."""
    if not row.is_fitted:
        return []
    estimates = {symbol: row.estimates.get(name) for name, symbol in SHOWN.items()}
    texts = [
        f"{symbol} {readable(e.value, e.unit, 3)}"
        for symbol, e in estimates.items()
        if e is not None and not (e.held and not e.value)
    ]
    ratio = decimal(row.numbers["chi_squared"] / row.numbers["points"], 3)
    return [*texts, f"R² {row.numbers['r_squared']:.4f}", f"χ²/n {ratio}"]
