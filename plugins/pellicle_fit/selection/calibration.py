"""Errors of the calibration, and how one that all curves share moves what is fitted to a curve."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pellicle import registry
from pellicle_fit.effect import Effect
from pellicle_fit.estimation.candidate import Candidate

_ERRORS = {"spring_constant": "spring", "sensitivity": "sensitivity", "radius": "size"}
"""What may be known to an uncertainty, and the effect whose error that is."""


def errors(uncertainty: Mapping[Any, float]) -> list[Effect]:
    """Return the effects whose errors have the standard deviations of an uncertainty, by name."""
    pairs = [(_ERRORS[name], {"value": 0.0, "deviation": x}) for name, x in uncertainty.items()]
    return [registry().make(Effect, {"type": of, f"{of}_error": error}) for of, error in pairs]


def common_errors(fit: Candidate, uncertainty: Mapping[Any, float]) -> dict[str, dict[str, float]]:
    """Return the standard deviation [SI] that each part of an uncertainty gives each quantity.

    It is to first order, where the rest moves as this makes χ² least; what is at a limit stays.
    """
    moved: dict[str, dict[str, float]] = {}
    for (name, share), error in zip(uncertainty.items(), errors(uncertainty), strict=True):
        objective, at = fit.beside([error])
        (k,) = (k for k, slot in enumerate(objective.slots) if slot.name in error.open)
        free = [i for i in objective.within(at) if i != k]
        by_error, *others = objective.jacobian(at, [k, *free]).T
        matrix = np.reshape(others, (len(free), -1)).T
        change = np.linalg.lstsq(matrix, by_error, rcond=1e-12)[0] if free else ()
        for i, rate in zip(free, change, strict=True):
            slot = objective.slots[i]
            size = slot.value(at[i]) if slot.quantity.log else slot.scale
            moved.setdefault(slot.name, {})[name] = abs(float(rate * size)) * share
    return moved
