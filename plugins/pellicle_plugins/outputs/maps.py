"""A field over the domain, a panel for each run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Literal

from pydantic import Field

from pellicle.arrays import Mask
from pellicle.components import Axis, Fields, Panel, Runs, Shown
from pellicle.results import Result, as_array, has_interaction
from pellicle.schema import names_in
from pellicle.show import contact_and_zone
from pellicle.variables import WALL_PRESSURE, words_of_name

from .base import TableFigure, axis_of

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
    field: str = Field("pressure", description="expression for what is drawn")
    field_label: str | None = Field(None, description="label of the colours")

    def charts(self, runs: Runs) -> Iterator[tuple[str, Shown]]:
        """Yield the maps."""
        import xarray as xr

        panels, pulls = list[Panel](), False
        text = self.field.strip()
        for name, run in self.steps(runs):
            # Truth values become numbers in arithmetic; alone they are drawn black on grey.
            field = run.get(text)
            if field is None or field.dtype != bool:
                field = as_array(text, run)
            values, _ = xr.broadcast(field, run["pressure"])
            outlines: list[Mask] = []
            if has_interaction(run) and values.dtype != bool:
                outlines, pulls = contact_and_zone(run), True
            cells = values.transpose("x", "y").values
            blank = cells == 0 if text in _ONLY_IN_CONTACT else None
            panels.append(Panel(Result(run).grid.size, cells, name.words, blank, outlines))
        axis = Axis(self.field_label or words_of_name(text))
        if panels and panels[0].values.dtype != bool:
            axis = axis_of(text, self.field_label, run)
        centred = pulls and "pressure" in names_in(text)
        yield "", Fields(axis, panels, self.title, centred=centred)
