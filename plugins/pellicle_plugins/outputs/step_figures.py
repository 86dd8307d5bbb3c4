"""Figures of one load step: the pressure, a profile, and the indenter over the surface."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Dataset
from pellicle.components import Axis, Chart, Fields, Look, Panel, Series
from pellicle.results import Result, has_interaction, has_load, label_of_step
from pellicle.show import contact_and_zone, default_step, with_rim, without_round_off
from pellicle.units import readable

_LINES = 5
"""Largest number of load steps whose surfaces are drawn."""
_OPEN = 4.0
"""Largest gap along a line, over the depth, up to which the whole line is drawn."""


def pressure_map(result: Result) -> Fields:
    """Return the pressure over the domain, in the load step `default_step`.

    Where there is tension, colours are centred at 0, a line encloses the contact and a dotted line
    the zone in which an interaction pulls.
    """
    step = default_step(result.dataset)
    data = result.dataset.isel(step=step)
    pressure = data["pressure"].transpose("x", "y").values
    pulls = has_interaction(data) or has_load(data)
    outlines = contact_and_zone(data) if pulls and not has_load(data) else []
    title = _caption(result, step)
    panel = Panel(result.grid.size, pressure, title, pressure == 0, outlines)
    words = "pressure, negative where it pulls" if pulls else "contact pressure"
    return Fields(Axis(words, "Pa", limits=(None if pulls else 0.0, None)), [panel], centred=pulls)


def load_profile(result: Result) -> Chart:
    """Return the surface along x, and below it the traction, in each of the steps or some of them.

    The line goes through the centre of the domain. Heights are above the undeformed surface.
    """
    data, steps = result.dataset, result.dataset.sizes["step"]
    steps_shown = sorted({round(n) for n in np.linspace(0, steps - 1, min(steps, _LINES))})
    line = data.isel(y=data.sizes["y"] // 2)
    x, series = line["x"].values, list[Series]()
    for number, step in enumerate(steps_shown):
        look, label = Look(number, marker=None), label_of_step(data, step) * (len(steps_shown) > 1)
        surface = -line["displacement"].values[step]
        series.append(Series(x, surface, name=f"height {step + 1}", legend=label, look=look))
        pressure = line["pressure"].values[step]
        series.append(
            Series(x, pressure, name=f"traction {step + 1}", look=look, panel=1, stepped="mid")
        )
    axes = [Axis("height of the surface", "m", signed=True), Axis("traction", "Pa", signed=True)]
    title, hues = str(data.attrs.get("title", "")), len(steps_shown)
    return Chart(Axis("x", "m"), axes, series, title, heights=(3, 1), hues=hues, ordered=hues > 1)


def profile(result: Result, step: int | None = None) -> Chart:
    """Return pressure and gap along a line of cells in x, by default of `default_step`.

    The line goes through the centre of the domain, or, where it meets no contact there, through the
    greatest pressure, if there is any. It ends at the rim of a round contact; with an interaction
    the contact is shaded.
    """
    step = default_step(result.dataset) if step is None else step
    data = without_round_off(result.dataset.isel(step=step))
    row = data.sizes["y"] // 2
    peaks = np.abs(data["pressure"].values).max(axis=0)
    if peaks.any() and not data["contact"].isel(y=row).any():
        row = int(peaks.argmax())
    # A view would keep the whole field in memory while the chart is drawn.
    line = data.isel(y=row).copy(deep=True)
    x, gap, contact = line["x"].values, line["gap"].values, line["contact"].values
    half, pulls, depth = result.grid.spacing[0] / 2, has_interaction(data), float(data["depth"])
    height = max(depth, 0.0)
    if pulls:
        # The surface rises above the undeformed plane, and the indenter hangs over it.
        height = max(abs(depth), float(np.abs(line["displacement"].values).max()))
    near = gap <= height * 2
    if gap.max() <= height * _OPEN or not near.any():
        near = np.isfinite(gap)
    shown, shaded = (line if pulls else with_rim(line)), list[tuple[float, float]]()
    if pulls and contact.any():
        ends = np.flatnonzero(np.diff(np.pad(contact, 1).astype(int)))
        shaded = [(x[a] - half, x[b - 1] + half) for a, b in ends.reshape(-1, 2).tolist()]
    # A single cell across has an edge length all the same.
    across = Axis("x", "m", limits=(-half, half) if x.size == 1 else (None, None))
    words = "pressure" if pulls else "contact pressure"
    axes = [Axis(words, "Pa", limits=(None if pulls else 0.0, None), signed=pulls)]
    # At a rim that sticks the pressure has a peak in single cells, which no line goes through.
    points = shown["x"].values, shown["pressure"].values
    look = Look(marker=0 if x.size == 1 else None)
    series = [Series(*points, name="pressure", look=look, stepped="mid" if pulls else None)]
    if gap[near].any():
        end = None if near.all() else float(gap[near].max())
        axes.append(Axis("gap", "m", limits=(0.0, end)))
        series.append(Series(x, gap, name="gap", look=Look(None), panel=1))
    title = f"{_caption(result, step)}, y = {readable(line['y'].item(), 'm', 3)}"
    heights = (3, 1)[: len(axes)]
    return Chart(across, axes, series, title, shaded=shaded, heights=heights)


def cross_section(step: Dataset) -> Chart:
    """Return the indenter over the deformed surface along x, through its deepest point.

    ``step`` is one load step. Heights are above the undeformed surface.
    """
    sunk = np.nan_to_num(step["displacement"].transpose("x", "y").values, nan=-np.inf)
    line = step.isel(y=int(sunk.max(axis=0).argmax()))
    x, surface = line["x"].values, -line["displacement"].values
    height = Axis("height", "m", signed=True)
    if "gap" not in line:
        return Chart(Axis("x", "m"), [height], [Series(x, surface, name="surface")])
    gap = np.where(np.isfinite(line["gap"].values), line["gap"].values, np.nan)
    # Far from the contact a round body would set the scale.
    reach = 2 * max(float(np.ptp(surface)), abs(float(step["depth"])))
    indenter = np.where(gap <= reach, surface + gap, np.nan) if reach > 0 else surface + gap
    return Chart(
        Axis("x", "m"),
        [height],
        [
            Series(x, indenter, name="indenter", legend="indenter", look=Look(None, 1)),
            Series(x, surface, name="surface", legend="surface"),
        ],
    )


def _caption(result: Result, step: int) -> str:
    caption = label_of_step(result.dataset, step)
    title = result.dataset.attrs.get("title", "")
    if not bool(result.dataset["converged"][step]):
        caption += ", NOT CONVERGED"
    return f"{title}\n{caption}" if title else caption
