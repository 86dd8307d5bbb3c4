"""Captions of the maps and the set-up on the page of a run or a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pellicle.config.describe import inputs
from pellicle.config.run import Run
from pellicle.results.path import prescribed_variable
from pellicle.results.wording import column_of

if TYPE_CHECKING:
    import xarray as xr


def caption_of_steps(data: xr.Dataset, fields: Sequence[str], shown: int) -> str:
    """Return the caption of maps of some fields in as many load steps as are ``shown``."""
    *first, last = fields
    names = f"{', '.join(first)} and {last}".capitalize()
    # Over the range of the last step the first ones would have one colour.
    colours = ", each in colours over its own range" if shown > 1 else ""
    words = column_of(data[prescribed_variable(data)]).words
    steps = _share(shown, data.sizes["step"], "load step")
    return f"{names} at prescribed {words}, in {steps}{colours}."


def caption_of_runs(table: xr.Dataset, shown: int) -> str:
    """Return the caption of maps of as many runs as are ``shown``."""
    runs = _share(shown, table["run"].size, "run")
    return f"The last step in contact of {runs}, each in colours over its own range."


def caption_of_setup(configuration: Mapping[str, Any], label: str) -> str:
    """Return the caption of the indenter over the surface in a load step."""
    values = {i.name: i.value for i in inputs(configuration, Run)}
    return f"The {values['indenter']} on the {values['kernel']}, at {label}; heights stretched."


def _share(number: int, count: int, noun: str) -> str:
    """Return how many are shown in words: "each run", "3 of 8 runs"."""
    return f"each {noun}" if number == count else f"{number} of {count} {noun}s"
