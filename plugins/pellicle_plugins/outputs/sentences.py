"""The result of a run or a study in a sentence or two."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array
from pellicle.results.path import has_interaction, has_times, label_of_step, prescribed_variable
from pellicle.results.wording import has_one_shape, is_periodic, wording
from pellicle.units import readable
from pellicle.variables import VARIABLES

if TYPE_CHECKING:
    import xarray as xr

_DIGITS = 3
_FEW = 5
"""Number of runs up to which the sentence of a study lists their numbers."""
_SAME = 1e-9
"""Relative difference up to which numbers count as equal."""


def sentence_of_step(data: xr.Dataset, index: int) -> str:
    """Return a sentence like "At depth 3 µm: force 904 nN, contact radius 4.5 µm" for a load step.

    A contact in several parts has its fraction of a periodic domain, or its area on a free one,
    instead of its radius.
    """
    step = data.isel(step=index)
    heading = f"At {label_of_step(data, index)}"
    if not np.isfinite(step["force"].item()):
        return f"{heading}: no result."
    size = "contact_fraction" if is_periodic(data) else "contact_area"
    if has_one_shape(data) and "contact_radius" in data:
        size = "contact_radius"
    named = prescribed_variable(data)
    names = [name for name in ("force", "depth", size) if name != named]
    if named == "depth" or has_times(data):
        names = [name for name in names if name != "depth"]
    if step["contact_area"].item() <= 0:
        names = [name for name in names if name != size]
    parts = [replace(wording(step[n]), digits=_DIGITS).text(step[n].item()) for n in names]
    parts += ["no contact"] if step["contact_area"].item() <= 0 else []
    marked = "" if step["converged"].item() else " (NOT CONVERGED)"
    return f"{heading}: {', '.join(parts)}{marked}."


def sentences_of_path(data: xr.Dataset, summary: Mapping[str, float]) -> str:
    """Return the range of the force over the load steps, and the pull-off force; may be empty."""
    sentences = []
    if data.sizes["step"] > 1 and not has_interaction(data):
        sentences.append(f"Over {data.sizes['step']} load steps: {_range(data['force'])}.")
    names = [n for n in ("pull_off", "pull_off_depth") if np.isfinite(summary.get(n, np.nan))]
    if names:
        texts = [
            f"{VARIABLES[n].words} {readable(summary[n], VARIABLES[n].unit, _DIGITS)}"
            for n in names
        ]
        sentences.append(f"On the path: {', '.join(texts)}.")
    return " ".join(sentences)


def sentence_of_study(table: xr.Dataset, count: int) -> str:
    """Return the results of a study in its last step; empty if there is none.

    Of force, depth and contact radius, the one that all runs share there, if any, comes first.
    """
    axes = [
        shown.words + " " + shown.listing(axis.values.tolist())
        for name, axis in table.coords.items()
        if name != "step"
        for shown in (wording(axis),)
    ]
    over = f" with {'; '.join(axes)}" if axes else ""
    end = table.isel(step=-1)
    names = ["depth", "force", *["contact_radius"] * has_one_shape(table)]
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


def _values(variable: xr.DataArray, count: int) -> str:
    """Return the values of a few runs in their order, the range of many."""
    values = variable.values.ravel()
    if count > _FEW or variable.ndim > 1 or not np.isfinite(values).all() or _is_one_value(values):
        return _range(variable)
    shown = replace(wording(variable), digits=_DIGITS)
    return f"{shown.words} {shown.listing(values.tolist())}"


def _range(variable: xr.DataArray) -> str:
    shown = replace(wording(variable), digits=_DIGITS)
    finite = variable.values[np.isfinite(variable.values)]
    if not finite.size:
        return f"no {shown.words}"
    low, high = shown.number(finite.min().item()), shown.number(finite.max().item())
    if low == high:
        return f"{shown.words} {shown.scale.with_unit(low)}"
    return f"{shown.words} from {low} to {shown.scale.with_unit(high)}"
