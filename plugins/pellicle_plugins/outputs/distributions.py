"""How contact pressure and gap are distributed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from pellicle import hookimpl
from pellicle.analysis import Distribution, distribution
from pellicle.components import Output
from pellicle.report.plotting import save_figure
from pellicle.results.derived import Runs
from pellicle.units import axis_unit

from .base import Drawing, Log, set_scales, write_csv

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_SIZE = 10.0, 4.2
_HEADS = "curve", "series", "lower", "upper", "mean", "density"
_FIELDS = {"pressure": "Pa", "gap": "m"}


class Distributions(Drawing):
    """Probability densities of the pressure in contact and of the gap outside it.

    Each counts the cells of its own part and integrates to 1. The bins are written as CSV beside
    the figure, with the mean of the values in each: mean pressure times density times width, summed
    up and multiplied by the contact area, is the force. Infinite gaps do not count.
    """

    type: Literal["distributions"] = "distributions"
    bins: Annotated[int, Field(ge=1, description="number of bins, from 0 to the highest")] = 50
    log: Log = ()

    def draw(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure and its numbers."""
        found = [(name, self._of(step)) for name, step in self.steps(runs)]
        files = save_figure(lambda figure: self._fill(figure, found), stem, self.formats, _SIZE)
        return (*files, write_csv(stem, list(_rows(found)), _HEADS))

    def _of(self, step: xr.Dataset) -> dict[str, Distribution]:
        contact = step["contact"].values
        where = {"pressure": contact, "gap": ~contact}
        return {name: distribution(step[name].values[where[name]], self.bins) for name in _FIELDS}

    def _fill(self, figure: Figure, found: list[tuple[str, dict[str, Distribution]]]) -> None:
        for axes, (field, unit) in zip(figure.subplots(1, 2), _FIELDS.items(), strict=True):
            edges = [each[field].edges for _, each in found]
            factor, name = axis_unit(np.concatenate([*edges, np.zeros(1)]), unit)
            for said, each in found:
                density = each[field].density / factor
                axes.stairs(density, each[field].edges * factor, label=said or None)
            axes.set(xlabel=f"{field} [{name}]", ylabel=f"probability density [1/{name}]")
            set_scales(axes, self.log if any(each.size > 1 for each in edges) else ())
            if axes.get_legend_handles_labels()[1]:
                axes.legend(frameon=False, fontsize="small")
        figure.suptitle(self.title)


def _rows(found: list[tuple[str, dict[str, Distribution]]]) -> Iterator[dict[str, object]]:
    for name, fields in found:
        for field, of in fields.items():
            for row in zip(of.edges, of.edges[1:], of.mean, of.density, strict=False):
                yield dict(zip(_HEADS, (name, field, *row), strict=True))


@hookimpl
def register_outputs(register: Callable[[type[Output]], None]) -> None:
    """Register the distributions."""
    register(Distributions)
