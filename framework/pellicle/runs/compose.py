"""Compose the problems of a run: operator, profile and what is prescribed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import blamed
from pellicle.components.calls import (
    profile_of,
)
from pellicle.config.run import Run
from pellicle.errors import ConfigError
from pellicle.numerics.grid_checks import warn_of_cells, warn_of_period
from pellicle.numerics.operators import Operator, make_operator
from pellicle.numerics.problem import Depth, Force, Problem
from pellicle.results.variables import VARIABLES


def problems_of(run: Run) -> list[Problem]:
    """Return the problem of each load step; they share operator and profile.

    Raises
    ------
    ConfigError
        Kernel, indenter or loading do not fit the grid.
    """
    with blamed(run.kernel):
        operator = make_operator(run.kernel, run.grid)
        warn_of_cells(run.kernel.compliance, run.grid)
    profile = profile_of(run.indenter, run.grid)
    if run.indenter.footprint == "domain":
        warn_of_period(profile, run.grid)

    def each(kind: type[Depth] | type[Force], values: Iterable[float]) -> list[Problem]:
        return [Problem(run.grid, operator, profile, kind(value)) for value in values]

    values = run.loading.values
    match run.loading.prescribed:
        case "depth":
            _check_depths(values, profile, operator, "depth")
            return each(Depth, values)
        case "mean_plane_depth":
            mean = _mean_plane(run, profile)
            _check_depths([value - mean for value in values], profile, operator, "mean_plane_depth")
            return each(Depth, [value - mean for value in values])
        case "force":
            return each(Force, values)
        case "mean_pressure":
            return each(Force, [value * run.grid.area for value in values])
    _check_areas(run, profile)
    # The force is searched for.
    return each(Force, [0.0] * len(values))


def _mean_plane(run: Run, profile: Array) -> float:
    """Return the height [m] of the indenter's mean plane over its lowest point, ≤ 0."""
    mean = float(profile.mean())
    endless = run.grid.boundary == "free" and run.indenter.footprint == "unbounded"
    if endless or not np.isfinite(mean):
        raise ConfigError(
            "is not defined for an indenter that goes on beyond a free domain, or does not fill "
            "its domain: it has no mean plane; prescribe depth",
            "loading.mean_plane_depth",
        )
    return mean


def _check_depths(
    depths: Sequence[float], profile: Array, operator: Operator, prescribed: str
) -> None:
    """Refuse a depth [m] before first touch, or one against the mean plane no load reaches."""
    mean = float(profile.mean())
    shift = mean if prescribed == "mean_plane_depth" else 0.0
    for index, depth in enumerate(depths):
        field = f"loading.{prescribed}.{index}"
        if depth < 0:
            raise ConfigError(
                f"{depth + shift:g} m is before first touch: this indenter's lowest point is "
                f"{-mean:g} m below its mean plane; give {mean:g} m or more",
                field,
            )
        if depth >= -mean and not operator.has_mean_compliance:
            raise ConfigError(
                f"{depth + shift:g} m is beyond full contact: on a periodic grid the depth is "
                f"measured from the mean plane, and this indenter's is {-mean:g} m above its "
                "lowest point, at any load; give less, or prescribe mean_pressure",
                field,
            )


def prescribed_areas(run: Run) -> Sequence[float] | None:
    """Return the contact area [m²] of each load step, None if none is prescribed."""
    match run.loading.prescribed:
        case "contact_radius":
            return [np.pi * radius**2 for radius in run.loading.values]
        case "contact_area":
            return run.loading.values
    return None


def _check_areas(run: Run, profile: Array) -> None:
    """Refuse a contact area that the indenter cannot have on this grid."""
    cell = run.grid.cell_area
    there = int(np.count_nonzero(np.isfinite(profile)))
    first = int(np.count_nonzero(profile == profile.max()))
    name = run.loading.prescribed
    unit = VARIABLES[name].unit
    for index, (given, area) in enumerate(
        zip(run.loading.values, prescribed_areas(run) or (), strict=True)
    ):
        whose = "the domain" if there == profile.size else "the indenter"
        problem = ""
        if area > (there + 0.5) * cell:
            problem = f"more than {whose} has, {there * cell:g} m²; give less"
        elif area > 0 and first == there:
            problem = (
                f"not to be had: the indenter is flat, and all its {there * cell:g} m² touch at "
                "once, under any load; prescribe depth or force"
            )
        elif 0 < area < (first - 0.5) * cell:
            problem = (
                f"less than the {first} cells of {cell:g} m² that touch first, all at once; give "
                "more, or use more points"
            )
        if problem:
            raise ConfigError(f"{given:g} {unit} is {problem}", f"loading.{name}.{index}")
