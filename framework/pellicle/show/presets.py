"""The figures of a run and of a study, as charts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pellicle.analysis import legs
from pellicle.components.charts import Axis, Chart, Fields, Look, Series
from pellicle.results.dimensions import parts
from pellicle.results.path import has_interaction, has_times
from pellicle.results.result import Result
from pellicle.results.wording import is_periodic, wording
from pellicle.variables import CONTACT_AREA, CORRECTED_AREA

from .fields import pressure_map, profile
from .style import is_log_spaced, is_ordered, is_seed

if TYPE_CHECKING:
    import xarray as xr

MOST_LEGS = 4
"""Largest number of legs of a path in time that are told apart."""
_MOST_NAMED = 10
_OVER_TIME = "force", "depth", "contact_area"
FIGURES = "pressure", "profile", "force_depth", "area_force", "time"
"""Figures of a run, which are the suffixes of the file names too."""
STUDY_FIGURES = "force", "contact_area", "contact_fraction"
"""Variables that may be drawn for a study, which are the suffixes of the file names too."""


def figures(shown: Result | xr.Dataset) -> dict[str, Chart | Fields]:
    """Return the figures of a result or of a study's table, by the suffix of their files.

    A run whose steps have times has one over time. A study has force, and contact fraction or area:
    a free domain has no nominal area of which the contact is a fraction.
    """
    if not isinstance(shown, Result):
        area = "contact_fraction" if is_periodic(shown) else "contact_area"
        names = ("force", area) if "force" in shown else ()
        return {name: study_curves(shown, name) for name in names}
    drawn: dict[str, Chart | Fields] = {
        "pressure": pressure_map(shown),
        "profile": profile(shown),
        "force_depth": force_depth(shown),
        "area_force": area_force(shown),
    }
    if has_times(shown.dataset) and shown.dataset.sizes["step"] > 1:
        drawn["time"] = over_time(shown)
    return drawn


def force_depth(result: Result) -> Chart:
    """Return force against depth over the load steps."""
    return _curves(result, {"force": ""}, "depth")


def area_force(result: Result) -> Chart:
    """Return the contact area, counted over cells and corrected, against force."""
    corrected = {
        str(name): wording(variable).words.removeprefix(f"{CONTACT_AREA}, ")
        for name, variable in result.dataset.data_vars.items()
        if str(name).startswith(CORRECTED_AREA)
    }
    counted = "counted over cells" if corrected else ""
    return _curves(result, {"contact_area": counted} | corrected, "force")


def over_time(result: Result) -> Chart:
    """Return force, depth and contact area against time, one above the other."""
    data = result.dataset
    series = [
        _series(data, "time", name, Look(number, marker=0), panel=number)
        for number, name in enumerate(_OVER_TIME)
    ]
    axes = [_axis(data[name], signed=True) for name in _OVER_TIME]
    return Chart(_axis(data["time"]), axes, series, _title(data), hues=len(_OVER_TIME))


def study_curves(table: xr.Dataset, variable: str) -> Chart:
    """Return a variable of a study against the depth, one colour for each value of its first axis.

    Where steps have times, it is shown against the time; where each run has one step only, against
    the first axis of numbers instead.
    """
    # The horizontal axis, and the dimension along which each line goes.
    dimensions = [str(d) for d in table["status"].dims if d != "step"]
    numbers = [d for d in dimensions if table[d].dtype.kind in "if" and table.sizes[d] > 1]
    over_steps = table.sizes["step"] > 1 or not numbers
    along = "step" if over_steps else numbers[0]
    against = ("time" if has_times(table) else "depth") if over_steps else along
    # Values of the first of the others have colours of their own; seeds are only repetitions.
    rest = [d for d in dimensions if d != along]
    compared = sorted(rest, key=lambda d: is_seed(table[d]) or table.sizes[d] == 1)[:1]
    stacked = [str(d) for d in table["status"].dims if d not in (along, *compared)]
    named_by = wording(table[compared[0]]) if compared else None
    many = table.sizes[compared[0]] if compared else 1
    pulls, series = has_interaction(table), list[Series]()
    for number, part in enumerate(parts(table, compared)):
        # Of many values only some are named: colours change evenly between them.
        named = named_by and number % -(-many // _MOST_NAMED) == 0
        legend = named_by.text(part[compared[0]].item()) if named and named_by else ""
        for line in parts(part, stacked):
            look = Look(number, marker=number)
            tells_legs = pulls and against == "depth"
            finished = line.isel({along: np.isfinite(line["depth"].values)}) if tells_legs else line
            series.append(
                _series(finished, against, variable, look, legend=legend, tells_legs=tells_legs)
            )
            legend = ""
    log = along != "step" and is_log_spaced(table[against].values)
    ordered = bool(compared) and is_ordered(table, compared[0])
    x, y = _axis(table[against], log=log), _axis(table[variable], signed=pulls)
    return Chart(x, [y], series, _title(table), hues=many, ordered=ordered)


def _curves(result: Result, labels: dict[str, str], against: str) -> Chart:
    """Return variables, with their labels, against another over the steps of a run."""
    data = result.dataset
    pulls, path = has_interaction(data), legs(data["depth"].values)
    tells_legs = pulls or (has_times(data) and len(path) <= MOST_LEGS)
    series = [
        _series(data, against, name, Look(n, n, n), legend=label, tells_legs=tells_legs)
        for n, (name, label) in enumerate(labels.items())
    ]
    first = next(iter(labels))
    x, y = _axis(data[against], signed=pulls), _axis(data[first], signed=pulls)
    return Chart(x, [y], series, _title(data), hues=len(labels))


def _series(
    data: xr.Dataset,
    x: str,
    y: str,
    look: Look,
    *,
    legend: str = "",
    panel: int = 0,
    tells_legs: bool = False,
) -> Series:
    """Return one variable of the steps of a run, or of runs, against another."""
    good = data["converged"].values.astype(bool)
    return Series(
        data[x].values.astype(float),
        data[y].values.astype(float),
        name=y,
        legend=legend,
        look=look,
        converged=good,
        legs=legs(data["depth"].values) if tells_legs else (),
        steps=np.arange(good.size, dtype=np.int64),
        panel=panel,
    )


def _axis(variable: xr.DataArray, *, signed: bool = False, log: bool = False) -> Axis:
    unit = str(variable.attrs.get("units", "1"))
    start = None if signed or log else 0.0
    return Axis(wording(variable).words, unit, log=log, limits=(start, None), signed=signed)


def _title(data: xr.Dataset) -> str:
    title: str = data.attrs.get("title", "")
    return title
