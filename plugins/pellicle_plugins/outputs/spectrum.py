"""Power spectra of the indenter and of the displaced surface."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pellicle import analysis
from pellicle.components import Runs
from pellicle.results.result import Result
from pellicle.show.style import colour, sparse_marker

from .base import Label, TableFigure, write_csv

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_STYLES = {"indenter": "--", "displacement": "-"}
_HEADS = "curve", "series", "wavenumber [rad/m]", "density [m4]", "wave_vectors"
_ROUND_OFF = 1e-18
"""Density over the highest below which a ring holds round-off: waves 1e-9 times as high."""
_Curves = list[tuple[Label, dict[str, analysis.Spectrum]]]


class Spectrum(TableFigure):
    """Radially averaged power spectral densities of the indenter and of the displaced surface.

    `pellicle.analysis.spectrum` defines them, and the window used on a free boundary. An indenter
    that ends within the domain has no spectrum. The numbers are written as CSV beside the figure,
    with the number of wave vectors in each ring: density times number, summed up and divided by the
    area of the domain, is the mean square.
    """

    type: Literal["spectrum"] = "spectrum"
    examples = ({"by": "step", "label": "{depth * 1e6} µm"},)

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure and its numbers."""
        curves = [(name, _spectra(step)) for name, step in self.steps(runs)]
        files = self.save(
            lambda figure: self._fill(figure.add_subplot(), curves, self.is_ordered(runs)), stem
        )
        rows = (
            (name.key, surface, *row)
            for name, spectra in curves
            for surface, part in spectra.items()
            for row in zip(part.wavenumber, part.density, part.count, strict=True)
        )
        return (*files, write_csv(stem, _HEADS, rows))

    def _fill(self, axes: Axes, curves: _Curves, ordered: bool) -> None:
        highest = max(
            (part.density.max(initial=0.0) for _, spectra in curves for part in spectra.values()),
            default=0.0,
        )
        for number, (name, spectra) in enumerate(curves):
            hue = colour(number, len(curves), ordered=ordered)
            for surface, spectrum in spectra.items():
                shared: dict[str, Any] = {"color": hue, "linewidth": 1.2}
                if surface == "displacement":
                    shared["label"] = name.words or None
                    shared |= sparse_marker(number) if len(curves) > 1 else {}
                visible = spectrum.density > _ROUND_OFF * highest
                x, y = spectrum.wavenumber[visible], spectrum.density[visible]
                axes.plot(x, y, _STYLES[surface], **shared)
        hue = "0.4" if len(curves) > 1 else "C0"
        for surface, style in _STYLES.items():
            axes.plot([], [], style, color=hue, linewidth=1.2, label=surface)
        axes.set(
            xlabel="wavenumber q [rad/m]", ylabel="power spectral density [m⁴]", title=self.title
        )
        if highest > 0:
            axes.set(xscale="log", yscale="log")
        axes.grid(alpha=0.3)
        axes.legend(frameon=False, fontsize="small")


def _spectra(step: xr.Dataset) -> dict[str, analysis.Spectrum]:
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
