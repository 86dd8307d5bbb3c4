"""Calls of an indenter: its profile."""

from __future__ import annotations

from typing import get_args

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import component_name, errors_attributed_to, read_only, real_array
from pellicle.components.indenter import Footprint, Indenter
from pellicle.errors import ConfigError, PluginError, shown
from pellicle.grid import Grid
from pellicle.units import DIGITS, LARGEST, readable

# Rounding error of heights over the size of the domain.
_ROUNDING = 1e-12


def profile_of(indenter: Indenter, grid: Grid) -> Array:
    """Return the profile f ≤ 0 [m] of an indenter on a grid, read-only."""
    x, y = (read_only(points) for points in grid.coordinates())
    try:
        with errors_attributed_to(indenter):
            value, footprint = indenter.profile(x, y), indenter.footprint
    except ConfigError as error:
        raise error.within("indenter") from None
    profile = real_array(indenter, "profile(x, y)", value, grid.shape)
    name = component_name(indenter)
    if footprint not in get_args(Footprint):
        raise PluginError(
            f"{name}: footprint is {shown(footprint)}; it has to be 'unbounded' or 'domain'"
        )
    if np.isneginf(profile).all():
        cells, domain = (
            " × ".join(readable(edge, "m", DIGITS) for edge in edges)
            for edges in (grid.spacing, grid.size)
        )
        raise ConfigError(
            f"cells of {cells} are wider than {name}, which lies over no cell centre; use a "
            f"smaller grid.size, which is {domain}, or more points",
            "indenter",
        )
    if not (profile <= 0).all():
        raise ConfigError(
            f"the profile of {name} has values that are positive or NaN; it must be ≤ 0 "
            "everywhere and 0 at the lowest point",
            "indenter",
        )
    height = -float(profile.min(where=np.isfinite(profile), initial=0.0))
    if height and not 1 / LARGEST < height < LARGEST:
        raise ConfigError(
            f"its heights on this grid reach {height:g} m, and squares of them are beyond the "
            "numbers that a computer has; check the units of its lengths",
            "indenter",
        )
    highest = float(profile.max())
    rounding = _ROUNDING * max(grid.size)
    if highest < -rounding and highest < -(hidden := _hidden_height(profile, footprint)):
        raise PluginError(
            f"{name}: the highest value of profile(x, y) is {highest:.3g} m, further below 0 than "
            f"the {hidden:.3g} m by which neighbouring cells differ; it has to be 0 at the lowest "
            "point"
        )
    return read_only(np.ascontiguousarray(profile))


def _hidden_height(profile: Array, footprint: Footprint) -> float:
    """Return an upper bound [m] on the height of the lowest cell above the lowest point.

    If the apex of a smooth body lies between the cells, the lowest cell is closer to it in height
    than to the highest of its neighbours. The apex of a rough surface may be elsewhere, so the
    largest step between any two neighbours is the bound. The apex of an unbounded body may also lie
    beyond the edge of the domain.
    """
    if footprint == "domain":
        with np.errstate(invalid="ignore"):
            steps = [np.abs(np.diff(profile, axis=axis)) for axis in (0, 1)]
        return max(
            float(np.nan_to_num(step, nan=0.0, posinf=np.inf).max(initial=0)) for step in steps
        )
    top = float(profile.max())
    i, j = np.nonzero(profile[1:-1, 1:-1] == top)
    if not i.size:
        return np.inf
    lowest_around = np.min([profile[i + a, j + b] for a in range(3) for b in range(3)], axis=0)
    return top - float(lowest_around.max())
