"""The patches of contact and how large they are."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Literal

import numpy as np

from pellicle import analysis
from pellicle.arrays import Dataset
from pellicle.components import Axis, Chart, Fields, Look, Panel, Runs, Series, Shown, Table
from pellicle.results import Result

from .base import Label, TableFigure

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
    of_contact: ClassVar[bool] = True
    examples = ({"by": "step"},)

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield all patches, and the map of the last curve beside the numbers of patches."""
        rows, series, panels = self._found(runs)
        yield "", Table.of_rows(_HEADS, rows)
        sizes = Chart(
            Axis("area of a patch", "m2", log=True),
            [Axis("patches at least as large", log=True)],
            series,
            hues=len(series),
            ordered=self.is_ordered(runs),
        )
        yield "", [Fields(Axis("patch"), panels, self.title, parts=True), sizes]

    def _found(self, runs: Runs) -> tuple[list[tuple[object, ...]], list[Series], list[Panel]]:
        """Return the rows of all patches, their numbers over the area, and the last map.

        The labels of cells are large, and none outlives this.
        """
        rows, series, panels = list[tuple[object, ...]](), list[Series](), list[Panel]()
        for number, (name, step) in enumerate(self.steps(runs)):
            grid = Result(step).grid
            patches = analysis.patches(step["contact"], grid)
            rows += _rows(name, step, patches)
            rank, look = np.arange(1.0, patches.count + 1), Look(number, marker=number)
            series.append(Series(patches.area, rank, legend=name.words, look=look, stepped="post"))
            title, labels = f"{name.words}\n{patches.count} patches".lstrip(), patches.labels
            panels = [Panel(grid.size, labels.astype(np.int32), title, blank=labels == 0)]
        return rows, series, panels


def _rows(name: Label, step: Dataset, patches: analysis.Patches) -> Iterator[tuple[object, ...]]:
    grid = Result(step).grid
    pressure = step["pressure"].values.ravel()
    force = np.bincount(patches.labels.ravel(), pressure)[1:] * grid.cell_area
    neighbours = analysis.coordination(patches.labels, grid)
    for index, values in enumerate(zip(patches.area, force, neighbours, strict=True)):
        yield name.key, step["step"].item(), index + 1, *values
