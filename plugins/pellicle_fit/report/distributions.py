"""Histograms of modulus and tension of a population, and one against the other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.arrays import Array
from pellicle.units import axis_unit
from pellicle_fit.objective import MODULUS
from pellicle_fit.population.row import Row
from pellicle_fit.population.summary import label
from pellicle_fit.recipe import TENSION
from pellicle_fit.wording import words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

SIZE = 11.0, 3.6
_DRAWN = MODULUS, TENSION
_BINS = 5, 40
"""Least and greatest number of bins."""
_GROUPS = 10
"""Number of groups with a colour and a line of their own; the others share the last."""
_DECADE = 10.0
"""Greatest over least value beyond which an axis is logarithmic."""
_RASTERISED = 1000
"""Number of points beyond which they are drawn as pixels in vector figures."""


def drawable(rows: Sequence[Row]) -> list[Row]:
    """Return the rows that are drawn: of accepted curves that have a closed interval."""
    return [row for row in rows if row.accepted and any(row.is_closed(n) for n in _DRAWN)]


def distributions(rows: Sequence[Row], figure: FigureBase) -> None:
    """Draw histograms of log E* and τ₀ of the accepted curves, by group, and E* against τ₀."""
    rows = drawable(rows)
    groups = [row.group for row in rows]
    names = list(dict.fromkeys(groups))
    kinds = np.array([min(names.index(group), _GROUPS - 1) for group in groups])
    labels = [label(name) for name in names[:_GROUPS]]
    if len(names) > _GROUPS:
        labels[-1] = f"{len(names) - _GROUPS + 1} other groups"
    fitted = [name for name in _DRAWN if any(row.is_closed(name) for row in rows)]
    columns = figure.subplots(1, len(fitted) + (len(fitted) == 2), squeeze=False)[0]
    for name, axes in zip(fitted, columns, strict=False):
        closed = [row.is_closed(name) for row in rows]
        _histogram(axes, list(compress(rows, closed)), name, kinds[closed], labels)
    if len(fitted) == 2:
        _scatter(columns[-1], rows, kinds)
    if len(labels) > 1:
        handles, names = columns[0].get_legend_handles_labels()
        # Inside the axes it would lie on bars, and beside them on the next axes.
        figure.legend(handles, names, loc="outside upper center", ncols=_GROUPS, fontsize="small")


def _values(rows: Sequence[Row], name: str) -> tuple[Array, str]:
    """Return values of a quantity in a unit that brings them near 1, and the axis label."""
    estimates = [row.estimates[name] for row in rows]
    values = np.array([estimate.value for estimate in estimates])
    scale, unit = axis_unit([np.median(values)], estimates[0].unit)
    return values * scale, f"{words(name)} [{unit}]"


def _histogram(
    axes: Axes, rows: Sequence[Row], name: str, kinds: Array, labels: Sequence[str]
) -> None:
    from matplotlib.ticker import MaxNLocator

    values, head = _values(rows, name)
    low, high = float(values.min()), float(values.max())
    number = int(np.clip(np.sqrt(values.size) * 2, *_BINS))
    if name == MODULUS and high > _DECADE * low:
        bins = np.geomspace(low, high, number + 1)
        _logarithmic(axes)
    else:
        bins = np.linspace(low, high if high > low else low + (abs(low) or 1.0), number + 1)
    parts = [values[kinds == kind] for kind in range(len(labels))]
    axes.hist(parts, bins.tolist(), stacked=True, label=labels, edgecolor="white", linewidth=0.3)
    axes.axvline(float(np.median(values)), color="0.2", linewidth=1, linestyle="--")
    axes.set(xlabel=head, ylabel="curves")
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))


def _scatter(axes: Axes, rows: Sequence[Row], kinds: Array) -> None:
    tension, tension_label = _values(rows, TENSION)
    modulus, modulus_label = _values(rows, MODULUS)
    outlier = np.array([row.outlier for row in rows])
    style: dict[str, Any] = {"markersize": 3, "alpha": 0.7, "rasterized": len(rows) > _RASTERISED}
    for kind in np.unique(kinds).tolist():
        chosen = kinds == kind
        axes.plot(modulus[chosen], tension[chosen], "o", color=f"C{kind}", **style)
    axes.plot(modulus[outlier], tension[outlier], "o", mfc="none", mec="C3", markersize=8)
    axes.set(xlabel=modulus_label, ylabel=tension_label)
    if modulus.max() > _DECADE * modulus.min():
        _logarithmic(axes)
    axes.grid(alpha=0.3)


def _logarithmic(axes: Axes) -> None:
    """Make the horizontal axis logarithmic, with plain numbers."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
