"""Charts and fields drawn by matplotlib."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.components.charts import Axis, Chart, Fields, Panel, Series, extent
from pellicle.units import Scale, axis_unit

from .figure_style import LINES, MARKERS, NO_CONTACT, colour

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

SIZE = 5.4, 4.2
"""Width and height of a chart or of a map [inch]."""
DIVERGING = "RdBu_r"
"""The colours of fields that are negative where an interaction pulls."""
_RETRACTION = (0, (2.5, 1.2))
_GREY, _PALE = "0.4", "0.6"
_MOST_MARKED = 80
"""Points that all have a marker; of more on a line, some have, at a distance, others are dots."""
_DOT = 2.5
"""Size of markers that are dots."""
_MARKER_DISTANCE, _SPARSE_DISTANCE = 0.04, 0.12
"""Over the diagonal of the axes; the latter on a smooth curve."""
_LETTERS = 50
"""Letters of a line of the label of an axis."""
_NOT_CONVERGED = "not converged"
_MAP, _ACROSS = 2.7, 4
_PARTS = 20


class PlacedSeries(NamedTuple):
    """Where a series was drawn."""

    axes: Axes
    series: Series
    points: Array
    """In the units of the axes, shape (points, 2)."""


def size_of(shown: Chart | Fields) -> tuple[float, float]:
    """Return width and height [inch] for a chart or for fields."""
    count = len(shown.panels if isinstance(shown, Fields) else shown.titles)
    if count > 1:
        across, down = _arrangement(count)
        return _MAP * across + 1.2, _MAP * down + 1.0
    return SIZE


def draw(figure: Figure | SubFigure, shown: Chart | Fields) -> list[PlacedSeries]:
    """Fill a figure with a chart or fields; return where the series of a chart are."""
    if isinstance(shown, Fields):
        _draw_fields(figure, shown)
        return []
    return _draw_chart(figure, shown)


def _draw_chart(figure: Figure | SubFigure, chart: Chart) -> list[PlacedSeries]:
    count, in_grid = len(chart.y), bool(chart.titles)
    across, down = _arrangement(count) if in_grid else (1, count)
    ratios = {"height_ratios": chart.heights} if chart.heights else {}
    shared: dict[str, Any] = {"sharex": True, "sharey": in_grid, "gridspec_kw": ratios}
    all_axes = figure.subplots(down, across, squeeze=False, **shared).ravel()
    panels, unused = all_axes[:count], all_axes[count:]
    for axes in unused:
        axes.remove()
    # What is published is in the units that follow from the rest.
    scaled = [s for s in chart.series if s.role != "published"]
    scale_x = chart.x.scale([s.x for s in scaled])
    drawn, groups = [], []
    for number, (axes, axis) in enumerate(zip(panels, chart.y, strict=True)):
        scale_y = axis.scale([s.y for s in scaled if in_grid or s.panel == number])
        groups.append((panels if in_grid else [axes], axis, scale_y))
        for low, high in chart.shaded:
            axes.axvspan(low * scale_x.factor, high * scale_x.factor, color="0.9", zorder=0, lw=0)
        drawn += [
            _draw_series(axes, series, chart, scale_x, scale_y)
            for series in chart.series
            if series.panel == number
        ]
        if number % across == 0:
            axes.set_ylabel(textwrap.fill(axis.label(scale_y), _LETTERS))
        if number + across >= count:
            axes.set_xlabel(textwrap.fill(chart.x.label(scale_x), _LETTERS))
            axes.tick_params(labelbottom=True)
        if axis.signed:
            axes.axhline(0.0, color=_PALE, linewidth=0.6)
        axes.grid(alpha=0.3)
    _name_legs(panels[0], chart)
    _set_scale(panels, "x", chart.x, scale_x.factor)
    for group, axis, scale_y in groups:
        _set_scale(group, "y", axis, scale_y.factor)
    _name(figure, panels, chart)
    if chart.note:
        place = {"transform": panels[0].transAxes, "fontsize": "small"}
        panels[0].text(0.02, 0.02, chart.note, color="red", **place)
    if len(panels) > 1:
        figure.align_ylabels(panels)
    return drawn


def _name(figure: Figure | SubFigure, panels: Sequence[Axes], chart: Chart) -> None:
    """Give panels titles and legends; those of a grid have one legend beside them."""
    named = [dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True)) for axes in panels]
    if not chart.titles:
        panels[0].set_title(chart.title)
        for axes, entries in zip(panels, named, strict=True):
            if entries:
                axes.legend(frameon=False, fontsize="small")
        return
    figure.suptitle(chart.title)
    for axes, title in zip(panels, chart.titles, strict=True):
        axes.set_title(title, fontsize="small")
    if distinct := {name: handle for entries in named for name, handle in entries.items()}:
        beside: dict[str, Any] = {"loc": "outside right upper", "fontsize": "small"}
        figure.legend(distinct.values(), distinct.keys(), **beside)


def _draw_series(
    axes: Axes, series: Series, chart: Chart, scale_x: Scale, scale_y: Scale
) -> PlacedSeries:
    factors = (1.0, 1.0) if series.role == "published" else (scale_x.factor, scale_y.factor)
    x, y = series.x * factors[0], series.y * factors[1]
    style, label = _style(series, chart), series.legend or None
    if series.low is not None and not x.size:
        axes.fill_between([], [], [], color=style["color"], alpha=0.2, linewidth=0, label=label)
    elif series.legs:
        _draw_legs(axes, series, x, y, {"label": label, **style})
    else:
        axes.plot(x, y, label=label, **style)
    if series.low is not None and series.high is not None and x.size:
        low, high = series.low * factors[1], series.high * factors[1]
        if x.size == 1:
            bar: dict[str, Any] = {"markersize": 12, "linewidth": 0.8, "capsize": 3}
            spread = np.maximum([y - low, high - y], 0.0)
            axes.errorbar(x, y, spread, fmt="_", color=style["color"], clip_on=False, **bar)
        else:
            axes.fill_between(x, low, high, color=style["color"], alpha=0.2, linewidth=0)
    if series.converged is not None:
        bad = ~series.converged & np.isfinite(x) & np.isfinite(y)
        named = "_" if _NOT_CONVERGED in axes.get_legend_handles_labels()[1] else ""
        if bad.any():
            label = f"{named}{_NOT_CONVERGED}"
            axes.plot(x[bad], y[bad], "x", color="red", markersize=9, label=label)
    return PlacedSeries(axes, series, np.column_stack([x, y]))


def _style(series: Series, chart: Chart) -> dict[str, Any]:
    look = series.look
    if series.role == "published":
        marker = "" if look.line is not None else "*x+"[(look.marker or 0) % 3]
        line = "none" if look.line is None else "-"
        return {"color": "black", "linestyle": line, "marker": marker, "ms": 9, "zorder": 5}
    is_reference = series.role == "reference"
    hue = "black" if is_reference else _GREY
    if look.hue is not None:
        hue = colour(look.hue, chart.hues, ordered=chart.ordered)
    style: dict[str, Any] = {"color": hue, "linewidth": 0.9 if is_reference else 1.2}
    style["linestyle"] = "none" if look.line is None else LINES[look.line % len(LINES)]
    if is_reference:
        style["zorder"] = 1
    if series.stepped:
        style["drawstyle"] = f"steps-{series.stepped}"
    if look.marker is None:
        return style
    style["marker"] = MARKERS[look.marker % len(MARKERS)]
    face = style["color"] if look.filled else "white"
    if look.line is None and series.x.size > _MOST_MARKED:
        if look.filled is not None:
            return style | {"markersize": _DOT, "markerfacecolor": face, "markeredgewidth": 0.5}
        return style | {"marker": ".", "markersize": _DOT}
    if look.sparse:
        # Smooth curves that coincide show their markers beside each other.
        first = _SPARSE_DISTANCE * (0.2 + 0.25 * (look.marker % 4))
        return style | {"markersize": 3.5, "markevery": (first, _SPARSE_DISTANCE)}
    style |= {"markersize": 4, "markerfacecolor": face}
    of_legs = (series.x[leg.steps].size for leg in series.legs)
    if look.line is not None and max(of_legs, default=series.x.size) > _MOST_MARKED:
        style["markevery"] = _MARKER_DISTANCE
    return style


def _draw_legs(axes: Axes, series: Series, x: Array, y: Array, style: dict[str, Any]) -> None:
    """Draw approach in the style, and retraction with short dashes and filled markers."""
    # The legend shows the plain style if there is an approach.
    for leg in sorted(series.legs, key=lambda leg: leg.direction):
        drawn = dict(style)
        if leg.direction == "retraction":
            drawn["markerfacecolor"] = style["color"]
            if style["linestyle"] != "none":
                drawn["linestyle"] = _RETRACTION
        axes.plot(x[leg.steps], y[leg.steps], **drawn)
        style = style | {"label": None}


def _name_legs(axes: Axes, chart: Chart) -> None:
    """Name approach and retraction in the legend to come, if the series have both."""
    if len({leg.direction for series in chart.series for leg in series.legs}) > 1:
        hue = colour(0, 1) if chart.hues == 1 else _GREY
        style: dict[str, Any] = {"color": hue, "marker": MARKERS[0], "markersize": 4}
        axes.plot([], [], label="approach", markerfacecolor="white", **style)
        axes.plot([], [], label="retraction", linestyle=_RETRACTION, **style)


def _set_scale(panels: Sequence[Axes], direction: str, axis: Axis, factor: float) -> None:
    """Make the axis of panels that share it logarithmic if it shows a positive value, and limit it.

    Beside negative values, a logarithmic axis leaves out those that are not positive, and the lines
    to them; otherwise such lines end at the edge. A linear axis of positive values does not begin
    below 0.
    """
    low, high = (None if end is None else end * factor for end in axis.limits)
    lowest = min(getattr(axes.dataLim, f"{direction}0") for axes in panels)
    positive = min(getattr(axes.dataLim, f"minpos{direction}") for axes in panels)
    if axis.log and np.isfinite(positive):
        nonpositive = "mask" if lowest < 0 else "clip"
        for axes in panels:
            getattr(axes, f"set_{direction}scale")("log", nonpositive=nonpositive)
    elif low is None and lowest >= 0:
        drawn = getattr(panels[0], f"get_{direction}lim")()
        low = 0.0 if drawn[0] < 0 else None
    elif low is not None and high is None and np.isfinite(lowest):
        # Values that hardly differ would lie on the edge, which is 5 % of their range above them.
        highest = max(getattr(axes.dataLim, f"{direction}1") for axes in panels)
        high = max(getattr(panels[0], f"get_{direction}lim")()[1], low + 1.03 * (highest - low))
    getattr(panels[0], f"set_{direction}lim")(low, high)


def _arrangement(count: int) -> tuple[int, int]:
    count = max(count, 1)
    across = 3 if count > _ACROSS and count % 3 == 0 and count % _ACROSS else min(count, _ACROSS)
    return across, ceil(count / across)


def _draw_fields(figure: Figure | SubFigure, fields: Fields) -> None:
    across, down = _arrangement(len(fields.panels))
    all_axes = figure.subplots(down, across, squeeze=False).ravel()
    for axes in all_axes[len(fields.panels) :]:
        axes.set_axis_off()
    figure.suptitle(fields.title)
    if not fields.panels:
        return
    is_bool = fields.panels[0].values.dtype == bool
    is_number = not is_bool and not fields.parts
    scale = fields.axis.scale([panel.values for panel in fields.panels] if is_number else [])
    colours = _colours(fields, scale.factor)
    for axes, panel in zip(all_axes, fields.panels, strict=False):
        image = _draw_panel(axes, panel, scale.factor, colours, parts=fields.parts)
        axes.label_outer()
    if is_bool:
        from matplotlib.patches import Patch

        words = fields.axis.words
        patches = Patch(color="black"), Patch(color=NO_CONTACT)
        below: dict[str, Any] = {"loc": "outside lower center", "ncols": 2, "fontsize": "small"}
        figure.legend(patches, [words, f"no {words}"], **below)
    elif not fields.parts:
        # A bar beside the map, as high as it.
        last = all_axes[min(across, len(fields.panels)) - 1]
        beside = last.inset_axes((1.04, 0.0, 0.05, 1.0))
        image.figure.colorbar(image, cax=beside, label=fields.axis.label(scale))


def _draw_panel(
    axes: Axes, panel: Panel, factor: float, colours: dict[str, Any], *, parts: bool
) -> Any:
    """Draw a field times ``factor``, or numbers of ``parts``, and return its image."""
    length = axis_unit(np.array(panel.size) / 2, "m")
    x, y = (edge / 2 * length.factor for edge in panel.size)
    values = panel.values.T * factor if factor != 1.0 else panel.values.T
    if parts:
        values = (values % _PARTS).astype(np.uint8)
    if panel.blank is not None:
        values = np.ma.masked_where(panel.blank.T, values)
        axes.set_facecolor(NO_CONTACT)
    edges: Any = -x, x, -y, y
    # The stage "rgba" converts every cell to four colour values first.
    shared: dict[str, Any] = {"origin": "lower", "interpolation_stage": "data"}
    image = axes.imshow(values, extent=edges, **shared, **colours)
    for mask, style in zip(panel.outlines, ("solid", "dotted"), strict=False):
        # matplotlib warns of a contour that does not exist.
        if mask.any() and not mask.all() and min(mask.shape) > 1:
            line: dict[str, Any] = {"colors": "black", "linewidths": 0.8, "linestyles": style}
            axes.contour(mask.T.astype(float), levels=[0.5], extent=edges, origin="lower", **line)
    axes.set(xlabel=f"x [{length.unit}]", ylabel=f"y [{length.unit}]")
    axes.set_title(panel.title, fontsize="medium")
    return image


def _colours(fields: Fields, factor: float) -> dict[str, Any]:
    from matplotlib.colors import ListedColormap

    if fields.panels[0].values.dtype == bool:
        black = ListedColormap([NO_CONTACT, "black"])
        return {"cmap": black, "vmin": 0.0, "vmax": 1.0, "interpolation": "nearest"}
    if fields.parts:
        return {"cmap": "tab20", "vmin": 0, "vmax": _PARTS - 1, "interpolation": "nearest"}
    low, high = (end * factor for end in extent(panel.values for panel in fields.panels))
    if fields.axis.limits[0] is not None:
        low = min(fields.axis.limits[0] * factor, low)
    if fields.centred and low < 0:
        highest = float(max(-low, high))
        return {"cmap": DIVERGING, "vmin": -highest, "vmax": highest}
    if low == high:
        # matplotlib would centre a scale without range on its only value.
        low, high = min(low, 0.0), max(high, 0.0 if low else 1.0)
    return {"cmap": "viridis", "vmin": low, "vmax": high}


def marks_of(
    figure: Figure, drawn: Sequence[PlacedSeries], steps: Sequence[int]
) -> list[list[tuple[float, float]]]:
    """Return where load steps lie on a drawn figure, as shares of its size from top left."""
    figure.draw_without_rendering()
    marks: list[list[tuple[float, float]]] = [[] for _ in steps]
    for axes, series, points in drawn:
        if series.steps is None or not series.x.size:
            continue
        pixels = axes.transData.transform(points)
        shares = figure.transFigure.inverted().transform(pixels)
        for marks_of_step, step in zip(marks, steps, strict=True):
            here = shares[(series.steps == step) & np.isfinite(shares).all(axis=1)]
            marks_of_step += [(float(left), float(1 - bottom)) for left, bottom in here]
    return marks
