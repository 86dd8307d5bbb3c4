"""Power spectra of the indenter and of the displaced surface."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from pellicle import hookimpl
from pellicle.analysis import Spectrum, spectrum
from pellicle.components import Output
from pellicle.report.plotting import save_figure
from pellicle.results.derived import Runs
from pellicle.results.result import Result

from .base import Drawing, write_csv

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_STYLES = {"indenter": "--", "displacement": "-"}
_HEADS = "curve", "series", "wavenumber [rad/m]", "density [m4]", "wave_vectors"
_ROUND_OFF = 1e-24


class SpectrumOutput(Drawing):
    """Radially averaged power spectral densities of the indenter and of the displaced surface.

    `pellicle.analysis.spectrum` says how they are defined, and what a free boundary has them
    multiplied by. An indenter that ends within the domain has none. The numbers are written as CSV
    beside the figure, with the wave vectors in each ring: density times count, summed up and
    divided by the area of the domain, is the mean square.
    """

    type: Literal["spectrum"] = "spectrum"

    def draw(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure and its numbers."""
        found = [(name, _of(step)) for name, step in self.steps(runs)]

        def fill(axes: Axes) -> None:
            self._fill(axes, found)

        files = save_figure(lambda figure: fill(figure.add_subplot()), stem, self.formats)
        return (*files, write_csv(stem, list(_rows(found)), _HEADS))

    def _fill(self, axes: Axes, found: list[tuple[str, dict[str, Spectrum]]]) -> None:
        highest = max(
            (of.density.max(initial=0.0) for _, each in found for of in each.values()), default=0.0
        )
        for number, (name, each) in enumerate(found):
            for surface, of in each.items():
                # Rings that hold nothing but round-off would set the scale.
                shown = of.density > _ROUND_OFF * highest
                axes.plot(
                    of.wavenumber[shown],
                    of.density[shown],
                    _STYLES[surface],
                    color=f"C{number}",
                    linewidth=1.2,
                    label=name if name and surface == "displacement" else None,
                )
        for surface, style in _STYLES.items():
            axes.plot([], [], style, color="0.4", linewidth=1.2, label=surface)
        axes.set(
            xlabel="wavenumber q [rad/m]",
            ylabel="power spectral density [m⁴]",
            title=self.title,
        )
        if highest > 0:
            axes.set(xscale="log", yscale="log")
        axes.grid(alpha=0.3)
        axes.legend(frameon=False, fontsize="small")


def _of(step: xr.Dataset) -> dict[str, Spectrum]:
    displacement = step["displacement"].values
    surfaces = {
        "indenter": displacement - step["depth"].item() - step["gap"].values,
        "displacement": displacement,
    }
    grid = Result(step).grid
    return {
        name: spectrum(heights, grid)
        for name, heights in surfaces.items()
        if np.isfinite(heights).all()
    }


def _rows(found: list[tuple[str, dict[str, Spectrum]]]) -> Iterator[dict[str, object]]:
    for name, surfaces in found:
        for surface, of in surfaces.items():
            for row in zip(of.wavenumber, of.density, of.count, strict=True):
                yield dict(zip(_HEADS, (name, surface, *row), strict=True))


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the spectrum."""
    register(SpectrumOutput)
