"""The force curve of an indenter, which may be a stranger's, checked where it enters a fit."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PluginError, shown

Method = Literal["force_curve", "layer_force_curve"]


def checked_force(indenter: object, method: Method, depth: Array, *solid: float) -> Array:
    """Return F/E* [m²] of an indenter at depths of shape (n,) [m], on a solid or on a layer.

    It has to be an array of that shape, finite at every finite depth.
    """
    family = getattr(indenter, "family", "component")
    name = f"{family} {getattr(indenter, 'type_name', type(indenter).__name__)!r}"
    given = depth.view()
    given.flags.writeable = False
    curve = getattr(indenter, method)(given, *solid)
    force: Any = getattr(curve, "force", None)
    is_array = type(force) is np.ndarray and force.dtype == np.float64
    if not is_array or force.shape != depth.shape:
        raise PluginError(
            f"{name}: {method}() returned {shown(curve)}; it has to return a ForceCurve whose "
            f"force is an array of float64 of shape {depth.shape}"
        )
    if not (np.isfinite(force) | ~np.isfinite(depth)).all():
        raise PluginError(f"{name}: {method}().force has values that are NaN or infinite")
    checked: Array = force
    return checked
