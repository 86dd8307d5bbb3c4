"""One parameter of a fit, and how sure it is."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Estimate:
    """One parameter: its value, and the 95 % interval of its profile likelihood."""

    value: float
    low: float | None
    """Lower end; None if the curve sets none (for a tension: it may be 0)."""
    high: float | None
    """Upper end; None if the curve sets none."""
    unit: str
    bound: float
    """Cramér–Rao bound at the value, as a standard deviation; 0 if held."""
    held: bool = False
    """Whether it was given, not fitted."""

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold; an open end is None."""
        bound = self.bound if np.isfinite(self.bound) else None
        return {
            "value": self.value,
            "low": self.low,
            "high": self.high,
            "unit": self.unit,
            "bound": bound,
            "held": self.held,
        }


def of_log(log: Estimate) -> Estimate:
    """Return the modulus whose logarithm is estimated."""
    value = float(np.exp(log.value))
    low, high = (None if end is None else float(np.exp(end)) for end in (log.low, log.high))
    return replace(log, value=value, low=low, high=high, bound=log.bound * value)


def youngs_modulus(reduced: Estimate, poissons_ratio: float | None) -> Estimate | None:
    """Return E = (1 − ν²) E*, if ν was given."""
    return None if poissons_ratio is None else _times(reduced, 1 - poissons_ratio**2)


def _times(estimate: Estimate, factor: float) -> Estimate:
    low, high = (None if end is None else end * factor for end in (estimate.low, estimate.high))
    return replace(
        estimate, value=estimate.value * factor, low=low, high=high, bound=estimate.bound * factor
    )
