"""Pressure and gap of a load step, over the domain and along a line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array, Mask
from pellicle.contact.problem import height_scale
from pellicle.results.path import has_interaction, has_times, label_of_step
from pellicle.results.result import Result
from pellicle.results.wording import is_periodic
from pellicle.units import axis_unit

from .style import NO_CONTACT, add_colour_bar

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

DIVERGING = "RdBu_r"
"""The colours of fields that are negative where an interaction pulls."""
EDGE_CELLS = "cells at the edge of contact"
"""Name of the cells whose pressure is that of the grid."""
_EDGE = 3
_RESOLVED = 16
_OPEN = 4.0
"""Largest gap along a line, over the depth, up to which the whole line is drawn."""


def without_round_off(step: xr.Dataset) -> xr.Dataset:
    """Return a load step for drawing, with gaps below its tolerance set to 0.

    The tolerance is ``solver.tolerance`` times the length that scales the residuals of the step;
    otherwise full contact would be drawn as a landscape of femtometres.
    """
    gap, depth = step["gap"].values, float(step["depth"])
    # A step that failed may have infinite values of both signs.
    with np.errstate(invalid="ignore"):
        profile = step["displacement"].values - depth - gap
        # A layer far thicker than its period sinks by much more than the heights.
        if is_periodic(step):
            depth -= float(step["displacement"].mean())
    closed = np.abs(gap) <= step.attrs["tolerance"] * height_scale(
        profile, step["contact"].values, depth
    )
    return step.assign(gap=(step["gap"].dims, np.where(closed, 0.0, gap), step["gap"].attrs))


def draws_contact(data: xr.Dataset) -> bool:
    """Return whether the last step in contact is drawn: paths with adhesion or times end off it."""
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
    scale, name = axis_unit(pressure, "Pa")
    tensile = has_interaction(data)
    colours = diverging(pressure * scale) if tensile else {"cmap": "viridis", "vmin": 0.0}
    values = np.ma.masked_equal(pressure.T * scale, 0.0)
    image, length = show_field(axes, data, values, interpolation="nearest", **colours)
    axes.set_facecolor(NO_CONTACT)
    if tensile:
        outline_contact(data, axes, length)
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
            line: dict[str, Any] = {"colors": "black", "linewidths": 0.8, "linestyles": style}
            axes.contour(x, y, mask.T.astype(float), levels=[0.5], **line)


def profile(result: Result, axes: Axes, step: int | None = None) -> None:
    """Draw pressure and gap along a line of cells in x, by default of `default_step`.

    The line goes through the centre of the domain, or, where it meets no contact there, through the
    greatest pressure, if there is any. With an interaction the contact is shaded.
    """
    step = default_step(result.dataset) if step is None else step
    data = without_round_off(result.dataset.isel(step=step))
    row = data.sizes["y"] // 2
    peaks = np.abs(data["pressure"].values).max(axis=0)
    if peaks.any() and not data["contact"].isel(y=row).any():
        row = int(peaks.argmax())
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
    axes.plot(x, np.where(edge, np.nan, pressure), color="C0")
    if edge.any():
        axes.plot(x[edge], pressure[edge], ".", color="C0", markersize=3)
    about = f"\ndots: {EDGE_CELLS}" if edge.any() else ""
    at = f"{line['y'].item() * length:.3g} {length_name}{about}"
    axes.set_xlabel(f"x [{length_name}] at y = {at}")
    axes.set_ylabel(f"{'' if pulls else 'contact '}pressure [{name}]", color="C0")
    axes.set_title(_caption(result, step))
    gap_axes = axes.twinx()
    gap_axes.plot(x, gap * gap_scale, color="C1", linestyle="--")
    gap_axes.set_ylabel(f"gap [{gap_name}]", color="C1")
    if pulls:
        axes.axhline(0.0, color="C0", linewidth=0.6)
        # An empty shade would set the limits of the axes to round-off.
        if contact.any():
            style: dict[str, Any] = {"step": "mid", "color": "0.9", "zorder": 0}
            over = axes.get_xaxis_transform()
            shade = axes.fill_between(x, 0, 1, where=contact, transform=over, **style)
            # Otherwise 0 and 1 are edges of the vertical axis.
            shade.sticky_edges.y.clear()
    for side in (gap_axes,) if pulls else (axes, gap_axes):
        side.set_ylim(bottom=0.0)
    if not opens and float(data["depth"]) > 0:
        gap_axes.set_ylim(top=float(data["depth"]) * gap_scale)
    elif opens and not near.all():
        gap_axes.set_ylim(top=float(gap[near].max()) * gap_scale)


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


def _caption(result: Result, step: int) -> str:
    """Return the title of a figure of one load step."""
    caption = label_of_step(result.dataset, step)
    title = result.dataset.attrs.get("title", "")
    if not bool(result.dataset["converged"][step]):
        caption += ", NOT CONVERGED"
    return f"{title}\n{caption}" if title else caption


def show_field(
    axes: Axes, step: xr.Dataset, values: ArrayLike, **colours: Any
) -> tuple[AxesImage, float]:
    """Draw values along y, then x, at the cells of a step.

    Return also the factor from metres to the unit of the axes.
    """
    length, unit = axis_unit(np.append(step["x"].values, step["y"].values), "m")
    edges: Any = []
    for centres in (step["x"].values * length, step["y"].values * length):
        half = (centres[1] - centres[0] if centres.size > 1 else 1.0) / 2
        edges += [float(centres[0] - half), float(centres[-1] + half)]
    axes.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
    # The stage "rgba" converts every cell to four colour values first.
    shared: dict[str, Any] = {"origin": "lower", "interpolation_stage": "data"}
    return axes.imshow(values, extent=edges, **shared, **colours), length
