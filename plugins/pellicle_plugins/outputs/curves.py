"""Curves through the runs of a study."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from pellicle import hookimpl
from pellicle.analysis import Extrapolation, extrapolate
from pellicle.arrays import Array
from pellicle.components import Output, Place
from pellicle.errors import ConfigError
from pellicle.model.base import Model
from pellicle.model.expression import names_in
from pellicle.results.derived import Runs
from pellicle_plugins.analytic.reference import exact

from .base import (
    Graph,
    Log,
    Reference,
    along,
    label,
    one_axis,
    scaled,
    set_scales,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_MARKERS = "os^Dv<>P"
_LINES = ("-", "--", ":", "-.")
_GRIDS = 3


def _several(value: object) -> object:
    return (value,) if isinstance(value, str) else value


_Texts = Annotated[
    tuple[str, ...], BeforeValidator(_several, json_schema_input_type=str | tuple[str, ...])
]
"""One text, or a list of them."""


class Published(Model):
    """Points or a line of somebody else, to compare with."""

    label: Annotated[str, Field(description="its name in the legend")]
    x: Annotated[tuple[float, ...], Field(min_length=1, description="x as drawn")]
    y: Annotated[tuple[float, ...], Field(min_length=1, description="y as drawn")]
    style: Annotated[Literal["points", "line"], Field(description="how it is drawn")] = "points"

    @model_validator(mode="after")
    def _pairs(self) -> Self:
        if len(self.x) != len(self.y):
            raise ConfigError(f"{len(self.y)} values for {len(self.x)} of x; give as many", "y")
        return self


class Curves(Graph):
    """One number against another over the runs, one curve for each value of an axis.

    ``x`` and ``y`` are arithmetic over the columns of the table, the numbers of the configuration
    by their dotted path, and fields (``x``, ``y``, ``pressure``, ``displacement``, ``gap``,
    ``contact``) inside ``mean``, ``sum``, ``min`` or ``max`` over the cells. The numbers drawn are
    written as CSV beside the figure.
    """

    type: Literal["curves"] = "curves"
    x: Annotated[str, Field(description="expression for the horizontal axis")] = "depth"
    y: Annotated[
        _Texts, Field(min_length=1, description="expression, or several, for the vertical axis")
    ] = ("force",)
    series: Annotated[
        tuple[str, ...], Field(description="name of each y in the legend; its expression if absent")
    ] = ()
    over: Annotated[
        str | None,
        Field(description="axis, such as indenter.seed, over which mean and range are drawn"),
    ] = None
    log: Log = ()
    reference: Reference = None
    extrapolate: Annotated[
        bool,
        Field(
            description="continue each curve to x = 0 by a power law of fitted exponent: x is the "
            "cell size of nested grids, such as grid.size.0 / grid.points"
        ),
    ] = False
    published: Annotated[
        tuple[Published, ...], Field(description="numbers of others: label, x, y, style")
    ] = ()

    @model_validator(mode="after")
    def _names_match(self) -> Self:
        if self.series and len(self.series) != len(self.y):
            raise ConfigError(
                f"{len(self.series)} names for {len(self.y)} of y; give as many", "series"
            )
        if self.by is not None and self.by == self.over:
            raise ConfigError(f"{self.over!r} is by already; give another axis", "over")
        return self

    def study(self, place: Place, table: xr.Dataset) -> tuple[Path, ...]:
        """Draw the runs; by is, if absent, the only axis beside step, or step if x is that axis."""
        long = [str(dim) for dim, size in table.sizes.items() if size > 1 and dim != self.over]
        by = self.by
        if by is None and len(long) == 2 and long[1] == "step":
            by = "step" if long[0] in names_in(self.x) else long[0]
        return super(Curves, self.model_copy(update={"by": by})).study(place, table)

    def fill(self, axes: Axes, runs: Runs) -> Iterator[dict[str, object]]:
        """Draw, and yield the rows of the numbers drawn."""
        true = exact(runs) if self.reference else None
        table = runs.table
        for field, chosen in (("by", self.by), ("over", self.over)):
            one_axis(table.sizes, chosen, field)
        x = runs.column(self.x)
        factor_x, x_label = scaled(self.x, x, self.x_label)
        ys = [runs.column(text) for text in self.y]
        factor_y, y_label = scaled(self.y[0], ys[0], self.y_label)
        factors = factor_x, factor_y
        for number, (text, y) in enumerate(zip(self.y, ys, strict=True)):
            series = self.series[number] if self.series else text
            style = _Style(f"C{number}", number, true is not None)
            twin = (true.column(self.x), true.column(text)) if true else None
            for index, at in enumerate(along(table, self.by)):
                here = table.isel(at)
                name = label(self.label, here, self.by)
                if self.by:
                    style = replace(style, colour=f"C{index}")
                # Colours tell the values of by, markers the several y.
                said = "" if number else name
                if not self.by and (self.series or len(ys) > 1):
                    said = series
                curve = self._curve(here, _at(x, at), _at(y, at))
                curve.draw(axes, said, style, factors)
                head = {"curve": name, "series": series}
                yield from ({**head, **row} for row in curve.rows())
                if self.extrapolate:
                    _enough(_at(x, at))
                # An interrupted study may not have them all yet.
                if self.extrapolate and np.unique(curve.x).size >= _GRIDS:
                    limit = _Limit.of(curve)
                    limit.draw(axes, style, factors)
                    yield {**head, "series": f"{series}, extrapolated", **limit.row()}
                if twin is not None:
                    line = self._curve(here, _at(twin[0], at), _at(twin[1], at)).ordered()
                    line.draw(axes, "", _Style(style.colour, None), factors)
                    head["series"] += ", semi-analytic"
                    yield from ({**head, **row} for row in line.rows())
            if self.by and len(ys) > 1:
                _NOTHING.draw(axes, series, replace(style, colour="0.4"), factors)
        if true is not None:
            _NOTHING.draw(axes, "semi-analytic", _Style("0.4", None), factors)
        yield from self._draw_published(axes)
        y_label = y_label if len(ys) == 1 else self.y_label or ""
        axes.set(xlabel=x_label, ylabel=y_label, title=self.title)
        set_scales(axes, self.log)
        if axes.get_legend_handles_labels()[1]:
            axes.legend(frameon=False, fontsize="small")

    def _draw_published(self, axes: Axes) -> Iterator[dict[str, object]]:
        for number, other in enumerate(self.published):
            axes.plot(
                other.x,
                other.y,
                linestyle="-" if other.style == "line" else "none",
                marker="" if other.style == "line" else "*x+"[number % 3],
                color="black",
                markersize=9,
                zorder=5,
                label=other.label,
            )
            for x, y in zip(other.x, other.y, strict=True):
                yield {"curve": other.label, "series": "published", "x": x, "y": y}

    def _curve(self, table: xr.Dataset, x: xr.DataArray, y: xr.DataArray) -> _Curve:
        """Return the points of one curve, in the order of the table."""
        import xarray as xr

        x, y, good = xr.broadcast(x, y, table["converged"].astype(float))
        if self.over is not None:
            done = (x + y).notnull()
            x, y, good = (each.where(done) for each in (x, y, good))
            columns = [
                x.mean(self.over),
                y.mean(self.over),
                y.min(self.over),
                y.max(self.over),
                good.min(self.over).fillna(0.0),
                done.sum(self.over),
            ]
        else:
            columns = [x, y, y, y, good.fillna(0.0), xr.ones_like(x)]
        long = [str(dim) for dim, size in columns[0].sizes.items() if size > 1]
        if len(long) > 1:
            raise ConfigError(
                f"each curve would go over {' and '.join(long)}; give one of them to by, or to "
                "over for mean and range",
                "by",
            )
        values = [column.values.ravel().astype(float) for column in columns]
        return _Curve(*_finite(*values))


@dataclass(frozen=True)
class _Limit:
    """Where a curve goes as x goes to 0."""

    fit: Extrapolation
    reach: float
    """Largest x of the curve."""
    good: bool
    """Whether every run converged."""

    @classmethod
    def of(cls, curve: _Curve) -> _Limit:
        fit = extrapolate(curve.x, curve.y)
        return cls(fit, float(curve.x.max()), bool((curve.good == 1).all()))

    def draw(self, axes: Axes, style: _Style, factors: tuple[float, float]) -> None:
        x = np.linspace(0, self.reach, 200)
        y = np.append(self.fit.limit, self.fit(x[1:]))
        axes.plot(x * factors[0], y * factors[1], color=style.colour, linewidth=0.8, zorder=1)
        spread = [self.fit.limit - self.fit.lowest], [self.fit.highest - self.fit.limit]
        axes.errorbar(
            [0.0],
            [self.fit.limit * factors[1]],
            np.maximum(spread, 0.0) * factors[1],
            fmt="_",
            color=style.colour,
            markersize=12,
            linewidth=0.8,
            capsize=3,
            clip_on=False,
        )

    def row(self) -> dict[str, object]:
        return {
            "x": 0.0,
            "y": self.fit.limit,
            "y_lowest": self.fit.lowest,
            "y_highest": self.fit.highest,
            "converged": self.good,
            "exponent": self.fit.exponent,
        }


@dataclass(frozen=True)
class _Style:
    colour: str
    number: int | None
    """Which of the markers and line styles; None for a plain thin line."""
    scattered: bool = False
    """Whether markers alone are drawn, beside a line of something else."""

    def keywords(self) -> dict[str, Any]:
        """Return what ``Axes.plot`` takes."""
        if self.number is None:
            return {"color": self.colour, "linewidth": 1.0, "zorder": 1}
        return {
            "color": self.colour,
            "marker": _MARKERS[self.number % len(_MARKERS)],
            "linestyle": "none" if self.scattered else _LINES[self.number % len(_LINES)],
            "markersize": 4,
            "markerfacecolor": "white",
            "linewidth": 1.2,
        }


@dataclass(frozen=True)
class _Curve:
    x: Array
    y: Array
    low: Array
    high: Array
    good: Array
    """1 where every run converged."""
    runs: Array
    """How many runs each point is the mean of."""

    def ordered(self) -> _Curve:
        """Return the same points in the order of x."""
        order = np.argsort(self.x)
        return _Curve(*(getattr(self, one.name)[order] for one in fields(self)))

    def draw(self, axes: Axes, name: str, style: _Style, factors: tuple[float, float]) -> None:
        x, y = self.x * factors[0], self.y * factors[1]
        axes.plot(x, y, label=name or None, **style.keywords())
        if style.number is None:
            return
        bad = self.good < 1
        axes.plot(x[bad], y[bad], "x", color="red", markersize=9, label="_not converged")
        # The range of the first series only: bands upon bands cannot be read.
        if style.number == 0 and (self.runs > 1).any():
            low, high = self.low * factors[1], self.high * factors[1]
            axes.fill_between(x, low, high, color=style.colour, alpha=0.2, linewidth=0)

    def rows(self) -> Iterator[dict[str, object]]:
        for x, y, low, high, good, runs in zip(
            *(getattr(self, one.name) for one in fields(self)), strict=True
        ):
            row: dict[str, object] = {"x": x, "y": y}
            if runs > 1:
                row |= {"y_lowest": low, "y_highest": high, "runs": int(runs)}
            yield row | {"converged": bool(good)}


_NOTHING = _Curve(*[np.empty(0)] * 6)
"""For the legend."""


def _enough(x: xr.DataArray) -> None:
    """Refuse a curve over too few grids to be extrapolated."""
    if (count := np.unique(x).size) < _GRIDS:
        raise ConfigError(
            f"{count} values of x on a curve do not fix a limit, a coefficient and an exponent; "
            f"vary the grid over at least {_GRIDS}",
            "extrapolate",
        )


def _finite(*columns: Array) -> list[Array]:
    """Return the columns without the rows that have a NaN or an infinite value."""
    good = np.all([np.isfinite(column) for column in columns], axis=0)
    return [column[good] for column in columns]


def _at(column: xr.DataArray, at: dict[str, int]) -> xr.DataArray:
    return column.isel({dim: index for dim, index in at.items() if dim in column.dims})


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the curves."""
    register(Curves)
