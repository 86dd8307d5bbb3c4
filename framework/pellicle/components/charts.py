"""Figures and tables as data: what an output shows, before anything is drawn.

Numbers are in SI. `pellicle.show` draws them and writes them as CSV; a page and a notebook show the
same records.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Real
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle.analysis import Leg
from pellicle.arrays import Array, Cells, Mask
from pellicle.units import DIGITS, NOTHING, Scale, axis_unit, format_unit

_SI_DIGITS = 6


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
    """The quantity along an axis, and how it is drawn."""

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
        return self.column or (self.words if bare else f"{self.words} [{format_unit(self.unit)}]")


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
    filled: bool | None = None
    """Whether markers are filled; if None those of many points without a line are."""


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
    from pellicle.show.notebook import png

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


@dataclass(frozen=True)
class Column:
    """A column of a table, or another list of values."""

    words: str
    """Its head, to which a table for people adds the unit, such as "contact radius"."""
    values: Sequence[object] | NDArray[Any]
    """Numbers in SI, NaN where there is none, or texts."""
    unit: str = ""
    """SI unit of its numbers; people read all of them with one prefix."""
    meaning: str = ""
    """Shown on a page while the pointer rests on the head."""
    name: str = ""
    """Its name in files; the words if empty."""
    digits: int = DIGITS
    """Significant digits that people read."""
    texts: Mapping[str, str] = field(default_factory=dict)
    """Words for values that are texts, such as types of components."""
    bad: Sequence[bool] = ()
    """Whether a page marks each cell, as one not to be relied on."""
    frames: Sequence[int | None] = ()
    """The frame of the first maps of a page that a click on each cell shows, if any."""

    @property
    def head(self) -> str:
        """The head of the column in files: name and SI unit."""
        unit = "" if self.unit in ("", "1") else f" [{self.unit}]"
        return f"{self.name or self.words}{unit}"

    @cached_property
    def scale(self) -> Scale:
        """The unit in which people read the numbers, which the largest of them gives."""
        values: Any = self.values
        if not isinstance(values, np.ndarray):
            values = [value for value in values if isinstance(value, Real)]
        return axis_unit(values, self.unit)

    def number(self, value: object, *, si: bool = False) -> str:
        """Return a value in SI as people read it, without the unit."""
        if isinstance(value, str):
            return self.texts.get(value, value)
        scale, digits = self.unit_and_digits(si=si)
        return scale.number(value, digits)

    def text(self, value: object) -> str:
        """Return words, value and unit: "surface tension 30 mN/m"."""
        number = self.number(value)
        return f"{self.words} {number if number == NOTHING else self.scale.with_unit(number)}"

    @property
    def listing(self) -> str:
        """The values as people read them in a row, with the unit; of many, some are left out."""
        return self.scale.listing([self.number(value) for value in self._listed])

    def unit_and_digits(self, *, si: bool = False) -> tuple[Scale, int]:
        """Return how people read the numbers; with ``si`` without a prefix and with six digits."""
        if si:
            return Scale(1.0, "" if self.unit == "1" else format_unit(self.unit)), _SI_DIGITS
        return self.scale, self.digits

    def read(self, *, si: bool = False) -> tuple[str, list[str]]:
        """Return the head and the cells as people read them."""
        unit = self.unit_and_digits(si=si)[0].unit
        head = f"{self.words} [{unit}]" if unit else self.words
        return head, [self.number(value, si=si) for value in self._listed]

    @property
    def _listed(self) -> Sequence[object]:
        values = self.values
        return values.tolist() if isinstance(values, np.ndarray) else values


@dataclass(frozen=True)
class Table:
    """Columns of equal length."""

    columns: Sequence[Column]
    caption: str = ""
    """A sentence on a page."""
    folded: bool = False
    """Whether a page shows only the caption until a click on it."""

    @classmethod
    def of_rows(
        cls,
        heads: Sequence[str],
        rows: Sequence[Sequence[object]],
        caption: str = "",
        *,
        folded: bool = False,
    ) -> Table:
        """Return a table, given its rows."""
        columns = zip(*rows, strict=True) if rows else [()] * len(heads)
        named = [Column(head, values) for head, values in zip(heads, columns, strict=True)]
        return cls(named, caption, folded)

    @property
    def records(self) -> list[dict[str, object]]:
        """The values of each row by the names of their columns, in SI."""
        names = [column.name or column.words for column in self.columns]
        rows = zip(*(column.values for column in self.columns), strict=True)
        return [dict(zip(names, row, strict=True)) for row in rows]


Shown = Chart | Fields | Table | Sequence[Chart | Fields] | bytes
"""The content of one figure or file of an output; charts and fields in a sequence are drawn side by
side."""
