"""The force curve of an indenter, which may be a stranger's, checked where it enters a fit."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from pellicle.arrays import Array
from pellicle.components import ForceCurve, LayerForceCurve
from pellicle.errors import PluginError, shown

_Curve = TypeVar("_Curve", ForceCurve, LayerForceCurve)


def checked_curve(
    indenter: object, kind: type[_Curve], depth: Array, length: float, *layer: float
) -> _Curve:
    """Return the force curve of an indenter at depths of shape (n,) [m], on a solid or on a layer.

    Raises
    ------
    PluginError
        It is not a ``kind`` of arrays of that shape, finite at every finite depth.
    """
    family = getattr(indenter, "family", "component")
    name = f"{family} {getattr(indenter, 'type_name', type(indenter).__name__)!r}"
    method = "force_curve" if kind is ForceCurve else "layer_force_curve"
    given = depth.view()
    given.flags.writeable = False
    try:
        curve = getattr(indenter, method)(given, length, *layer)
    except Exception as error:
        # The command line prints the note instead of a traceback.
        error.add_note(f"{name} failed in {method}()")
        raise
    if not isinstance(curve, kind):
        raise PluginError(
            f"{name}: {method}() returned {shown(curve)}; it has to return a "
            f"pellicle.{kind.__name__}"
        )
    for part, values in curve._asdict().items():
        at = f"{name}: {method}().{part}"
        is_array = type(values) is np.ndarray and values.dtype == np.float64
        if not is_array or values.shape != depth.shape:
            raise PluginError(
                f"{at} is {shown(values)}; it has to be an array of float64 of shape {depth.shape}"
            )
        if not (np.isfinite(values) | ~np.isfinite(depth)).all():
            raise PluginError(f"{at} has values that are NaN or infinite; it has to be finite")
    return curve
