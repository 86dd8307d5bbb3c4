"""The compliance of the cells in Fourier space, beside the kernel's symbol."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import scipy.fft
from pydantic import Field

from pellicle import Run, displacement
from pellicle.arrays import Array
from pellicle.components import Runs
from pellicle.errors import StorageError
from pellicle.model.expression import evaluate
from pellicle.report.style import MARKERS, colour
from pellicle.results.derived import names

from .base import TableFigure, XYFigure, in_words, set_scales

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_MARKERS = 40
_WORDS = {"q": "wavenumber q"}
_HEADS = {"q": "wavenumber q [rad/m]", "compliance": "compliance [m/Pa]"}
"""Labels of axes that show a variable alone."""


class Compliance(XYFigure):
    """Compliance of the cells against the kernel's symbol, over the wavenumber.

    Markers are the Fourier transform of the displacement under a pressure on one cell, along x,
    divided by that of the pressure; lines are the kernel's formula. ``x`` and ``y`` are arithmetic
    over ``q`` [rad/m], ``compliance`` [m/Pa] and the numbers of the configuration; the numbers
    drawn are written as CSV beside the figure.
    """

    type: Literal["compliance"] = "compliance"
    x: Annotated[str, Field(description="expression for the horizontal axis")] = "q"
    y: Annotated[str, Field(description="expression for the vertical axis")] = "compliance"

    def check(self, runs: Runs) -> None:
        """Refuse an axis or a label that the table does not have; the kernels are left alone."""
        TableFigure.check(self, runs)

    def draw(self, axes: Axes, runs: Runs) -> Iterator[dict[str, object]]:
        """Draw the curves, and yield the rows of the numbers drawn."""
        curves, ordered = list(self.picked(runs.table)), self.is_ordered(runs)
        for number, (name, picked) in enumerate(curves):
            hue = colour(number, len(curves), ordered=ordered)
            try:
                configuration = runs.open(str(picked["run"].item())).attrs["configuration"]
            except StorageError:
                continue
            run = Run.from_json(configuration)
            q, cells = of_cells_along_x(run)
            # A grid with a single cell along x has no waves.
            marked = np.unique(np.geomspace(1, max(1, q.size), _MARKERS).astype(int)) - 1
            of_cells = self._columns(picked, q, cells)
            axes.plot(
                *of_cells,
                MARKERS[number % len(MARKERS)],
                color=hue,
                zorder=2,
                markersize=3.5,
                markerfacecolor="white",
                linestyle="none",
                markevery=list(marked),
                label=name.words or "cells",
            )
            of_symbol = self._columns(picked, q, run.kernel.compliance(q))
            axes.plot(*of_symbol, "-", color="black", zorder=1, linewidth=1.0)
            for series, columns in (("cells", of_cells), ("symbol", of_symbol)):
                for x, y in zip(*columns, strict=True):
                    yield {"curve": name.key, "series": series, "x": x, "y": y}
        axes.plot([], [], color="black", linewidth=1.0, label="symbol")
        x_label, y_label = (
            _HEADS.get(text) or in_words(text, runs.table, _WORDS) for text in (self.x, self.y)
        )
        axes.set(xlabel=self.x_label or x_label, ylabel=self.y_label or y_label, title=self.title)
        set_scales(axes, ("x", "y"))
        axes.legend(frameon=False, fontsize="small")

    def _columns(self, picked: xr.Dataset, q: Array, values: Array) -> tuple[Array, Array]:
        variables = {**names(picked), "q": q, "compliance": values}
        x, y = (np.asarray(evaluate(text, variables)) + 0 * q for text in (self.x, self.y))
        return x, y


def of_cells_along_x(run: Run) -> tuple[Array, Array]:
    """Return wavenumbers q > 0 along x [rad/m] and the compliance of the cells there [m/Pa].

    The compliance is the discrete Fourier transform of the displacement under a unit pressure on
    the cell in the middle, cut off at half of the domain on each side. On a free boundary it
    oscillates about the symbol by about s/L, where s is the length of the tension and L the domain.
    """
    middle = tuple(n // 2 for n in run.grid.shape)
    pressure = np.zeros(run.grid.shape)
    pressure[middle] = 1.0
    response = displacement(pressure, kernel=run.kernel, grid=run.grid)
    along_x = np.roll(response.sum(axis=1), -middle[0])
    values = scipy.fft.rfft(along_x).real[1:]
    # The last wavenumber of an even number of cells is listed as negative.
    return np.abs(run.grid.wavenumbers()[0].ravel()[1 : values.size + 1]), values
