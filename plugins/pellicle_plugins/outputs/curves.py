"""Curves through the runs of a study."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from pellicle.analysis import Leg, legs
from pellicle.components import Runs
from pellicle.errors import ConfigError
from pellicle.results.path import has_interaction, has_path, has_times
from pellicle.results.wording import wording
from pellicle.schema.expression import names_in
from pellicle.schema.model import Model
from pellicle.show.leg_styles import MOST_LEGS, RETRACTION
from pellicle.show.style import LINES, MARKERS, colour, is_log_spaced
from pellicle.units import printed
from pellicle.variables import FIELDS, WALL_PRESSURE
from pellicle_plugins.validation.reference import exact

from .base import (
    Log,
    Reference,
    XYFigure,
    add_legend,
    along,
    in_words,
    joined,
    label,
    one_axis,
    scaled,
    set_scales,
)
from .curve_lines import NO_POINTS, CurvePoints, Limit, Line, line_style

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_GRIDS = 3
"""Fewest grids from which a limit follows."""
_LETTERS = 50
"""Letters of a line of the label of an axis."""
_EXACT = {"color": "black", "linewidth": 1.0, "zorder": 1}
"""Style of a reference."""


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
    x: Annotated[tuple[float, ...], Field(min_length=1, description="x as drawn")]
    y: Annotated[tuple[float, ...], Field(min_length=1, description="y as drawn")]
    style: Annotated[Literal["points", "line"], Field(description="how it is drawn")] = "points"

    @model_validator(mode="after")
    def _pairs(self) -> Self:
        if len(self.x) != len(self.y):
            raise ConfigError(f"{len(self.y)} values for {len(self.x)} of x; give as many", "y")
        return self


class Curves(XYFigure):
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

    def draw(self, axes: Axes, runs: Runs) -> Iterator[dict[str, object]]:
        """Draw the curves, and yield the rows of the numbers drawn."""
        yield from self._with_by(runs.table)._drawn(axes, runs)

    def _drawn(self, axes: Axes, runs: Runs) -> Iterator[dict[str, object]]:
        one_axis(runs.table.sizes, self.by, "by")
        one_axis(runs.table.sizes, self.over, "over")
        x, *ys = (runs.column(text) for text in (self.x, *self.y))
        factor_x, x_label = scaled(self.x, [x], self.x_label, runs.table)
        factor_y, y_label, named = self._scaled_y(ys, runs.table)
        lines = list(self._lines(runs, x, ys, named))
        axis, log = self.x.strip(), self.log
        if "log" not in self.model_fields_set and axis in runs.table.sizes and axis != "step":
            # An evenly growing axis of the study.
            values = runs.table[axis].values
            log = ("x",) if values.dtype.kind in "if" and is_log_spaced(values) else ()
        for line in lines:
            line.draw(axes, factor_x, factor_y, bool(self.log))
        published: list[dict[str, object]] = []
        for number, other in enumerate(self.published):
            style = "-" if other.style == "line" else "*x+"[number % 3]
            axes.plot(
                other.x, other.y, style, color="black", markersize=9, zorder=5, label=other.label
            )
            published += [
                {"curve": other.label, "series": "published", "x": x, "y": y}
                for x, y in zip(other.x, other.y, strict=True)
            ]
        axes.set(xlabel=x_label, ylabel=y_label, title=self.title)
        set_scales(axes, log, signed=has_interaction(runs.table))
        add_legend(axes)
        for line in lines:
            yield from line.rows()
        yield from published

    def _scaled_y(
        self, ys: Sequence[xr.DataArray], table: xr.Dataset
    ) -> tuple[float, str, Sequence[str]]:
        """Return the factor and the label of the vertical axis, and the name of each y.

        Several y have but a common unit. Without one they are in SI, with their units in the names.
        """
        # Only a bare variable has a unit.
        bare = (table.get(text.strip()) for text in self.y)
        units = ["1" if y is None else y.attrs.get("units", "1") for y in bare]
        is_common, names = len(set(units)) == 1, list(self.series)
        if not names:
            for text, unit in zip(self.y, units, strict=True):
                head = "" if is_common or unit == "1" else f" [{printed(unit)}]"
                names.append(f"{in_words(text, table)}{head}")
        if len(ys) == 1 or self.y_label is not None:
            return *scaled(self.y[0], ys, self.y_label, table), names
        label = textwrap.fill(", ".join(names), _LETTERS)
        if not is_common or units[0] == "1":
            return 1.0, label, names
        scale = wording(joined("", ys)).scale
        return scale.factor, f"{label} [{scale.unit}]", names

    def _lines(
        self, runs: Runs, x: xr.DataArray, ys: Sequence[xr.DataArray], names: Sequence[str]
    ) -> Iterator[Line | Limit]:
        """Yield what is drawn, in order; entries that only the legend shows have no points."""
        reference = exact(runs) if self.reference else None
        directions: set[str] = set()
        many = runs.table.sizes[self.by] if self.by else 1
        for number, (text, y) in enumerate(zip(self.y, ys, strict=True)):
            series = self.series[number] if self.series else text
            named = names[number]
            of_reference = [reference.column(t) for t in (self.x, text)] if reference else []
            for index, point in enumerate(along(runs.table, self.by)):
                part = runs.table.isel(point)
                name = label(self.label, part, self.by, runs.table)
                style = self._style(runs, number, index)
                legend = "" if number else name.words
                if not self.by and (self.series or len(ys) > 1):
                    legend = named
                points, path = self._points(part, _at(x, point), _at(y, point))
                directions |= {leg.direction for leg in path}
                yield Line(points, style, legend, number, name.key, series, path)
                if self.extrapolate:
                    if (count := np.unique(_at(x, point)).size) < _GRIDS:
                        raise ConfigError(
                            f"{count} values of x on a curve do not fix a limit, a coefficient and "
                            f"an exponent; vary the grid over at least {_GRIDS}",
                            "extrapolate",
                        )
                    # An interrupted study may lack some of them.
                    if np.unique(points.x).size >= _GRIDS:
                        yield Limit(points, style["color"], name.key, f"{series}, extrapolated")
                if reference:
                    points, _ = self._points(part, *(_at(axis, point) for axis in of_reference))
                    curve, of = name.key, f"{series}, semi-analytic"
                    yield Line(points.ordered(), _EXACT, "", curve=curve, series=of)
            if self.by and len(ys) > 1:
                marker = MARKERS[number % len(MARKERS)] if reference else ""
                line = "none" if reference else LINES[number % len(LINES)]
                yield Line(NO_POINTS, line_style("0.4", line, marker), named)
        if reference:
            yield Line(NO_POINTS, _EXACT, "semi-analytic")
        if len(directions) > 1:
            shared = "0.4" if max(many, len(ys)) > 1 else "C0"
            yield Line(NO_POINTS, line_style(shared, LINES[0], MARKERS[0]), "approach")
            yield Line(NO_POINTS, line_style(shared, RETRACTION, MARKERS[0]), "retraction")

    def _style(self, runs: Runs, number: int, index: int) -> dict[str, Any]:
        """Return the style of a curve: y of this number, and value of `by` of this index.

        Colours and markers distinguish the values of `by`, line styles those of y. Beside a
        reference there are no lines, so that markers distinguish several y.
        """
        if not self.by:
            hue, mark = colour(number, len(self.y)), number
        else:
            hue = colour(index, runs.table.sizes[self.by], ordered=self.is_ordered(runs))
            mark = number if self.reference and len(self.y) > 1 else index
        line = "none" if self.reference else LINES[number % len(LINES)]
        return line_style(hue, line, MARKERS[mark % len(MARKERS)])

    def _points(
        self, table: xr.Dataset, x: xr.DataArray, y: xr.DataArray
    ) -> tuple[CurvePoints, list[Leg]]:
        """Return the points of one curve, in the order of the table, and the legs of its path."""
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
            ends = y.min(self.over), y.max(self.over)
            columns = [*middle, *ends, good.min(self.over).fillna(0.0), finished.sum(self.over)]
        long = [str(dim) for dim, size in columns[0].sizes.items() if size > 1]
        if len(long) > 1:
            raise ConfigError(
                f"each curve would go over {' and '.join(long)}; give one of them to by, or to "
                "over for mean and range",
                "by",
            )
        values = np.array([column.values.ravel().astype(float) for column in columns])
        finite = np.isfinite(values).all(axis=0)
        path: list[Leg] = []
        loops = has_interaction(table) or (has_times(table) and "time" not in names_in(self.x))
        if loops and long == ["step"] and self.over is None:
            path = legs(xr.broadcast(table["depth"], x)[0].values.ravel()[finite])
            # The many legs of an oscillation are not told apart by their style.
            path = path if has_interaction(table) or len(path) <= MOST_LEGS else []
        return CurvePoints(*values[:, finite]), path


def _at(column: xr.DataArray, point: dict[str, int]) -> xr.DataArray:
    return column.isel({dim: index for dim, index in point.items() if dim in column.dims})
