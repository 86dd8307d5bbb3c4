"""The patches of contact and how large they are."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle import analysis
from pellicle.components import Runs
from pellicle.results.result import Result
from pellicle.show.fields import show_field
from pellicle.show.style import MARKERS, NO_CONTACT, colour
from pellicle.units import axis_unit

from .base import Label, TableFigure, add_legend, write_csv

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE = 10.0, 4.2
_HEADS = "curve", "step", "patch", "area [m2]", "force [N]", "neighbours"


class Patches(TableFigure):
    """Map of the contact patches, and the number of patches that are larger than an area.

    Cells in contact that share an edge belong to one patch, on a periodic grid also across the edge
    of the domain. The map is that of the last curve. The patches are written as CSV beside the
    figure, the largest first: area, force and number of neighbours, which
    `pellicle.analysis.coordination` counts. The force of a patch is that of its own cells; the pull
    of an interaction on the cells around it belongs to none.
    """

    type: Literal["patches"] = "patches"
    examples = ({"connectivity": 8, "by": "step"},)
    connectivity: Annotated[
        Literal[4, 8],
        Field(
            description="8: cells that share a corner belong to one patch too; the number of "
            "patches in the table is that for 4"
        ),
    ] = 4

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure and its numbers."""
        curves = [
            (name, step, analysis.patches(step["contact"], Result(step).grid, self.connectivity))
            for name, step in self.steps(runs)
        ]
        files = self.save(
            lambda figure: self._fill(figure, curves, self.is_ordered(runs)), stem, _SIZE
        )
        return (*files, write_csv(stem, _HEADS, (row for curve in curves for row in _rows(*curve))))

    def _fill(
        self,
        figure: Figure,
        curves: list[tuple[Label, xr.Dataset, analysis.Patches]],
        ordered: bool,
    ) -> None:
        left, right = figure.subplots(1, 2)
        if curves:
            _map(left, *curves[-1])
        largest = [patches.area[0] for *_, patches in curves if patches.count]
        factor, unit = axis_unit(np.array(largest), "m2")
        for number, (name, _, patches) in enumerate(curves):
            rank = np.arange(1, patches.count + 1)
            right.step(
                patches.area * factor,
                rank,
                where="post",
                color=colour(number, len(curves), ordered=ordered),
                marker=MARKERS[number % len(MARKERS)],
                markersize=3,
                label=name.words or None,
            )
        right.set(xlabel=f"area of a patch [{unit}]", ylabel="patches at least as large")
        if largest:
            right.set(xscale="log", yscale="log")
        right.grid(alpha=0.3)
        add_legend(right)
        figure.suptitle(self.title)


def _map(axes: Axes, name: Label, step: xr.Dataset, patches: analysis.Patches) -> None:
    """Draw the patches in 20 colours, used in turn."""
    shown = np.ma.masked_equal(patches.labels.T, 0) % 20
    show_field(axes, step, shown, cmap="tab20", interpolation="nearest")
    axes.set_facecolor(NO_CONTACT)
    axes.set_title(f"{name.words}\n{patches.count} patches".lstrip(), fontsize="medium")


def _rows(name: Label, step: xr.Dataset, patches: analysis.Patches) -> Iterator[tuple[object, ...]]:
    grid = Result(step).grid
    pressure = step["pressure"].values.ravel()
    force = np.bincount(patches.labels.ravel(), pressure)[1:] * grid.cell_area
    neighbours = analysis.coordination(patches.labels, grid)
    for index, values in enumerate(zip(patches.area, force, neighbours, strict=True)):
        yield name.key, step["step"].item(), index + 1, *values
