"""Distributions of contact pressure and gap."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle import analysis
from pellicle.arrays import Dataset
from pellicle.components import Axis, Chart, Look, Runs, Series, Shown, Table
from pellicle.results import has_interaction
from pellicle.units import axis_unit

from .base import Label, Log, TableFigure

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
    of_contact: ClassVar[bool] = True
    examples = ({"bins": 10, "log": ["y"]},)
    bins: int = Field(50, ge=1, description="number of bins, from 0 to the highest")
    log: Log = ()

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield both densities side by side, and the bins."""
        curves = [(name, self._densities(step)) for name, step in self.steps(runs)]
        yield "", [self._chart(field, unit, curves, runs) for field, unit in _FIELDS.items()]
        rows = [
            (name.key, field, *row)
            for name, densities in curves
            for field, bins in densities.items()
            for row in zip(bins.edges, bins.edges[1:], bins.mean, bins.density, strict=False)
        ]
        yield "", Table.of_rows(_HEADS, rows)

    def _chart(self, field: str, unit: str, curves: _Curves, runs: Runs) -> Chart:
        edges = [densities[field].edges for _, densities in curves]
        # One unit for both axes: the density is per unit of the field.
        scale = axis_unit(np.concatenate([*edges, np.zeros(1)]), unit)
        series = []
        for number, (name, densities) in enumerate(curves):
            x = np.repeat(densities[field].edges, 2) * scale.factor
            y = np.repeat(densities[field].density, 2) / scale.factor
            look = Look(number, number)
            series.append(Series(x, np.pad(y, 1), legend=name.words, look=look))
        return Chart(
            Axis(f"{field} [{scale.unit}]", as_given=True, log="x" in self.log),
            [Axis(f"probability density [1/{scale.unit}]", as_given=True, log="y" in self.log)],
            series,
            self.title,
            hues=len(curves),
            ordered=self.is_ordered(runs),
        )

    def _densities(self, step: Dataset) -> dict[str, analysis.Distribution]:
        contact = step["contact"].values
        acts = contact | (step["pressure"].values != 0) if has_interaction(step) else contact
        cells = {"pressure": acts, "gap": ~contact}
        return {
            name: analysis.distribution(step[name].values[cells[name]], self.bins)
            for name in _FIELDS
        }
