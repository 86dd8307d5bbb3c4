"""Curves through the runs of a study."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from math import prod
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pellicle.arrays import DataArray, Dataset
from pellicle.components import Axis, Chart, Look, Runs, Series, Shown
from pellicle.errors import ConfigError
from pellicle.results import has_path, is_log_spaced, is_ordered
from pellicle.schema import Model, names_in
from pellicle.show import in_words
from pellicle.units import format_unit, readable
from pellicle.variables import FIELDS, WALL_PRESSURE
from pellicle_plugins.validation.reference import exact

from .base import (
    Label,
    Log,
    Reference,
    TableFigure,
    Texts,
    XLabel,
    YLabel,
    along,
    axis_of,
    label,
    require_axes,
)
from .curve_points import limit_of, points_of

_SPREADS = {"range": "range", "std": "± standard deviation", "sem": "± standard error"}
MOST_PANELS = 12
_NONE = np.empty(0)


class PublishedCurve(Model):
    """Published points or a line, to compare with."""

    label: str = Field(description="name in the legend")
    x: tuple[float, ...] = Field(min_length=1, description="x in the unit of the axis")
    y: tuple[float, ...] = Field(min_length=1, description="y in the unit of the axis")
    style: Literal["points", "line"] = Field("points", description="how it is drawn")

    @model_validator(mode="after")
    def _pairs(self) -> Self:
        if len(self.x) != len(self.y):
            raise ConfigError(f"{len(self.y)} values for {len(self.x)} of x; give as many", "y")
        return self


class Curves(TableFigure):
    """One number against another over the runs, one curve for each value of an axis.

    Colours distinguish the values of the first axis of `by`, markers and line styles those of the
    second. Each value of the axes that are left, if there are any, has a panel; `where` chooses a
    value instead.

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
    x: str = Field("depth", description="expression for the horizontal axis")
    y: Annotated[
        Texts, Field(min_length=1, description="expression, or several, for the vertical axis")
    ] = ("force",)
    series: tuple[str, ...] = Field(
        (), description="name of each y in the legend; its expression if absent"
    )
    over: str | None = Field(
        None, description="axis, such as indenter.seed, over which mean and spread are drawn"
    )
    spread: Literal["range", "std", "sem"] = Field(
        "range",
        description="of the runs on `over`: lowest to highest, or the mean ± the standard "
        "deviation or the standard error of the mean",
    )
    log: Log = ()
    reference: Reference = None
    extrapolate: bool = Field(
        False,
        description="continue each curve to x = 0 by a power law of fitted exponent: x is the "
        "cell size of nested grids, such as grid.size.0 / grid.points",
    )
    published: tuple[PublishedCurve, ...] = Field(
        (), description="published numbers: label, x, y, style"
    )

    @model_validator(mode="after")
    def _names_match(self) -> Self:
        if self.series and len(self.series) != len(self.y):
            raise ConfigError(
                f"{len(self.series)} names for {len(self.y)} of y; give as many", "series"
            )
        if self.over in self.by:
            raise ConfigError(f"{self.over!r} is the axis of by already; give another", "over")
        most = 1 if self.reference and len(self.y) > 1 else 2
        if len(self.by) > most:
            raise ConfigError(
                f"a curve tells {len(self.by)} axes apart by its colour and marker; give {most}"
                f"{', since markers tell several y apart' if most == 1 else ''}: the values of "
                "others have panels",
                "by",
            )
        return self

    def _axes_told(self, table: Dataset) -> tuple[Sequence[str], Sequence[str]]:
        """Return the axes of which each value has curves, and those of which each has a panel.

        Each curve goes along an axis that ``x`` names, else along the steps, else along the last.
        Without `by`, the first of the others has curves.
        """
        steps, taken = self._over_steps(table), {self.over, *self.by}
        long = [
            str(dim)
            for dim, size in table.sizes.items()
            if size > 1 and dim not in taken and (steps or dim != "step")
        ]
        used = {
            dim for name in names_in(self.x) if name in table.coords for dim in table[name].dims
        }
        goes_along = [
            *(d for d in long if d in used),
            *(d for d in long if d == "step"),
            *long[-1:],
        ]
        rest = [dim for dim in long if dim not in goes_along[:1]]
        return (self.by, rest) if self.by else (rest[:1], rest[1:])

    def _over_steps(self, table: Dataset) -> bool:
        """Return whether the expressions have a value for each step, not just one for each run."""
        if not has_path(table):
            return True
        used = set[str]().union(*(names_in(text) for text in (self.x, *self.y)))
        of_runs = {name for name in map(str, table.variables) if "step" not in table[name].dims}
        return bool(used & ({*map(str, table.variables), *FIELDS, WALL_PRESSURE} - of_runs))

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield the curves."""
        runs = self.selected_runs(runs)
        table = runs.table
        require_axes(table.sizes, self.by, "by")
        require_axes(table.sizes, [self.over] if self.over else [], "over")
        if self.over == "step" and not self._over_steps(table):
            raise ConfigError("x and y have one value for each run, and none for each step", "over")
        by, panels = self._axes_told(table)
        count = prod(table.sizes[dim] for dim in panels)
        if count > MOST_PANELS:
            first = table[panels[-1]]
            value = readable(first.values.tolist()[0], str(first.attrs.get("units", "1")))
            raise ConfigError(
                f"{' and '.join(panels)} would make {count} panels, and at most {MOST_PANELS} are "
                f'legible; choose values, such as {{ "{panels[-1]}" = "{value}" }}',
                "where",
            )
        x, *ys = (runs.column(text) for text in (self.x, *self.y))
        along_x, log = self.x.strip(), self.log
        if "log" not in self.model_fields_set and along_x in table.sizes and along_x != "step":
            # An evenly growing axis of the study.
            values = table[along_x].values
            log = ("x",) if values.dtype.kind in "if" and is_log_spaced(values) else ()
        y_axis, names = self._y_axis(ys, table)
        series = list(self._series(runs, [x, *ys], names, by, panels))
        series += self._legend(table, names, by)
        series += [published for panel in range(count) for published in self._published(panel)]
        if self.over is not None and any(published.low is not None for published in series):
            band = Series(_NONE, _NONE, legend=_SPREADS[self.spread], low=_NONE, high=_NONE)
            series.append(replace(band, look=Look(None)))
        titles = [label(None, table.isel(cell), panels, table) for cell in along(table, panels)]
        chart = Chart(
            replace(axis_of(self.x, self.x_label, table), log="x" in log, column="x"),
            [replace(y_axis, log="y" in log, column="y")] * count,
            series,
            self.title,
            hues=table.sizes[by[0]] if by else len(ys),
            ordered=is_ordered(table, by[0] if by else None),
            titles=[title.words.replace(", ", "\n") for title in titles] if panels else (),
        )
        yield "", chart

    def _y_axis(self, ys: Sequence[DataArray], table: Dataset) -> tuple[Axis, Sequence[str]]:
        """Return the vertical axis, and the name of each y.

        Several y have but a common unit. Without one they are in SI, with their units in the names.
        """
        # Only a bare variable has a unit.
        bare = (table.get(text.strip()) for text in self.y)
        units = ["1" if y is None else str(y.attrs.get("units", "1")) for y in bare]
        is_common, names = len(set(units)) == 1, list(self.series)
        if not names:
            for text, unit in zip(self.y, units, strict=True):
                head = "" if is_common or unit == "1" else f" [{format_unit(unit)}]"
                names.append(f"{in_words(text, table)}{head}")
        if len(ys) == 1 or self.y_label is not None:
            return axis_of(self.y[0], self.y_label, table), names
        words = ", ".join(names)
        has_unit = is_common and units[0] != "1"
        return Axis(words, units[0] if has_unit else "1", as_given=not has_unit), names

    def _series(
        self,
        runs: Runs,
        columns: Sequence[DataArray],
        names: Sequence[str],
        by: Sequence[str],
        panels: Sequence[str],
    ) -> Iterator[Series]:
        """Yield the curves of x and each y, each with its limit and its reference."""
        table, (x, *ys) = runs.table, columns
        over_time = "time" in names_in(self.x)
        points_at = partial(points_of, over=self.over, spread=self.spread, over_time=over_time)
        reference = exact(runs) if self.reference else None
        of_reference = []
        for field, text in [("x", self.x), *(("y", text) for text in self.y)]:
            try:
                of_reference += [reference.column(text)] if reference else []
            except ConfigError as error:
                message = f"{text!r} has no value in the semi-analytic solution: {error}"
                raise ConfigError(message, field) from None
        for (number, y), (panel, cell), place in product(
            enumerate(ys), enumerate(along(table, panels)), along(table, by)
        ):
            point, name = cell | place, self.series[number] if self.series else self.y[number]
            part, curve = table.isel(point), self._curve(table, point, by, panels)
            shown: dict[str, Any] = {"key": curve.key, "panel": panel}
            look = self._look(number, list(place.values()))
            # Names of the first curve with each colour; `_legend` has the rest.
            legend = "" if number or panel or any([*place.values()][1:]) else curve.words
            if not by and (len(ys) > 1 or self.series):
                legend = names[number]
            points = points_at(part, _at(x, point), _at(y, point))
            if number:
                # Several bands could not be told apart.
                points = replace(points, low=None, high=None)
            yield replace(points, **shown, name=name, legend=legend, look=look)
            if self.extrapolate:
                for limit in limit_of(_at(x, point), points, name, look.hue):
                    yield replace(limit, **shown)
            if reference:
                at_point = (_at(of_reference[index], point) for index in (0, number + 1))
                points = points_at(part, *at_point)
                order = np.argsort(points.x)
                points = Series(points.x[order], points.y[order], look=Look(None), role="reference")
                yield replace(points, **shown, name=f"{name}, semi-analytic")

    def _look(self, number: int, place: Sequence[int]) -> Look:
        """Return the look of a curve of the y of a number, given its indices along the axes of by.

        Colours and markers distinguish the values of an axis, line styles those of y. A second axis
        has the markers, and of one y the line styles. Beside a reference there are no lines, so
        that markers distinguish several y.
        """
        many = len(self.y) > 1
        if len(place) > 1:
            line = number if many else place[1]
            return Look(place[0], None if self.reference else line, place[1])
        hue = place[0] if place else number
        marker = number if self.reference and many else hue
        return Look(hue, None if self.reference else number, marker)

    def _curve(
        self, table: Dataset, point: dict[str, int], by: Sequence[str], panels: Sequence[str]
    ) -> Label:
        """Return the words for the colour of a curve, and its key."""
        if not by:
            return label(self.label, table.isel(point), (), table)
        name = label(self.label, table.isel({by[0]: point[by[0]]}), by[:1], table)
        if others := [*by[1:], *panels]:
            legend_of_others = label(None, table.isel(point), others, table)
            name = Label(name.words, f"{name.key}, {legend_of_others.key}")
        return name

    def _legend(self, table: Dataset, names: Sequence[str], by: Sequence[str]) -> Iterator[Series]:
        """Yield entries that only the legend shows: several y, a second axis, the reference."""
        looks = {}
        if by and len(names) > 1:
            looks = {name: self._look(number, [0]) for number, name in enumerate(names)}
            if not self.reference:
                looks = {name: look._replace(marker=None) for name, look in looks.items()}
        for number, place in enumerate(along(table, by[1:]) if len(by) > 1 else ()):
            words = label(None, table.isel(place), by[1:], table).words
            looks[words] = self._look(0, [0, number])
        for words, look in looks.items():
            yield Series(_NONE, _NONE, legend=words, look=look._replace(hue=None))
        if self.reference:
            yield Series(_NONE, _NONE, legend="semi-analytic", look=Look(None), role="reference")

    def _published(self, panel: int) -> Iterator[Series]:
        for number, table in enumerate(self.published):
            look = Look(None, 0 if table.style == "line" else None, number)
            yield Series(
                np.array(table.x),
                np.array(table.y),
                key=table.label,
                name="published",
                legend=table.label,
                look=look,
                role="published",
                panel=panel,
                written=not panel,
            )


def _at(column: DataArray, point: dict[str, int]) -> DataArray:
    return column.isel({dim: index for dim, index in point.items() if dim in column.dims})
