"""Values of a number, and weights, by which functions of it are differentiated."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Final

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError

Function = Callable[[float], Array]
"""A function of a number; a number that is not allowed is a ConfigError."""

# A step over the number, and the relative change of what is differentiated over a step that is
# right: differences are exact to its fourth power, and their rounding grows with its inverse.
_STEP: Final = 3e-3
_LEAST: Final = 1e-6
_MOST: Final = 0.03
# Largest factor on a step, and number of factors.
_FARTHEST: Final = 1e3
_TRIALS: Final = 60
# Offsets in steps and twelve times the weights: central, and one-sided where a bound is near.
_CENTRAL: Final = (np.array([-2.0, -1.0, 1.0, 2.0]), np.array([1.0, -8.0, 8.0, -1.0]))
_ONE_SIDED: Final = (np.arange(5.0), np.array([-25.0, 48.0, -36.0, 16.0, -3.0]))
# Of what has a derivative, the mean slope over all nodes differs by a few steps or their squares.
_SMOOTH: Final = 0.05


def differences(values: Function, at: float, size: float) -> tuple[Array, Array]:
    """Return nodes around ``at``, within its bounds, and the weight of a function's value at each.

    ``values`` is such a function, of the magnitude ``size``. If it has no derivative there, that is
    a ValueError. Where it does not change the weights are of no account.
    """
    step = _step(values, at, size)
    for (offsets, weights), signed in ((_CENTRAL, step), (_ONE_SIDED, step), (_ONE_SIDED, -step)):
        nodes, weights = at + signed * offsets, weights / (12 * signed)
        with suppress(ConfigError):
            rows = [values(node) for node in nodes.tolist()]
            break
    else:
        raise ValueError("has no room to either side within its bounds")
    derivative = sum(weight * row for weight, row in zip(weights, rows, strict=True))
    mean = (rows[-1] - rows[0]) / (nodes[-1] - nodes[0])
    if not float(np.abs(derivative - mean).max()) <= _SMOOTH * float(np.abs(derivative).max()):
        raise ValueError("changes what it acts on in steps")
    return nodes, weights


def _step(values: Function, at: float, size: float) -> float:
    """Return a step over which the values change by much more than rounding, and smoothly."""
    here, step = values(at), _STEP * abs(at) or 1.0
    least, most = _LEAST, _MOST
    for _ in range(_TRIALS):
        changed = np.inf
        for signed in (-step, step):
            with suppress(ConfigError):
                changed = float(np.abs(values(at + signed) - here).max()) / size
        if least < changed < most or step > _FARTHEST * abs(at) > 0:
            break
        # A step that is not that of the number itself is chosen for its change alone.
        least, most = _STEP / 3, _STEP * 3
        factor = _STEP / changed if changed else _FARTHEST
        step *= min(max(factor, 1 / _FARTHEST), _FARTHEST)
    return step
