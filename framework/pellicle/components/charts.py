"""Figures and tables as data: what an output shows, before anything is drawn.

Numbers are in SI. `pellicle.show` draws them and writes them as CSV; a page and a notebook show the
same records.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle.analysis import Leg
from pellicle.arrays import Array, Cells, Mask
from pellicle.units import Scale, axis_unit, printed


def extent(values: Iterable[NDArray[Any]]) -> tuple[float, float]:
    """Return the lowest and the highest of the finite values, without a copy; 0 and 0 of none."""
    low, high = np.inf, -np.inf
    for array in values:
        array = array if array.dtype.kind == "f" else array.astype(float)
        finite = np.isfinite(array)
        low = float(np.min(array, where=finite, initial=low))
        high = float(np.max(array, where=finite, initial=high))
    return (low, high) if low <= high else (0.0, 0.0)


@dataclass(frozen=True)
class Axis:
    """What is shown along an axis."""

    words: str
    """Such as "contact radius"; the label adds the unit."""
    unit: str = "1"
    """SI unit; numbers are drawn with a prefix that suits all series of the axis."""
    as_given: bool = False
    """Whether ``words`` are the whole label, and numbers are drawn in SI."""
    log: bool = False
    limits: tuple[float | None, float | None] = (None, None)
    """Where it begins and ends [SI]; None is where the values do."""
    signed: bool = False
    """Whether values may have both signs, so that 0 is a line; along y only."""
    column: str = ""
    """Head of its column in a table; words and SI unit if empty."""

    def scale(self, values: Sequence[NDArray[Any]]) -> Scale:
        """Return the unit in which ``values`` [SI] are drawn, which suits an end that is given."""
        if self.as_given:
            return Scale(1.0, "")
        ends = [end for end in self.limits if end]
        return axis_unit(extent(values) if self.limits[1] is None else ends, self.unit)

    def label(self, scale: Scale) -> str:
        """Return the label of the axis for numbers in a scale."""
        return f"{self.words} [{scale.unit}]" if scale.unit else self.words

    @property
    def head(self) -> str:
        """The head of the column of its numbers in SI."""
        bare = self.as_given or self.unit == "1"
        return self.column or (self.words if bare else f"{self.words} [{printed(self.unit)}]")


class Look(NamedTuple):
    """The place of a series among those of its chart, of which colour, line and marker are made."""

    hue: int | None = 0
    """Number of the colour; None is grey, of a reference black."""
    line: int | None = 0
    """Number of the line style; None is no line."""
    marker: int | None = None
    """Number of the marker; None is none."""
    sparse: bool = False
    """Whether markers only help to tell smooth curves apart, and do not mark every point."""


@dataclass(frozen=True)
class Series:
    """Points of a chart, in SI, each array of shape (points,)."""

    x: Array
    y: Array
    """NaN is left out of the drawing."""
    key: str = ""
    """Column ``curve`` of its numbers."""
    name: str = ""
    """Column ``series`` of its numbers."""
    legend: str = ""
    """Name in the legend; without points a series is an entry of the legend alone."""
    look: Look = field(default_factory=Look)
    role: Literal["data", "reference", "published"] = "data"
    """A reference is a thin line behind the data; what is published is black, and given in the
    units that the axes show."""
    low: Array | None = None
    """Lower end of the range of each y: a band, or the bar of a single point."""
    high: Array | None = None
    """Upper end of the range of each y."""
    converged: Mask | None = None
    """Where the solver converged; other points are crossed out in red."""
    legs: Sequence[Leg] = ()
    """Legs of a path that are told apart: approach with open markers, retraction with filled."""
    columns: Mapping[str, NDArray[Any] | float | str] = field(default_factory=dict)
    """Further columns of its numbers."""
    steps: Cells | None = None
    """Index of the load step of each point, which a page marks."""
    panel: int = 0
    stepped: Literal["post", "mid"] | None = None
    """Whether y is constant up to the next x, or about each x, as in a cell."""
    written: bool = True
    """Whether its numbers are written; those of a line that guides the eye are not."""


def _drawn(shown: Chart | Fields) -> bytes:
    """Return the drawing as PNG, which a notebook shows."""
    from pellicle.show import png

    return png(shown)


@dataclass(frozen=True)
class Chart:
    """Numbers against numbers, in one panel or several above each other that share x."""

    x: Axis
    y: Sequence[Axis]
    """The axis of each panel, from the top."""
    series: Sequence[Series]
    title: str = ""
    note: str = ""
    """A warning in the chart."""
    hues: int = 1
    """Number of colours in use."""
    ordered: bool = False
    """Whether the colours stand for numbers to compare."""
    shaded: Sequence[tuple[float, float]] = ()
    """Ranges of x over which the ground is shaded."""
    heights: Sequence[float] = ()
    """Heights of the panels, relative to each other; all alike if empty."""
    titles: Sequence[str] = ()
    """Titles of the panels, if they are in a grid and share y, too."""

    _repr_png_ = _drawn


@dataclass(frozen=True)
class Panel:
    """A field over the domain, whose centre is the origin."""

    size: tuple[float, float]
    """Edge lengths of the domain along x and y [m]."""
    values: NDArray[Any]
    """In SI, or numbers of parts, shape (nx, ny)."""
    title: str = ""
    blank: Mask | None = None
    """Cells that stay empty, shape (nx, ny)."""
    outlines: Sequence[Mask] = ()
    """Parts that are enclosed, the first by a line, the second by dots, each shape (nx, ny)."""


@dataclass(frozen=True)
class Fields:
    """Maps of a field, with the same colours in all panels.

    Truth values are drawn black on grey; with ``parts`` values are numbers of parts, whose colours
    only tell neighbours apart.
    """

    axis: Axis
    panels: Sequence[Panel]
    title: str = ""
    centred: bool = False
    """Whether colours are centred at 0 where values are negative."""
    parts: bool = False

    _repr_png_ = _drawn


class Column(NamedTuple):
    """A column of a table."""

    head: str
    """With the unit of its numbers."""
    values: Sequence[object]


@dataclass(frozen=True)
class Table:
    """Columns of equal length."""

    columns: Sequence[Column]

    @classmethod
    def of_rows(cls, heads: Sequence[str], rows: Sequence[Sequence[object]]) -> Table:
        """Return a table, given its rows."""
        columns = zip(*rows, strict=True) if rows else [()] * len(heads)
        return cls([Column(head, values) for head, values in zip(heads, columns, strict=True)])


Shown = Chart | Fields | Table | Sequence[Chart | Fields] | bytes
"""What an output shows in one figure or file; charts and fields in a sequence are drawn side by
side."""
