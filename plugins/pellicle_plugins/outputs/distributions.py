"""Distributions of contact pressure and gap."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle import analysis
from pellicle.components import Runs
from pellicle.results.path import has_interaction
from pellicle.show.style import LINES, colour
from pellicle.units import axis_unit

from .base import Label, Log, TableFigure, add_legend, set_scales, write_csv

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_SIZE = 10.0, 4.2
_HEADS = "curve", "series", "lower", "upper", "mean", "density"
_FIELDS = {"pressure": "Pa", "gap": "m"}
_Curves = list[tuple[Label, dict[str, analysis.Distribution]]]


class Distributions(TableFigure):
    """Probability densities of the pressure in contact and of the gap outside it.

    Each is over the cells of its own part and integrates to 1; infinite gaps are left out. The bins
    are written as CSV beside the figure, with the mean of the values in each: mean pressure times
    density times width, summed up and multiplied by the contact area, is the force. With an
    interaction the pressure is that of all cells with a traction, and their area takes the place of
    the contact area.
    """

    type: Literal["distributions"] = "distributions"
    examples = ({"bins": 10, "log": ["y"]},)
    bins: Annotated[int, Field(ge=1, description="number of bins, from 0 to the highest")] = 50
    log: Log = ()

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure and its numbers."""
        curves = [(name, self._densities(step)) for name, step in self.steps(runs)]
        files = self.save(
            lambda figure: self._fill(figure, curves, self.is_ordered(runs)), stem, _SIZE
        )
        rows = (
            (name.key, field, *row)
            for name, densities in curves
            for field, bins in densities.items()
            for row in zip(bins.edges, bins.edges[1:], bins.mean, bins.density, strict=False)
        )
        return (*files, write_csv(stem, _HEADS, rows))

    def _densities(self, step: xr.Dataset) -> dict[str, analysis.Distribution]:
        contact = step["contact"].values
        acts = contact | (step["pressure"].values != 0) if has_interaction(step) else contact
        cells = {"pressure": acts, "gap": ~contact}
        return {
            name: analysis.distribution(step[name].values[cells[name]], self.bins)
            for name in _FIELDS
        }

    def _fill(self, figure: Figure, curves: _Curves, ordered: bool) -> None:
        for axes, (field, unit) in zip(figure.subplots(1, 2), _FIELDS.items(), strict=True):
            edges = [densities[field].edges for _, densities in curves]
            factor, name = axis_unit(np.concatenate([*edges, np.zeros(1)]), unit)
            for number, (curve, densities) in enumerate(curves):
                axes.stairs(
                    densities[field].density / factor,
                    densities[field].edges * factor,
                    color=colour(number, len(curves), ordered=ordered),
                    linestyle=LINES[number % len(LINES)],
                    label=curve.words or None,
                )
            axes.set(xlabel=f"{field} [{name}]", ylabel=f"probability density [1/{name}]")
            set_scales(axes, self.log if any(bins.size > 1 for bins in edges) else ())
            add_legend(axes)
        figure.suptitle(self.title)
