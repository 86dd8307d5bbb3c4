"""Rigid axisymmetric profiles, through their Abel transforms.

For a profile f(r) ≤ 0 [m], 0 at the apex, the transform used here is

    h(x) = −x ∫₀^x f'(r) / sqrt(x² − r²) dr   [m],

so that g(x) = δ − h(x) (Sneddon 1965).  Without tension the depth is h(a) and the
force is 2 E* (a h(a) − ∫₀^a h dx).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError

from .checks import positive


class Indenter(Protocol):
    """What the axisymmetric solver needs to know of a smooth-edged indenter."""

    @property
    def limit(self) -> float:
        """Contact radius [m] that cannot be reached; infinite if there is none."""
        ...

    @property
    def pointed(self) -> bool:
        """Whether the profile has a corner at its apex."""
        ...

    def slope(self, x: Array) -> Array:
        """Return h'(x), dimensionless, for positions x [m] of any shape."""
        ...

    def depth(self, x: float) -> float:
        """Return h(x) [m], the depth without tension at contact radius x [m]."""
        ...

    def load(self, x: float) -> float:
        """Return force over E* [m²] without tension at contact radius x [m]."""
        ...


@dataclass(frozen=True)
class Paraboloid:
    """f = −r² / 2R, R = ``radius`` [m]; h = x² / R."""

    radius: float

    def __post_init__(self) -> None:
        positive(radius=self.radius)

    limit = float("inf")
    pointed = False

    def slope(self, x: Array) -> Array:
        """Return h'(x), dimensionless, for positions x [m] of any shape."""
        return 2 * x / self.radius

    def depth(self, x: float) -> float:
        """Return h(x) [m], the depth without tension at contact radius x [m]."""
        return x**2 / self.radius

    def load(self, x: float) -> float:
        """Return force over E* [m²] without tension at contact radius x [m]."""
        return 4 * x**3 / (3 * self.radius)


@dataclass(frozen=True)
class Sphere:
    """f = −R + sqrt(R² − r²), R = ``radius`` [m]; h = x artanh(x / R).

    Linear elasticity holds only for a ≪ R; the profile is nevertheless exact.
    """

    radius: float

    def __post_init__(self) -> None:
        positive(radius=self.radius)

    pointed = False

    @property
    def limit(self) -> float:
        """Contact radius [m] that cannot be reached."""
        return self.radius

    def slope(self, x: Array) -> Array:
        """Return h'(x), dimensionless, for positions x [m] of any shape."""
        u = x / self.radius
        return np.arctanh(u) + u / ((1 - u) * (1 + u))

    def depth(self, x: float) -> float:
        """Return h(x) [m], the depth without tension at contact radius x [m]."""
        return x * float(np.arctanh(x / self.radius))

    def load(self, x: float) -> float:
        """Return force over E* [m²] without tension at contact radius x [m]."""
        u = x / self.radius
        if u < 0.1:
            # The closed form cancels to 4u³/3 here, so its series is summed.
            k = np.arange(1, 12)
            return self.radius**2 * float(np.sum(4 * k * u ** (2 * k + 1) / (4 * k**2 - 1)))
        return self.radius**2 * ((1 + u**2) * float(np.arctanh(u)) - u)


@dataclass(frozen=True)
class Cone:
    """f = −r cot α, α = ``half_angle`` [rad]; h = (π/2) x cot α.

    With tension the pressure grows as τ₀ cot α / r at the apex: integrable, but
    infinite at r = 0.
    """

    half_angle: float

    def __post_init__(self) -> None:
        if not 0 < self.half_angle < np.pi / 2:
            raise ConfigError(
                f"must lie between 0 and π/2 rad, got {self.half_angle!r}", "half_angle"
            )

    limit = float("inf")
    pointed = True

    @property
    def _rate(self) -> float:
        return np.pi / 2 / float(np.tan(self.half_angle))

    def slope(self, x: Array) -> Array:
        """Return h'(x), dimensionless, for positions x [m] of any shape."""
        return np.full_like(x, self._rate)

    def depth(self, x: float) -> float:
        """Return h(x) [m], the depth without tension at contact radius x [m]."""
        return self._rate * x

    def load(self, x: float) -> float:
        """Return force over E* [m²] without tension at contact radius x [m]."""
        return self._rate * x**2


def classical_radius(indenter: Indenter, quantity: int, target: float) -> float:
    """Return the contact radius [m] without tension.

    Parameters
    ----------
    indenter
        The profile.
    quantity, target
        0 and a force over E* [m²], or 1 and a depth [m].
    """
    value = (indenter.load, indenter.depth)[quantity]
    low = high = min(indenter.limit / 2, target if quantity else target**0.5)
    while value(low) > target:
        low /= 2
    while value(high) < target:
        high = min(2 * high, (high + indenter.limit) / 2)
        if high > indenter.limit * (1 - 1e-9):
            raise ConfigError(
                f"needs a contact wider than {indenter.limit} m, the end of the profile",
                ("force", "depth")[quantity],
            )
    if low == high:
        return low
    # Here, not above: outputs load this module, and draw without it.
    from scipy.optimize import brentq

    root = brentq(
        lambda u: np.log(value(float(np.exp(u))) / target), np.log(low), np.log(high), xtol=1e-15
    )
    return float(np.exp(root))
