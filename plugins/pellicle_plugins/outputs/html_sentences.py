"""The sentences of the page of a run or a study: its results, and what its maps show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pellicle.arrays import Array, DataArray, Dataset
from pellicle.components import Column
from pellicle.results import (
    axes_of,
    column_of,
    has_interaction,
    has_load,
    has_one_shape,
    has_times,
    is_periodic,
    label_of_step,
    prescribed_variable,
)
from pellicle.units import readable
from pellicle.variables import VARIABLES

_DIGITS = 3
_FEW = 5
"""Number of runs up to which the sentence of a study lists their numbers."""
_AIMS = (
    ("storage_stiffness", "loss_stiffness", "phase", "oscillation_frequency"),
    ("pull_off", "pull_off_depth"),
)
"""Variables of a whole path that a run is made for, each group in a sentence."""
_COLUMNS = {"pull_off": "force", "pull_off_depth": "depth"}
"""The numbers of steps whose unit they share."""
_OF_LOAD = "ridge_height", "ridge_width", "dimple_depth"
"""The numbers of a step under a load."""
_SAME = 1e-9
"""Relative difference up to which numbers count as equal."""


def sentence_of_step(data: Dataset, index: int) -> str:
    """Return a sentence like "At depth 3 µm: force 904 nN, contact radius 4.5 µm" for a load step.

    A contact in several parts has its fraction of a periodic domain, or its area on a free one,
    instead of its radius.
    """
    step = data.isel(step=index)
    heading = f"At {label_of_step(data, index)}"
    if not np.isfinite(step["force"].item()):
        return f"{heading}: no result."
    if has_load(data):
        names = [name for name in _OF_LOAD if np.isfinite(step[name].item())]
        parts = [replace(column_of(data[n]), digits=_DIGITS).text(step[n].item()) for n in names]
        return f"{heading}: {', '.join(parts)}."
    size = "contact_fraction" if is_periodic(data) else "contact_area"
    if has_one_shape(data) and "contact_radius" in data:
        size = "contact_radius"
    named = prescribed_variable(data)
    names = [name for name in ("force", "depth", size) if name != named]
    if named == "depth" or has_times(data):
        names = [name for name in names if name != "depth"]
    if step["contact_area"].item() <= 0:
        names = [name for name in names if name != size]
    # In the unit of all steps, as the tables and curves.
    parts = [replace(column_of(data[n]), digits=_DIGITS).text(step[n].item()) for n in names]
    parts += ["no contact"] if step["contact_area"].item() <= 0 else []
    marked = "" if step["converged"].item() else " (NOT CONVERGED)"
    return f"{heading}: {', '.join(parts)}{marked}."


def aim_of_path(data: Dataset, summary: Mapping[str, float]) -> str:
    """Return what a path is made for: complex stiffness, pull-off, the force of a hold; or ""."""
    sentences = []
    for names in _AIMS:
        if all(np.isfinite(summary.get(name, np.nan)) for name in names):
            texts = [_text_of(name, summary[name], data) for name in names]
            sentences.append(f"{texts[0][0].upper()}{', '.join(texts)[1:]}.")
    force, prescribed = data["force"], data[prescribed_variable(data)]
    is_held = has_times(data) and prescribed.size > 1 and prescribed[-1] == prescribed[-2]
    if is_held and prescribed.name != "force" and not sentences and not has_interaction(data):
        peak = int(np.nanargmax(np.append(force.values, -np.inf)))
        (first, held), shown = force.values[[peak % force.size, -1]], column_of(force)
        after = [readable(data["time"].values[n].item(), "s", _DIGITS) for n in (peak, -1)]
        texts = [replace(shown, digits=_DIGITS).text(value) for value in (first, held)]
        sentences.append(
            f"F{texts[0][1:]} at its peak, after {after[0]}; "
            f"{texts[1]} at the end of the hold, after {after[1]}."
        )
    return " ".join(sentences)


def range_of_path(data: Dataset) -> str:
    """Return the range of the force over the load steps; empty for one, and with adhesion."""
    steps = data.sizes["step"]
    is_one = steps == 1 or has_interaction(data)
    if has_load(data) and steps > 1:
        return f"Over {steps} load steps: {_range(data['ridge_height'])}."
    return "" if is_one else f"Over {steps} load steps: {_range(data['force'])}."


def _text_of(name: str, value: float, data: Dataset) -> str:
    """Return a number of a path in words, in the unit of the column of the steps that has it."""
    variable = VARIABLES[name]
    shown = Column(variable.words, [value], variable.unit)
    if name in _COLUMNS:
        shown = replace(column_of(data[_COLUMNS[name]]), words=variable.words)
    return replace(shown, digits=_DIGITS).text(value)


def sentence_of_study(table: Dataset, count: int) -> str:
    """Return the results of a study in its last step; empty if there is none.

    Of force, depth and contact radius, the one that all runs share there, if any, comes first.
    """
    axes = [
        f"{axis.words} {axis.listing}"
        for axis in (column_of(table[name]) for name in axes_of(table))
    ]
    over = f" with {'; '.join(axes)}" if axes else ""
    end = table.isel(step=-1)
    names = ["depth", "force", *["contact_radius"] * has_one_shape(table)]
    names = [*_OF_LOAD] if has_load(table) else names
    known = [name for name in names if name in end and np.isfinite(end[name].values).any()]
    shared = [name for name in known if _is_one_value(end[name].values)][:1]
    results = [_values(end[name], count) for name in known if name not in shared][:2]
    if not results:
        return ""
    at = f"at {_values(end[shared[0]], count)}" if shared else "in the last step"
    return f"{count} runs{over}; {at}: {', '.join(results)}."


def _is_one_value(values: Array) -> bool:
    finite = values[np.isfinite(values)]
    return bool(np.ptp(finite) <= _SAME * np.abs(finite).max())


def _values(variable: DataArray, count: int) -> str:
    """Return the values of a few runs in their order, the range of many."""
    values = variable.values.ravel()
    if count > _FEW or variable.ndim > 1 or not np.isfinite(values).all() or _is_one_value(values):
        return _range(variable)
    shown = replace(column_of(variable), digits=_DIGITS)
    return f"{shown.words} {shown.listing}"


def _range(variable: DataArray) -> str:
    shown = replace(column_of(variable), digits=_DIGITS)
    finite = variable.values[np.isfinite(variable.values)]
    if not finite.size:
        return f"no {shown.words}"
    low, high = shown.number(finite.min().item()), shown.number(finite.max().item())
    if low == high:
        return f"{shown.words} {shown.scale.with_unit(low)}"
    return f"{shown.words} from {low} to {shown.scale.with_unit(high)}"


def caption_of_steps(data: Dataset, fields: Sequence[str], shown: int) -> str:
    """Return the caption of maps of some fields in as many load steps as are ``shown``."""
    *first, last = fields
    names = f"{', '.join(first)} and {last}".capitalize()
    # Over the range of the last step the first ones would have one colour.
    colours = ", each in colours over its own range" if shown > 1 else ""
    words = column_of(data[prescribed_variable(data)]).words
    steps = _share(shown, data.sizes["step"], "load step")
    return f"{names} at prescribed {words}, in {steps}{colours}."


def caption_of_runs(table: Dataset, shown: int) -> str:
    """Return the caption of maps of as many runs as are ``shown``."""
    runs = _share(shown, table["run"].size, "run")
    return f"The last step in contact of {runs}, each in colours over its own range."


def _share(number: int, count: int, noun: str) -> str:
    """Return how many are shown in words: "each run", "3 of 8 runs"."""
    return f"each {noun}" if number == count else f"{number} of {count} {noun}s"
