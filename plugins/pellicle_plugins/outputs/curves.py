"""Curves through the runs of a study."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from pellicle.analysis import Leg, extrapolate, legs
from pellicle.components import Axis, Chart, Look, Runs, Series, Shown
from pellicle.errors import ConfigError
from pellicle.results.path import has_interaction, has_path, has_times
from pellicle.schema.expression import names_in
from pellicle.schema.model import Model
from pellicle.show.style import is_log_spaced
from pellicle.units import printed
from pellicle.variables import FIELDS, WALL_PRESSURE
from pellicle_plugins.validation.reference import exact

from .base import (
    MOST_LEGS,
    Log,
    Reference,
    TableFigure,
    XLabel,
    YLabel,
    along,
    axis_of,
    in_words,
    label,
    one_axis,
)

if TYPE_CHECKING:
    import xarray as xr

_SPREADS = {"range": "range", "std": "± standard deviation", "sem": "± standard error"}
_GRIDS = 3
"""Fewest grids from which a limit follows."""


_Texts = Annotated[
    tuple[str, ...],
    BeforeValidator(
        lambda value: (value,) if isinstance(value, str) else value,
        json_schema_input_type=str | tuple[str, ...],
    ),
]
"""One text, or a list of them."""


class Published(Model):
    """Published points or a line, to compare with."""

    label: Annotated[str, Field(description="name in the legend")]
    x: Annotated[tuple[float, ...], Field(min_length=1, description="x in the unit of the axis")]
    y: Annotated[tuple[float, ...], Field(min_length=1, description="y in the unit of the axis")]
    style: Annotated[Literal["points", "line"], Field(description="how it is drawn")] = "points"

    @model_validator(mode="after")
    def _pairs(self) -> Self:
        if len(self.x) != len(self.y):
            raise ConfigError(f"{len(self.y)} values for {len(self.x)} of x; give as many", "y")
        return self


class Curves(TableFigure):
    """One number against another over the runs, one curve for each value of an axis.

    ``x`` and ``y`` are arithmetic over the columns of the table, the numbers of the configuration
    by their dotted path, and fields (``x``, ``y``, ``pressure``, ``displacement``, ``gap``,
    ``contact``) inside ``mean``, ``sum``, ``min`` or ``max`` over the cells. The numbers drawn are
    written as CSV beside the figure.

    Where there is an interaction, or steps have times, a curve over the steps distinguishes
    approach, open markers, and retraction, filled markers and short dashes; numbers of a whole
    path, such as ``pull_off`` or ``loss_stiffness``, make a curve over the runs.
    """

    type: Literal["curves"] = "curves"
    examples = (
        {"x": "depth / indenter.radius", "y": "contact_area", "reference": "axisymmetric"},
        {
            "x": "depth / indenter.radius",
            "y": ["contact_area", "contact_area_yastrebov"],
            "series": ["counted", "corrected"],
            "log": ["x"],
            "reference": "axisymmetric",
            "published": [{"label": "by hand", "x": [0.005], "y": [2e-08]}],
            "formats": ["png", "svg"],
        },
    )
    x_label: XLabel = None
    y_label: YLabel = None
    x: Annotated[str, Field(description="expression for the horizontal axis")] = "depth"
    y: Annotated[
        _Texts, Field(min_length=1, description="expression, or several, for the vertical axis")
    ] = ("force",)
    series: Annotated[
        tuple[str, ...], Field(description="name of each y in the legend; its expression if absent")
    ] = ()
    over: Annotated[
        str | None,
        Field(description="axis, such as indenter.seed, over which mean and spread are drawn"),
    ] = None
    spread: Annotated[
        Literal["range", "std", "sem"],
        Field(
            description="of the runs on `over`: lowest to highest, or the mean ± the standard "
            "deviation or the standard error of the mean"
        ),
    ] = "range"
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
        tuple[Published, ...], Field(description="published numbers: label, x, y, style")
    ] = ()

    @model_validator(mode="after")
    def _names_match(self) -> Self:
        if self.series and len(self.series) != len(self.y):
            raise ConfigError(
                f"{len(self.series)} names for {len(self.y)} of y; give as many", "series"
            )
        if self.by is not None and self.by == self.over:
            raise ConfigError(f"{self.over!r} is the axis of by already; give another", "over")
        return self

    def _with_by(self, table: xr.Dataset) -> Curves:
        """Return these curves with the axis that ``by`` is by default.

        It is the only long axis beside step, or step if ``x`` is that axis.
        """
        steps = self._over_steps(table)
        long = [
            str(dim)
            for dim, size in table.sizes.items()
            if size > 1 and dim != self.over and (steps or dim != "step")
        ]
        if self.by is not None or len(long) != 2 or (long[1] != "step" and steps):
            return self
        by = long[1] if long[0] in names_in(self.x) else long[0]
        return self.model_copy(update={"by": by})

    def compared(self, runs: Runs) -> Iterator[xr.Dataset]:
        """Yield all runs."""
        yield from (run for _, run in runs.datasets() if run is not None)

    def _over_steps(self, table: xr.Dataset) -> bool:
        """Return whether the expressions have a value for each step, not just one for each run."""
        if not has_path(table):
            return True
        used = set[str]().union(*(names_in(text) for text in (self.x, *self.y)))
        of_runs = {name for name in map(str, table.variables) if "step" not in table[name].dims}
        return bool(used & ({*map(str, table.variables), *FIELDS, WALL_PRESSURE} - of_runs))

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield the curves."""
        yield "", self._with_by(runs.table)._chart(runs)

    def _chart(self, runs: Runs) -> Chart:
        table = runs.table
        one_axis(table.sizes, self.by, "by")
        one_axis(table.sizes, self.over, "over")
        x, *ys = (runs.column(text) for text in (self.x, *self.y))
        along, log = self.x.strip(), self.log
        if "log" not in self.model_fields_set and along in table.sizes and along != "step":
            # An evenly growing axis of the study.
            values = table[along].values
            log = ("x",) if values.dtype.kind in "if" and is_log_spaced(values) else ()
        y_axis, names = self._y_axis(ys, table)
        series = [*self._series(runs, x, ys, names), *self._published()]
        if self.over is not None and any(one.low is not None for one in series):
            none = np.empty(0)
            band = Series(none, none, legend=_SPREADS[self.spread], low=none, high=none)
            series.append(replace(band, look=Look(None)))
        return Chart(
            replace(axis_of(self.x, self.x_label, table), log="x" in log, column="x"),
            [replace(y_axis, log="y" in log, column="y")],
            series,
            self.title,
            hues=table.sizes[self.by] if self.by else len(ys),
            ordered=self.is_ordered(runs),
        )

    def _y_axis(self, ys: Sequence[xr.DataArray], table: xr.Dataset) -> tuple[Axis, Sequence[str]]:
        """Return the vertical axis, and the name of each y.

        Several y have but a common unit. Without one they are in SI, with their units in the names.
        """
        # Only a bare variable has a unit.
        bare = (table.get(text.strip()) for text in self.y)
        units = ["1" if y is None else str(y.attrs.get("units", "1")) for y in bare]
        is_common, names = len(set(units)) == 1, list(self.series)
        if not names:
            for text, unit in zip(self.y, units, strict=True):
                head = "" if is_common or unit == "1" else f" [{printed(unit)}]"
                names.append(f"{in_words(text, table)}{head}")
        if len(ys) == 1 or self.y_label is not None:
            return axis_of(self.y[0], self.y_label, table), names
        words = ", ".join(names)
        has_unit = is_common and units[0] != "1"
        return Axis(words, units[0] if has_unit else "1", as_given=not has_unit), names

    def _series(
        self, runs: Runs, x: xr.DataArray, ys: Sequence[xr.DataArray], names: Sequence[str]
    ) -> Iterator[Series]:
        """Yield what is drawn, in order; entries that only the legend shows have no points.

        Colours and markers distinguish the values of `by`, line styles those of y. Beside a
        reference there are no lines, so that markers distinguish several y.
        """
        table = runs.table
        reference = exact(runs) if self.reference else None
        places = along(table, self.by)
        for number, (text, y) in enumerate(zip(self.y, ys, strict=True)):
            name = self.series[number] if self.series else text
            of_reference = [reference.column(t) for t in (self.x, text)] if reference else []
            line = None if reference else number
            for index, point in enumerate(places):
                part = table.isel(point)
                curve = label(self.label, part, self.by, table)
                legend = "" if number else curve.words
                if not self.by and (self.series or len(ys) > 1):
                    legend = names[number]
                marker = index if self.by and not (reference and len(ys) > 1) else number
                look = Look(index if self.by else number, line, marker)
                drawn = self._points(part, _at(x, point), _at(y, point))
                if number:
                    # Several bands could not be told apart.
                    drawn = replace(drawn, low=None, high=None)
                yield replace(drawn, key=curve.key, name=name, legend=legend, look=look)
                if self.extrapolate:
                    if (count := np.unique(_at(x, point)).size) < _GRIDS:
                        raise ConfigError(
                            f"{count} values of x on a curve do not fix a limit, a coefficient and "
                            f"an exponent; vary the grid over at least {_GRIDS}",
                            "extrapolate",
                        )
                    yield from self._limit(drawn, curve.key, name, look.hue)
                if reference:
                    points = self._points(part, *(_at(axis, point) for axis in of_reference))
                    order = np.argsort(points.x)
                    is_last = (number + 1, index + 1) == (len(ys), len(places))
                    yield Series(
                        points.x[order],
                        points.y[order],
                        key=curve.key,
                        name=f"{name}, semi-analytic",
                        legend="semi-analytic" if is_last else "",
                        look=Look(None),
                        role="reference",
                    )
            if self.by and len(ys) > 1:
                look = Look(None, line, number if reference else None)
                yield Series(np.empty(0), np.empty(0), legend=names[number], look=look)

    def _published(self) -> Iterator[Series]:
        for number, other in enumerate(self.published):
            look = Look(None, 0 if other.style == "line" else None, number)
            yield Series(
                np.array(other.x),
                np.array(other.y),
                key=other.label,
                name="published",
                legend=other.label,
                look=look,
                role="published",
            )

    def _limit(self, points: Series, key: str, name: str, hue: int | None) -> Iterator[Series]:
        """Yield a curve continued to x = 0, and its limit there with the error."""
        # An interrupted study may lack some of the grids.
        if np.unique(points.x).size < _GRIDS:
            return
        fit = extrapolate(points.x, points.y)
        x = np.linspace(0, float(points.x.max()), 200)
        y = np.append(fit.limit, fit(x[1:]))
        yield Series(x, y, look=Look(hue), role="reference", written=False)
        assert points.converged is not None
        yield Series(
            np.zeros(1),
            np.array([fit.limit]),
            key=key,
            name=f"{name}, extrapolated",
            look=Look(hue, None),
            low=np.array([fit.lowest]),
            high=np.array([fit.highest]),
            columns={"converged": bool(points.converged.all()), "exponent": fit.exponent},
        )

    def _points(self, table: xr.Dataset, x: xr.DataArray, y: xr.DataArray) -> Series:
        """Return the points of one curve, in the order of the table, with the legs of its path."""
        import xarray as xr

        converged = table["converged"]
        if has_path(table) and "step" not in (*x.dims, *y.dims):
            # Runs may have fewer steps than the table.
            converged = (converged | (table["status"] == "")).all("step")
        x, y, good = xr.broadcast(x, y, converged.astype(float))
        columns = [x, y, y, y, good.fillna(0.0), xr.ones_like(x)]
        if self.over is not None:
            finished = (x + y).notnull()
            x, y, good = (column.where(finished) for column in (x, y, good))
            middle = x.mean(self.over), y.mean(self.over)
            count = finished.sum(self.over)
            ends = y.min(self.over), y.max(self.over)
            if self.spread != "range":
                squares = ((y - middle[1]) ** 2).sum(self.over) / (count - 1).clip(min=1)
                half = (squares if self.spread == "std" else squares / count.clip(min=1)) ** 0.5
                ends = middle[1] - half, middle[1] + half
            columns = [*middle, *ends, good.min(self.over).fillna(0.0), count]
        long = [str(dim) for dim, size in columns[0].sizes.items() if size > 1]
        if len(long) > 1:
            raise ConfigError(
                f"each curve would go over {' and '.join(long)}; give one of them to by, or to "
                "over for mean and spread",
                "by",
            )
        values = np.array([column.values.ravel().astype(float) for column in columns])
        values = values[:, finite := np.isfinite(values).all(axis=0)]
        path: list[Leg] = []
        loops = has_interaction(table) or (has_times(table) and "time" not in names_in(self.x))
        if loops and long == ["step"] and self.over is None:
            path = legs(xr.broadcast(table["depth"], x)[0].values.ravel()[finite])
            # The many legs of an oscillation are not told apart by their style.
            path = path if has_interaction(table) or len(path) <= MOST_LEGS else []
        middle_x, middle_y, low, high, good, runs = values
        series = Series(middle_x, middle_y, converged=good == 1, legs=path)
        if not (runs > 1).any():
            return series
        spread = {"y_lowest": low, "y_highest": high, "runs": runs.astype(int)}
        written: dict[str, Any] = {
            name: np.where(runs > 1, column, None) for name, column in spread.items()
        }
        return replace(series, low=low, high=high, columns=written | {"spread": self.spread})


def _at(column: xr.DataArray, point: dict[str, int]) -> xr.DataArray:
    return column.isel({dim: index for dim, index in point.items() if dim in column.dims})
