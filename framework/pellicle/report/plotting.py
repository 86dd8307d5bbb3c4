"""Figures of a result or a study on matplotlib Axes, with units."""

from __future__ import annotations

import json
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.analysis import Leg, legs
from pellicle.arrays import Array, Mask
from pellicle.components import Solver
from pellicle.files import atomic_write, for_document, storage_errors
from pellicle.numerics.problem import height_scale
from pellicle.results.path import has_interaction, has_times, label_of_step
from pellicle.results.result import Result
from pellicle.results.shape import is_periodic
from pellicle.results.variables import CONTACT_AREA, CORRECTED_AREA, wording
from pellicle.units import axis_unit

from .style import (
    MARKERS,
    NO_CONTACT,
    FigureStyle,
    add_colour_bar,
    colour,
    is_log_spaced,
    is_ordered,
    label_log_axes,
    lay_out,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_NAMED = 10
_MOST_MARKED = 80
MOST_LEGS = 4
"""Largest number of legs of a path in time that are told apart by their style."""
DIVERGING = "RdBu_r"
"""The colours of fields that are negative where an interaction pulls."""
RETRACTION = (0, (2.5, 1.2))
"""Line style of retraction; its markers are filled, those of approach are open."""


def without_round_off(step: xr.Dataset) -> xr.Dataset:
    """Return a load step for drawing, with gaps below its tolerance set to 0.

    The tolerance is ``solver.tolerance`` times the length that scales the residuals of the step;
    otherwise full contact would be drawn as a landscape of femtometres.
    """
    solver = json.loads(step.attrs.get("configuration", "{}")).get("solver", {})
    tolerance = float(solver.get("tolerance", Solver.model_fields["tolerance"].default))
    gap, depth = step["gap"].values, float(step["depth"])
    # A step that failed may have infinite values of both signs.
    with np.errstate(invalid="ignore"):
        profile = step["displacement"].values - depth - gap
    closed = np.abs(gap) <= tolerance * height_scale(profile, step["contact"].values, depth)
    return step.assign(gap=(step["gap"].dims, np.where(closed, 0.0, gap), step["gap"].attrs))


def draws_contact(data: xr.Dataset) -> bool:
    """Whether the last step in contact is drawn: with an interaction or times paths end off it."""
    return has_interaction(data) or has_times(data)


def default_step(steps: xr.Dataset) -> int:
    """Return the index of the load step of a run that is drawn: -1, which is the last.

    It is the last step in contact where `draws_contact`.
    """
    if not draws_contact(steps):
        return -1
    in_contact = np.flatnonzero(steps["contact_area"].values > 0)
    return int(in_contact[-1]) if in_contact.size else -1


def pressure_map(result: Result, axes: Axes, step: int | None = None) -> None:
    """Draw the pressure of a load step over the domain, by default of `default_step`.

    Where there is tension, colours are centred at 0, a line encloses the contact and a dotted line
    the zone in which an interaction pulls.
    """
    step = default_step(result.dataset) if step is None else step
    data = result.dataset.isel(step=step)
    pressure = data["pressure"].values
    length, length_name = axis_unit(np.append(data["x"].values, data["y"].values), "m")
    scale, name = axis_unit(pressure, "Pa")
    tensile = has_interaction(data)
    image = axes.imshow(
        np.ma.masked_equal(pressure.T * scale, 0.0),
        origin="lower",
        extent=extent(data["x"].values * length, data["y"].values * length),
        **(diverging(pressure * scale) if tensile else {"cmap": "viridis", "vmin": 0.0}),
        interpolation="nearest",
        # The stage "rgba" converts every cell to a colour before it resamples.
        interpolation_stage="data",
    )
    axes.set_facecolor(NO_CONTACT)
    if tensile:
        outline_contact(data, axes, length)
    axes.set(xlabel=f"x [{length_name}]", ylabel=f"y [{length_name}]")
    axes.set_title(_caption(result, step))
    label = "pressure, negative where it pulls" if tensile else "contact pressure"
    add_colour_bar(axes, image, f"{label} [{name}]")


def diverging(values: Array) -> dict[str, Any]:
    """Return keywords of ``Axes.imshow`` for colours centred at 0, blue where negative."""
    highest = float(np.abs(values[np.isfinite(values)]).max(initial=0.0)) or 1.0
    return {"cmap": DIVERGING, "vmin": -highest, "vmax": highest}


def outline_contact(step: xr.Dataset, axes: Axes, length: float) -> None:
    """Draw a line around the contact and a dotted one around the zone in which a traction acts.

    ``length`` is the factor from metres to the unit of the axes.
    """
    contact = step["contact"].transpose("x", "y").values
    acts = contact | (step["pressure"].transpose("x", "y").values != 0)
    x, y = step["x"].values * length, step["y"].values * length
    for mask, style in ((contact, "solid"), (acts, "dotted")):
        # matplotlib warns of a contour that does not exist.
        if mask.any() and not mask.all() and min(mask.shape) > 1:
            axes.contour(
                x,
                y,
                mask.T.astype(float),
                levels=[0.5],
                colors="black",
                linewidths=0.8,
                linestyles=style,
            )


def profile(result: Result, axes: Axes, step: int | None = None) -> None:
    """Draw pressure and gap along a line of cells in x, by default of `default_step`.

    The line goes through the centre of the domain, or, where it meets no contact there, through the
    greatest pressure. With an interaction the contact is shaded.
    """
    step = default_step(result.dataset) if step is None else step
    data = without_round_off(result.dataset.isel(step=step))
    row = data.sizes["y"] // 2
    if not data["contact"].isel(y=row).any():
        row = int(np.abs(data["pressure"].values).max(axis=0).argmax())
    line = data.isel(y=row)
    gap = line["gap"].values
    pulls = has_interaction(data)
    height = max(float(data["depth"]), 0.0)
    if pulls:
        # The surface rises above the undeformed plane, and the indenter hangs over it.
        height = max(abs(float(data["depth"])), float(np.abs(line["displacement"].values).max()))
    near = gap <= height * 2
    if gap.max() <= height * _OPEN or not near.any():
        near = np.isfinite(gap)
    length, length_name = axis_unit(line["x"].values, "m")
    scale, name = axis_unit(line["pressure"].values, "Pa")
    opens = bool(gap[near].any())
    # A gap of 0 everywhere has no scale of its own, and is drawn on that of the depth.
    gap_scale, gap_name = axis_unit(gap[near] if opens else data["depth"].values, "m")
    x = line["x"].values * length
    pressure, contact = line["pressure"].values * scale, line["contact"].values
    edge = np.zeros_like(contact) if pulls else edge_cells(contact)
    axes.plot(*smooth(x, np.where(edge, np.nan, pressure)), color="C0")
    if edge.any():
        axes.plot(x[edge], pressure[edge], ".", color="C0", markersize=3)
    about = f"\ndots: {EDGE_CELLS}" if edge.any() else ""
    axes.set(
        xlabel=f"x [{length_name}] at y = {line['y'].item() * length:.3g} {length_name}{about}"
    )
    axes.set_ylabel(f"{'' if pulls else 'contact '}pressure [{name}]", color="C0")
    axes.set_title(_caption(result, step))
    gap_axes = axes.twinx()
    gap_axes.plot(*smooth(x, gap * gap_scale), color="C1", linestyle="--")
    gap_axes.set_ylabel(f"gap [{gap_name}]", color="C1")
    if pulls:
        axes.axhline(0.0, color="C0", linewidth=0.6)
        _shade(axes, x, line["contact"].values)
    for side in (gap_axes,) if pulls else (axes, gap_axes):
        side.set_ylim(bottom=0.0)
    if not opens and float(data["depth"]) > 0:
        gap_axes.set_ylim(top=float(data["depth"]) * gap_scale)
    elif opens and not near.all():
        gap_axes.set_ylim(top=float(gap[near].max()) * gap_scale)


EDGE_CELLS = "cells at the edge of contact"
"""Name of the cells whose pressure is that of the grid."""
_OPEN = 4.0
"""Largest gap along a line, over the depth, up to which the whole line is drawn."""
_EDGE = 3
_RESOLVED = 16
_SMOOTH = 300


def edge_cells(contact: Mask) -> Mask:
    """Return which cells along a line through one contact are its three outermost at each end.

    Their pressure depends on where the edge of contact passes through them, most where tension
    makes it jump there. Lines through several contacts or fewer than 16 cells have none.
    """
    edge = np.zeros(contact.shape, dtype=bool)
    (cells,) = np.nonzero(contact)
    if cells.size < _RESOLVED or cells[-1] - cells[0] + 1 != cells.size:
        return edge
    if cells[0] > 0:
        edge[cells[:_EDGE]] = True
    if cells[-1] < contact.size - 1:
        edge[cells[-_EDGE:]] = True
    return edge


def smooth(x: Array, y: Array) -> tuple[Array, Array]:
    """Return a curve through points without their corners, with gaps where ``y`` is not finite.

    Cubic pieces (Fritsch & Butland 1984) do not overshoot. Curves of 300 points stay as they are.
    """
    if x.size >= _SMOOTH or np.any(np.diff(x) <= 0):
        return x, y
    from scipy.interpolate import PchipInterpolator

    pieces_x, pieces_y = [], []
    finite = np.flatnonzero(np.isfinite(y))
    for piece in np.split(finite, np.flatnonzero(np.diff(finite) > 1) + 1):
        if piece.size > 2:
            fine = np.interp(np.arange(0, piece.size - 0.95, 0.1), np.arange(piece.size), x[piece])
            pieces_x += [fine, fine[-1:]]
            pieces_y += [PchipInterpolator(x[piece], y[piece])(fine), np.full(1, np.nan)]
        else:
            pieces_x += [x[piece], x[piece][-1:]]
            pieces_y += [y[piece], np.full(piece[-1:].size, np.nan)]
    return np.concatenate(pieces_x), np.concatenate(pieces_y)


def _shade(axes: Axes, x: Array, where: Mask) -> None:
    """Shade the cells at ``x`` where a mask holds, over the whole height of the axes."""
    # An empty shade would set the limits of the axes to round-off.
    if where.any():
        shade = axes.fill_between(
            x,
            0,
            1,
            where=where,
            step="mid",
            transform=axes.get_xaxis_transform(),
            color="0.9",
            zorder=0,
        )
        # Otherwise 0 and 1 are edges of the vertical axis.
        shade.sticky_edges.y.clear()


def force_depth(result: Result, axes: Axes) -> None:
    """Draw force against depth over the load steps."""
    _curve(result, axes, [("force", None, "o-")], "depth")


def area_force(result: Result, axes: Axes) -> None:
    """Draw the contact area, of the cells and corrected, against force."""
    corrected = [
        (str(name), wording(variable).words.removeprefix(f"{CONTACT_AREA}, "), "s--")
        for name, variable in result.dataset.data_vars.items()
        if str(name).startswith(CORRECTED_AREA)
    ]
    series = [("contact_area", "cells in contact", "o-"), *corrected]
    _curve(result, axes, series, "force")
    if not has_interaction(result.dataset):
        axes.legend()


def over_time(result: Result, figure: Figure) -> None:
    """Draw force, depth and contact area against time, one above the other."""
    data = result.dataset
    panels = figure.subplots(len(_OVER_TIME), sharex=True)
    shown_t = wording(data["time"])
    good = data["converged"].values.astype(bool)
    t = data["time"].values * shown_t.scale.factor
    for axes, (name, hue) in zip(panels, _OVER_TIME.items(), strict=True):
        shown = wording(data[name])
        y = data[name].values * shown.scale.factor
        axes.plot(t, y, color=hue, mfc="white", **_marked(t.size))
        axes.plot(t[~good], y[~good], "x", color="red", markersize=9)
        axes.set_ylabel(shown.head)
        axes.axhline(0.0, color="0.4", linewidth=0.6)
        axes.grid(alpha=0.3)
    panels[0].set_title(data.attrs.get("title", ""))
    panels[-1].set_xlabel(shown_t.head)
    figure.align_ylabels(panels)


def _marked(count: int, marker: str = "o") -> dict[str, Any]:
    """Return keywords of ``Axes.plot`` for a curve over ``count`` steps: markers on few of them."""
    few = count <= _MOST_MARKED
    return {"linestyle": "-", "marker": marker if few else "", "markersize": 4}


_OVER_TIME = {"force": "C0", "depth": "C1", "contact_area": "C2"}
TIME = "time"
"""Suffix of the figure over time, which runs with times have."""
FIGURES: dict[str, Callable[[Result, Axes], None]] = {
    "pressure": pressure_map,
    "profile": profile,
    "force_depth": force_depth,
    "area_force": area_force,
}
"""Figures of a run on one pair of axes, by the suffix of the file name."""
STUDY_FIGURES = "force", "contact_area", "contact_fraction"
"""Variables that may be drawn for a study, which are the suffixes of the file names too."""


def save_figures(
    result: Result,
    directory: Path,
    name: str,
    formats: Iterable[str],
    style: FigureStyle | None = None,
) -> tuple[Path, ...]:
    """Write every figure as ``directory/name-figure.format`` and return the files.

    Raises
    ------
    StorageError
        A file cannot be written.
    """
    return _save(drawings(result), directory, name, formats, style)


def drawings(result: Result) -> dict[str, Callable[[Figure], None]]:
    """Return what fills each figure of a run, by the suffix of the file name."""

    def fill(draw: Callable[[Result, Axes], None], figure: Figure) -> None:
        draw(result, figure.add_subplot())

    figures: dict[str, Callable[[Figure], None]] = {
        suffix: partial(fill, draw) for suffix, draw in FIGURES.items()
    }
    if has_times(result.dataset) and result.dataset.sizes["step"] > 1:
        figures[TIME] = partial(over_time, result)
    return figures


def save_study_figures(
    table: xr.Dataset,
    directory: Path,
    name: str,
    formats: Iterable[str],
    style: FigureStyle | None = None,
) -> tuple[Path, ...]:
    """Write the figures of `study_figures` as ``directory/name-figure.format``.

    Parameters are as for `save_figures`; ``table`` is that of `pellicle.run_study`.

    Raises
    ------
    StorageError
        A file cannot be written.
    """

    def fill(variable: str, figure: Figure) -> None:
        study_curves(table, figure.add_subplot(), variable)

    figures = {variable: partial(fill, variable) for variable in study_figures(table)}
    return _save(figures, directory, name, formats, style)


def study_figures(table: xr.Dataset) -> tuple[str, ...]:
    """Return the variables drawn for a study: force, and contact fraction or area.

    A free domain has no nominal area of which the contact is a fraction.
    """
    if "force" not in table:
        return ()
    return "force", "contact_fraction" if is_periodic(table) else "contact_area"


def study_curves(table: xr.Dataset, axes: Axes, variable: str) -> None:
    """Draw a variable of a study against the depth, one colour for each value of its first axis.

    Where steps have times, it is drawn against the time; where each run has one step only, against
    the first axis of numbers instead.
    """
    dimensions = [str(d) for d in table["status"].dims if d != "step"]
    numbers = [d for d in dimensions if table[d].dtype.kind in "if" and table.sizes[d] > 1]
    over_steps = table.sizes["step"] > 1 or not numbers
    of_steps = "time" if has_times(table) else "depth"
    against = of_steps if over_steps else numbers[0]
    along = "step" if over_steps else against
    # Seeds are repetitions, not values to compare.
    rest = [d for d in dimensions if d != along]
    compared = sorted(rest, key=lambda d: d.endswith("seed") or table.sizes[d] == 1)[:1]
    shown, shown_x = wording(table[variable]), wording(table[against])
    named_by = wording(table[compared[0]]) if compared else None
    stacked = [d for d in table["status"].dims if d not in (along, *compared)]
    many = table.sizes[compared[0]] if compared else 1
    ordered = bool(compared) and is_ordered(table, compared[0])
    pulls, paths = has_interaction(table), list[list[Leg]]()
    for number, part in enumerate(_parts(table, compared)):
        hue = colour(number, many, ordered=ordered)
        marker = MARKERS[number % len(MARKERS)]
        # Of many values only some are named: colours change evenly between them.
        named = compared and number % -(-many // _MOST_NAMED) == 0
        label = named_by.text(part[compared[0]].item()) if named and named_by else ""
        for line in _parts(part, stacked):
            x = line[against].values * shown_x.scale.factor
            y = line[variable].values * shown.scale.factor
            if pulls and against == "depth":
                finished = np.isfinite(line["depth"].values)
                paths.append(legs(line["depth"].values[finished]))
                draw_legs(
                    axes,
                    paths[-1],
                    x[finished],
                    y[finished],
                    color=hue,
                    marker=marker,
                    linestyle="-",
                    label=label,
                    markersize=4,
                )
            else:
                axes.plot(x, y, color=hue, label=label, mfc="white", **_marked(x.size, marker))
            good = line["converged"].values
            axes.plot(x[~good], y[~good], "x", color="red", markersize=9)
            label = ""
    axes.set(
        xlabel=shown_x.head,
        ylabel=shown.head,
        title=table.attrs.get("title", ""),
    )
    if along != "step" and is_log_spaced(table[against].values):
        axes.set_xscale("log")
    if pulls:
        axes.axhline(0.0, color="0.4", linewidth=0.6)
        if paths:
            name_legs(axes, paths, "C0" if many == 1 else "0.4")
    else:
        axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    if compared or axes.get_legend_handles_labels()[1]:
        # matplotlib takes long to find the best place among many curves.
        axes.legend(fontsize="small", loc="upper left" if many > _MOST_NAMED else "best")


def _save(
    figures: Mapping[str, Callable[[Figure], None]],
    directory: Path,
    name: str,
    formats: Iterable[str],
    style: FigureStyle | None,
) -> tuple[Path, ...]:
    files: list[Path] = []
    for suffix, fill in figures.items():
        files += save_figure(fill, directory / f"{name}-{suffix}", formats, style=style)
    return tuple(files)


def save_figure(
    draw: Callable[[Figure], None],
    stem: Path,
    formats: Iterable[str],
    size: tuple[float, float] = (5.4, 4.2),
    style: FigureStyle | None = None,
) -> tuple[Path, ...]:
    """Let ``draw`` fill a figure of ``size`` [inch], and write it as ``stem.format``.

    The width of a ``style`` replaces that of ``size``, with the height in proportion.

    Raises
    ------
    StorageError
        A file cannot be written.
    """
    files = []
    with _figure(draw, size, style) as figure:
        for format_ in formats:
            path = stem.with_name(f"{stem.name}.{format_}")
            with storage_errors(path):
                path.parent.mkdir(parents=True, exist_ok=True)
                figure.savefig(path)
            files.append(path)
    return tuple(files)


def save_pages(
    draws: Iterable[Callable[[Figure], None]], path: Path, size: tuple[float, float]
) -> Path:
    """Let each function fill a page of ``size`` [inch] of a PDF file, and return the file.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    from matplotlib.backends.backend_pdf import PdfPages

    with atomic_write(path) as part, PdfPages(part, metadata={"CreationDate": None}) as file:
        for draw in draws:
            with _figure(draw, size) as figure:
                file.savefig(figure)
    return path


def svg(draw: Callable[[Figure], None], size: tuple[float, float] = (5.4, 4.2)) -> bytes:
    """Let ``draw`` fill a figure of ``size`` [inch], and return it as reproducible SVG."""
    import matplotlib as mpl

    # A page cannot count on the fonts of its reader.
    with mpl.rc_context(), _figure(draw, size, FigureStyle(svg_text=False)) as figure:
        mpl.rcParams["svg.hashsalt"] = "pellicle"
        buffer = BytesIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


@contextmanager
def _figure(
    draw: Callable[[Figure], None], size: tuple[float, float], style: FigureStyle | None = None
) -> Iterator[Figure]:
    from matplotlib.figure import Figure
    from matplotlib.text import Text

    style = style or FigureStyle()
    with style.applied():
        figure = Figure(figsize=style.size(size), dpi=150, layout="constrained")
        draw(figure)
        # SVG repeats every text in a comment of its XML.
        for text in figure.findobj(Text):
            text.set_text(for_document(text.get_text()))
        label_log_axes(figure)
        lay_out(figure)
        try:
            yield figure
        finally:
            # Artists refer to each other, so the fields that they draw would outlive the figure.
            figure.clear()


def _parts(table: xr.Dataset, dimensions: Sequence[Hashable]) -> Iterator[xr.Dataset]:
    """Yield the part of a table at each combination of indices along dimensions."""
    for index in np.ndindex(*(table.sizes[d] for d in dimensions)):
        yield table.isel(dict(zip(dimensions, index, strict=True)))


def _curve(
    result: Result,
    axes: Axes,
    series: Sequence[tuple[str, str | None, str]],
    against: str,
) -> None:
    data = result.dataset
    shown, shown_x = wording(data[series[0][0]]), wording(data[against])
    good = data["converged"].values.astype(bool)
    pulls, path = has_interaction(data), legs(data["depth"].values)
    hysteretic = pulls or (has_times(data) and len(path) <= MOST_LEGS)
    for number, (variable, label, style) in enumerate(series):
        x = data[against].values * shown_x.scale.factor
        y = data[variable].values * shown.scale.factor
        if hysteretic:
            draw_legs(
                axes,
                path,
                x,
                y,
                color=f"C{number}",
                marker=style[0],
                linestyle=style[1:],
                label=label,
                markersize=4,
            )
        else:
            marked = _marked(x.size) | {"linestyle": style[1:]}
            axes.plot(x, y, color=f"C{number}", label=label, mfc="white", **marked)
        axes.plot(x[~good], y[~good], "x", color="red", markersize=9, label="_not converged")
    axes.set(xlabel=shown_x.head, ylabel=shown.head)
    if hysteretic:
        name_legs(axes, [path], "C0" if len(series) == 1 else "0.4")
        if axes.get_legend_handles_labels()[1]:
            axes.legend(fontsize="small")
    if pulls:
        axes.axhline(0.0, color="0.4", linewidth=0.6)
    else:
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    axes.set_title(result.dataset.attrs.get("title", ""))
    if not good.all():
        axes.annotate("× not converged", (0.02, 0.95), xycoords="axes fraction", color="red")


def draw_legs(
    axes: Axes, path: Iterable[Leg], x: Array, y: Array, *, arrows: bool = True, **style: Any
) -> None:
    """Draw a curve over the steps of a path, approach and retraction in different styles.

    Approach has the given style of ``Axes.plot``, which needs a color, with open markers;
    retraction has short dashes and filled markers. ``arrows`` point in the order of the steps; on
    logarithmic axes they might begin at values that are not positive. `name_legs` names both parts
    in the legend.
    """
    label = style.pop("label", None)
    # The legend shows the plain style if there is an approach.
    for leg in sorted(path, key=lambda leg: leg.direction):
        drawn = {**style, "markerfacecolor": "white"}
        if leg.direction == "retraction":
            drawn["markerfacecolor"] = style["color"]
            if style.get("linestyle") != "none":
                drawn["linestyle"] = RETRACTION
        axes.plot(x[leg.steps], y[leg.steps], label=label, **drawn)
        if arrows:
            _point_along(axes, x[leg.steps], y[leg.steps], style["color"])
        label = None


def name_legs(axes: Axes, paths: Iterable[Iterable[Leg]], hue: str = "0.4") -> None:
    """Name approach and retraction in the legend to come, if the paths have both.

    ``hue`` is the colour of the curve, if there is only one.
    """
    if len({leg.direction for path in paths for leg in path}) > 1:
        style: dict[str, Any] = {"color": hue, "marker": "o", "markersize": 4}
        axes.plot([], [], label="approach", markerfacecolor="white", **style)
        axes.plot([], [], label="retraction", linestyle=RETRACTION, **style)


def _point_along(axes: Axes, x: Array, y: Array, colour: Any) -> None:
    """Draw an arrow in the middle of the part of a line in which y changes, in its order."""
    finite = np.isfinite(x) & np.isfinite(y)
    starts = np.flatnonzero(finite[:-1] & finite[1:] & (y[1:] != y[:-1]))
    if starts.size:
        start = int(starts[starts.size // 2])
        axes.annotate(
            "",
            xy=((x[start] + x[start + 1]) / 2, (y[start] + y[start + 1]) / 2),
            xytext=(x[start], y[start]),
            arrowprops={
                "arrowstyle": "-|>",
                "mutation_scale": 15,
                "color": colour,
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )


def _caption(result: Result, step: int) -> str:
    caption = label_of_step(result.dataset, step, result.configuration)
    title = result.dataset.attrs.get("title", "")
    if not bool(result.dataset["converged"][step]):
        caption += ", NOT CONVERGED"
    return f"{title}\n{caption}" if title else caption


def extent(x: Array, y: Array) -> tuple[float, float, float, float]:
    """Return the outer edges of the domain from its cell centres, for ``Axes.imshow``."""
    return (*_edges(x), *_edges(y))


def _edges(centres: Array) -> tuple[float, float]:
    half = (centres[1] - centres[0]) / 2 if centres.size > 1 else 0.5
    return float(centres[0] - half), float(centres[-1] + half)
