"""Power spectra of the indenter and of the displaced surface."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Literal

import numpy as np

from pellicle import analysis
from pellicle.arrays import Dataset
from pellicle.components import Axis, Chart, Look, Runs, Series, Shown, Table
from pellicle.results import Result

from .base import TableFigure

_LINES = {"indenter": 1, "displacement": 0}
_HEADS = "curve", "series", "wavenumber [rad/m]", "density [m4]", "wave_vectors"
_ROUND_OFF = 1e-18
"""Density over the highest below which a ring holds round-off: waves 1e-9 times as high."""


class Spectrum(TableFigure):
    """Radially averaged power spectral densities of the indenter and of the displaced surface.

    `pellicle.analysis.spectrum` defines them, and the window used on a free boundary. An indenter
    that ends within the domain has no spectrum. The numbers are written as CSV beside the figure,
    with the number of wave vectors in each ring: density times number, summed up and divided by the
    area of the domain, is the mean square.
    """

    type: Literal["spectrum"] = "spectrum"
    of_contact: ClassVar[bool] = True
    examples = ({"by": "step", "label": "{depth * 1e6} µm"},)

    def check(self, runs: Runs) -> None:
        """Refuse an axis or a label that the table does not have; four cells are no grid."""
        list(self.points_of_runs(runs))

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield the spectra, and the numbers of all rings."""
        curves = [(name, _spectra(step)) for name, step in self.steps(runs)]
        highest = max(
            (part.density.max(initial=0.0) for _, spectra in curves for part in spectra.values()),
            default=0.0,
        )
        many, series, rows = len(curves) > 1, list[Series](), list[tuple[object, ...]]()
        for hue, (name, spectra) in enumerate(curves):
            for surface, part in spectra.items():
                resolved = part.density > _ROUND_OFF * highest
                is_surface = surface == "displacement"
                look = Look(hue, _LINES[surface], hue if is_surface and many else None, sparse=True)
                legend = name.words if is_surface else ""
                points = part.wavenumber[resolved], part.density[resolved]
                series.append(Series(*points, legend=legend, look=look))
                numbers = zip(part.wavenumber, part.density, part.count, strict=True)
                rows += [(name.key, surface, *row) for row in numbers]
        for surface, line in _LINES.items():
            look = Look(None if many else 0, line)
            series.append(Series(np.empty(0), np.empty(0), legend=surface, look=look))
        x = Axis("wavenumber q [rad/m]", as_given=True, log=True)
        y = Axis("power spectral density [m⁴]", as_given=True, log=True)
        hues, ordered = len(curves), self.is_ordered(runs)
        yield "", Table.of_rows(_HEADS, rows)
        yield "", Chart(x, [y], series, self.title, hues=hues, ordered=ordered)


def _spectra(step: Dataset) -> dict[str, analysis.Spectrum]:
    displacement = step["displacement"].values
    surfaces = {
        "indenter": displacement - step["depth"].item() - step["gap"].values,
        "displacement": displacement,
    }
    grid = Result(step).grid
    return {
        name: analysis.spectrum(heights, grid)
        for name, heights in surfaces.items()
        if np.isfinite(heights).all()
    }
