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

    def exponential(self) -> Estimate:
        """Return the estimate of what this is the logarithm of."""
        value = float(np.exp(self.value))
        low, high = (None if end is None else float(np.exp(end)) for end in (self.low, self.high))
        return replace(self, value=value, low=low, high=high, bound=self.bound * value)

    def times(self, factor: float) -> Estimate:
        """Return the estimate of a multiple."""
        low, high = (None if end is None else end * factor for end in (self.low, self.high))
        value, bound = self.value * factor, self.bound * factor
        return replace(self, value=value, low=low, high=high, bound=bound)
