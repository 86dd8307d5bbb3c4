"""The patches of contact and how large they are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle import analysis, hookimpl
from pellicle.components import Output
from pellicle.report.plotting import extent, save_figure
from pellicle.results.derived import Runs
from pellicle.results.result import Result
from pellicle.units import axis_unit

from .base import Drawing, write_csv

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pellicle.analysis import Patches

_SIZE = 10.0, 4.2
_HEADS = "curve", "step", "patch", "area [m2]", "force [N]", "neighbours"


class PatchesOutput(Drawing):
    """Patches of contact, the last that is drawn as a map, and how many are larger than an area.

    Cells in contact that share an edge are of one patch; on a periodic grid also across the edge
    of the domain. Each patch is written as CSV beside the figure, the largest first: its area, its
    force and its number of neighbours, as `pellicle.analysis.coordination` counts them.
    """

    type: Literal["patches"] = "patches"
    connectivity: Annotated[
        Literal[4, 8],
        Field(
            description="8: cells that share a corner are of one patch too; the number of patches "
            "in the table is that of 4"
        ),
    ] = 4

    def draw(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure and its numbers."""
        found = [(name, step, self._patches(step)) for name, step in self.steps(runs)]
        files = save_figure(lambda figure: self._fill(figure, found), stem, self.formats, _SIZE)
        rows = [row for each in found for row in _rows(*each)]
        return (*files, write_csv(stem, rows, _HEADS))

    def _patches(self, step: xr.Dataset) -> Patches:
        return analysis.patches(step["contact"], Result(step).grid, self.connectivity)

    def _fill(self, figure: Figure, found: list[tuple[str, xr.Dataset, Patches]]) -> None:
        beside, curves = figure.subplots(1, 2)
        if found:
            _map(beside, *found[-1])
        largest = [each.area[0] for *_, each in found if each.count]
        factor, name = axis_unit(np.array(largest), "m2")
        for said, _, each in found:
            rank = np.arange(1, each.count + 1)
            curves.step(each.area * factor, rank, where="post", marker=".", label=said or None)
        curves.set(xlabel=f"area of a patch [{name}]", ylabel="patches at least as large")
        if largest:
            curves.set(xscale="log", yscale="log")
        curves.grid(alpha=0.3)
        if curves.get_legend_handles_labels()[1]:
            curves.legend(frameon=False, fontsize="small")
        figure.suptitle(self.title)


def _map(axes: Axes, name: str, step: xr.Dataset, found: Patches) -> None:
    """Draw each patch in a colour of its own, as far as there are enough."""
    length, unit = axis_unit(np.append(step["x"].values, step["y"].values), "m")
    axes.imshow(
        np.ma.masked_equal(found.labels.T, 0) % 20,
        origin="lower",
        extent=extent(step["x"].values * length, step["y"].values * length),
        cmap="tab20",
        interpolation="nearest",
        interpolation_stage="data",
    )
    axes.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
    axes.set_title(f"{name}\n{found.count} patches".lstrip(), fontsize="medium")


def _rows(name: str, step: xr.Dataset, found: Patches) -> Iterator[dict[str, object]]:
    grid = Result(step).grid
    force = np.bincount(found.labels.ravel(), step["pressure"].values.ravel())[1:] * grid.cell_area
    neighbours = analysis.coordination(found.labels, grid)
    for index, values in enumerate(zip(found.area, force, neighbours, strict=True)):
        yield dict(zip(_HEADS, (name, step["step"].item(), index + 1, *values), strict=True))


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the patches."""
    register(PatchesOutput)
