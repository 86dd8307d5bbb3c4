"""A field over the domain, a panel for each run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from pellicle.components import Runs
from pellicle.results.derived import as_array
from pellicle.results.path import has_interaction
from pellicle.schema.expression import names_in
from pellicle.show.fields import diverging, outline_contact, show_field
from pellicle.show.style import NO_CONTACT, add_colour_bar
from pellicle.variables import WALL_PRESSURE, words_of_name

from .base import Label, TableFigure, scaled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_PANEL = 2.7
_COLUMNS = 4
_ONLY_IN_CONTACT = "pressure", WALL_PRESSURE


class Maps(TableFigure):
    """A field over the domain, one panel for each value of an axis.

    Other axes of a study are at their first value, steps at the last. ``field`` is
    arithmetic over the fields and numbers of a run: ``contact`` is drawn black on grey, and
    ``displacement - depth - gap`` is the profile of the indenter. Where an interaction pulls,
    colours of an expression with ``pressure`` are centred at 0, a line encloses the contact, and a
    dotted line the zone in which a traction acts.
    """

    numbers: ClassVar[bool] = False

    type: Literal["maps"] = "maps"
    examples = ({"field": "displacement - depth - gap", "name": "indenter"},)
    field: Annotated[str, Field(description="expression for what is drawn")] = "pressure"
    field_label: Annotated[str | None, Field(description="label of the colours")] = None

    def check(self, runs: Runs) -> None:
        """Refuse an axis, a label or a field that does not exist."""
        super().check(runs)
        list(self._panels(runs))

    def _panels(self, runs: Runs) -> Iterator[tuple[Label, xr.Dataset, xr.DataArray]]:
        import xarray as xr

        for name, run in self.steps(runs):
            # Truth values become numbers in arithmetic; alone they are drawn black on grey.
            field = run.get(self.field.strip())
            if field is None or field.dtype != bool:
                field = as_array(self.field, run)
            values, _ = xr.broadcast(field, run["contact"])
            yield name, run, values

    def write(self, runs: Runs, stem: Path) -> tuple[Path, ...]:
        """Write the figure."""
        panels = list(self._panels(runs))
        across = min(max(len(panels), 1), _COLUMNS)
        down = ceil(max(len(panels), 1) / across)
        size = (_PANEL * across + 1.2, _PANEL * down + 1.0) if len(panels) > 1 else (5.4, 4.2)
        return self.save(lambda figure: self._fill(figure, panels, down, across), stem, size)

    def _fill(
        self,
        figure: Figure,
        panels: list[tuple[Label, xr.Dataset, xr.DataArray]],
        down: int,
        across: int,
    ) -> None:
        all_axes = figure.subplots(down, across, squeeze=False).ravel()
        for axes in all_axes[len(panels) :]:
            axes.set_axis_off()
        if not panels:
            return
        fields = [field for *_, field in panels]
        is_bool, blank = fields[0].dtype == bool, self.field.strip() in _ONLY_IN_CONTACT
        factor, name = 1.0, ""
        if not is_bool:
            factor, name = scaled(self.field, fields, self.field_label, panels[0][1])
        pulls = any(has_interaction(run) for _, run, _ in panels) and not is_bool
        colours = self._colours(fields, factor, pulls=pulls)
        for axes, (title, run, field) in zip(all_axes, panels, strict=False):
            values_shown = field.transpose("y", "x").values * factor
            if blank:
                values_shown = np.ma.masked_where(values_shown == 0, values_shown)
                axes.set_facecolor(NO_CONTACT)
            nearest = "nearest" if is_bool else None
            image, length = show_field(axes, run, values_shown, interpolation=nearest, **colours)
            if pulls:
                outline_contact(run, axes, length)
            axes.set_title(title.words, fontsize="medium")
            axes.label_outer()
        if is_bool:
            from matplotlib.patches import Patch

            words = words_of_name(self.field.strip())
            patches = Patch(color="black"), Patch(color=NO_CONTACT)
            below: dict[str, Any] = {"loc": "outside lower center", "ncols": 2}
            figure.legend(patches, [words, f"no {words}"], fontsize="small", **below)
        else:
            add_colour_bar(all_axes[min(across, len(panels)) - 1], image, name)
        figure.suptitle(self.title)

    def _colours(
        self, fields: Sequence[xr.DataArray], factor: float, *, pulls: bool
    ) -> dict[str, Any]:
        """Return the colours of fields times ``factor``, as keywords of ``Axes.imshow``.

        ``pulls`` says whether an interaction acts in a run, so that a pressure may be negative.
        """
        from matplotlib.colors import ListedColormap

        if fields[0].dtype == bool:
            return {"cmap": ListedColormap([NO_CONTACT, "black"]), "vmin": 0.0, "vmax": 1.0}
        values = np.concatenate([field.values.ravel() for field in fields])
        values = values[np.isfinite(values)] * factor
        low, high = (values.min(), values.max()) if values.size else (0.0, 1.0)
        if pulls and low < 0 and "pressure" in names_in(self.field):
            return diverging(values)
        if low == high:
            # matplotlib would centre a scale without range on its only value.
            low, high = min(low, 0.0), max(high, 0.0 if low else 1.0)
        return {"cmap": "viridis", "vmin": low, "vmax": high}
