"""Figures of a population: quantities of each curve, and their distributions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Axis, Chart, Look, Series
from pellicle_fit.objective import MODULUS
from pellicle_fit.population.row import Row
from pellicle_fit.population.summary import label
from pellicle_fit.recipe import TENSION
from pellicle_fit.words.quantities import words

from .guides import guide

_DRAWN = {MODULUS: "Pa", TENSION: "N/m"}
_BARS = 200
"""Most curves whose intervals are drawn beside each other."""
_ENDS = "low", "high"
_OPEN_TOP = 1.1
"""Position of an open upper end, as a multiple of the largest value drawn."""
_BINS = 5, 40
"""Least and greatest number of bins."""
_GROUPS = 10
"""Number of groups with a colour of their own; the others share the last."""
_DECADE = 10.0
"""Greatest over least value beyond which an axis is logarithmic."""


def bars(rows: Sequence[Row]) -> list[Chart]:
    """Return modulus and tension of each curve with their intervals, if they were fitted.

    A bar with an open end reaches down to 0, or up to a triangle at the top.
    """
    series, axes = list[Series](), list[Axis]()
    for name, unit in _DRAWN.items():
        pairs = ((number, row.estimates.get(name)) for number, row in enumerate(rows, 1))
        fitted = [(float(number), e) for number, e in pairs if e is not None and not e.held]
        if not fitted:
            continue
        x, values = (np.array(of) for of in zip(*((n, e.value) for n, e in fitted), strict=True))
        # An open end is None, which becomes NaN.
        low, high = (np.array([getattr(e, end) for _, e in fitted], dtype=float) for end in _ENDS)
        opened, top = np.isnan(high), _OPEN_TOP * max(values.max(), np.nanmax([*high, 0.0]))
        high[opened] = top
        ends = np.column_stack([np.nan_to_num(low), high, np.full(x.size, np.nan)])
        panel = len(axes)
        series += [
            Series(np.repeat(x, 3), ends.ravel(), panel=panel),
            Series(x, values, look=Look(0, None, 0), panel=panel),
            Series(x[opened], high[opened], look=Look(0, None, 2), panel=panel),
        ]
        axes.append(Axis(words(name), unit, limits=(0, None)))
    across = Axis("curve, in the order of the table")
    return [Chart(across, axes, series)] if axes and len(rows) <= _BARS else []


def drawable(rows: Sequence[Row]) -> list[Row]:
    """Return the rows that are drawn: of accepted curves that have a closed interval."""
    return [row for row in rows if row.accepted and any(map(row.is_closed, _DRAWN))]


def distributions(rows: Sequence[Row]) -> list[Chart]:
    """Return histograms of E* and τ₀ of the drawable curves, by group, and E* against τ₀."""
    rows, charts = drawable(rows), list[Chart]()
    groups = list(dict.fromkeys(row.group for row in rows))
    kinds = np.array([min(groups.index(row.group), _GROUPS - 1) for row in rows])
    labels = [label(group) for group in groups[:_GROUPS]]
    if len(groups) > _GROUPS:
        labels[-1] = f"{len(groups) - _GROUPS + 1} other groups"
    closed = {name: np.array([row.is_closed(name) for row in rows]) for name in _DRAWN}
    for name, has in closed.items():
        if has.any():
            # One legend is enough.
            shown = labels if len(labels) > 1 and not charts else [""] * len(labels)
            charts.append(_histogram(name, _values(rows, name)[has], kinds[has], shown))
    if len(charts) == 2:
        charts.append(_scatter(rows, kinds, len(labels)))
    return charts


def _values(rows: Sequence[Row], name: str) -> Array:
    return np.array([row.estimates[name].value for row in rows])


def _axis(name: str, values: Array) -> Axis:
    is_wide = name == MODULUS and bool(values.max() > _DECADE * values.min())
    return Axis(words(name), _DRAWN[name], log=is_wide)


def _histogram(name: str, values: Array, kinds: Array, labels: Sequence[str]) -> Chart:
    """Return how many values lie in each bin, those of each kind on top of the others."""
    axis, low, high = _axis(name, values), float(values.min()), float(values.max())
    number = int(np.clip(np.sqrt(values.size) * 2, *_BINS)) + 1
    high = high if high > low else low + (abs(low) or 1.0)
    edges = np.geomspace(low, high, number) if axis.log else np.linspace(low, high, number)
    series, floor = list[Series](), np.zeros(2 * number)
    for kind, legend in enumerate(labels):
        counts, _ = np.histogram(values[kinds == kind], edges)
        top = floor + np.pad(np.repeat(counts, 2), 1)
        ends = {"low": floor, "high": top}
        series.append(Series(np.repeat(edges, 2), top, legend=legend, look=Look(kind), **ends))
        floor = top
    median = guide([float(np.median(values))] * 2, [0.0, floor.max()])
    # In the order of the stack, from the top, so that no outline hides one below it.
    return Chart(axis, [Axis("curves")], [*series[::-1], median], hues=len(labels))


def _scatter(rows: Sequence[Row], kinds: Array, count: int) -> Chart:
    """Return tension against modulus, with other marks where the modulus stands out."""
    modulus, tension = _values(rows, MODULUS), _values(rows, TENSION)
    outlier, series = np.array([row.outlier for row in rows]), []
    for marker, of in enumerate((~outlier, outlier)):
        for kind in range(count):
            shown = of & (kinds == kind)
            series.append(Series(modulus[shown], tension[shown], look=Look(kind, None, marker)))
    axes = _axis(MODULUS, modulus), [_axis(TENSION, tension)]
    return Chart(*axes, [one for one in series if one.x.size], hues=count)
