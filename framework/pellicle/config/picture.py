"""A small picture of the indenters of runs, by their true profiles."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from io import BytesIO

import numpy as np

from pellicle.arrays import Array
from pellicle.components.calls import profile_of
from pellicle.errors import ConfigError, PluginError
from pellicle.report.style import OKABE_ITO, FigureStyle
from pellicle.units import axis_unit

from .run import Run

_CELLS = 512
"""Cells along an edge up to which the indenter is drawn on the grid of the run."""
_SIZE = (3.2, 1.6)
_DOTS_PER_INCH = 80


def picture_of(runs: Sequence[Run]) -> bytes:
    """Return the distinct indenters of runs, cut along x through their lowest points, as PNG.

    It is empty if an indenter cannot be drawn, or is tied to a grid that takes long.
    """
    from matplotlib.figure import Figure

    with suppress(ConfigError, PluginError):
        lines = list(_profiles(runs))
        if not lines:
            return b""
        length, unit = axis_unit(np.concatenate([x for x, _ in lines]), "m")
        heights = np.concatenate([z for _, z in lines])
        # A flat punch has no height.
        height, height_unit = axis_unit(heights, "m") if np.nanmax(heights) else (length, unit)
        with FigureStyle().applied(), BytesIO() as file:
            figure = Figure(figsize=_SIZE, layout="constrained")
            axes = figure.subplots()
            for (x, z), colour in zip(lines, OKABE_ITO, strict=False):
                axes.plot(x * length, z * height, color=colour)
            axes.axhline(0, color="0.4", linewidth=0.8, linestyle="--")
            axes.set(xlabel=f"x [{unit}]", ylabel=f"indenter [{height_unit}]")
            figure.savefig(file, format="png", dpi=_DOTS_PER_INCH)
            return file.getvalue()
    return b""


def _profiles(runs: Sequence[Run]) -> Iterator[tuple[Array, Array]]:
    """Yield x and height above the lowest point [m] of the distinct indenters."""
    drawn: list[tuple[str, object]] = []
    for run in runs:
        key = run.indenter.model_dump_json(), run.grid
        if key in drawn or len(drawn) == len(OKABE_ITO):
            continue
        drawn.append(key)
        grid = run.grid
        if max(grid.points) > _CELLS:
            if run.indenter.footprint == "domain":
                continue
            share = _CELLS / max(grid.points)
            points = tuple(max(1, math.ceil(n * share)) for n in grid.points)
            grid = grid.model_copy(update={"points": points})
        profile = profile_of(run.indenter, grid)
        _, lowest = np.unravel_index(np.argmax(profile), profile.shape)
        height = -profile[:, lowest]
        yield grid.coordinates()[0][:, 0], np.where(np.isfinite(height), height, np.nan)
