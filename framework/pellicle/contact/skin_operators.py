"""The operators of a skin on a solid that relaxes, for the steps in time of a run."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Protocol

from pellicle.arrays import Array
from pellicle.checks import errors_attributed_to
from pellicle.grid import Grid
from pellicle.surface.kernel_calls import HasCompliance, mean_compliance
from pellicle.surface.outside import PlaneOperator

from .time_step import TimeStep

KEPT: Final = 4
"""Number of stiffnesses γ for which `skin_operators` are kept."""
# Equal steps whose times differ by rounding share their operators.
_DIGITS: Final = 12


class SkinKernel(HasCompliance, Protocol):
    """A kernel whose solid can be told from the skin on it; see `pellicle.Kernel`."""

    def scaled(self, share: float) -> HasCompliance:
        """Return the kernel of a solid ``share`` times as stiff under the same skin."""
        ...

    def without_skin(self) -> HasCompliance:
        """Return the kernel of the solid alone."""
        ...


@dataclass(frozen=True)
class CarriedShare:
    """The part of a pressure that the solid under a skin carries, as a kernel without unit."""

    whole: HasCompliance
    """The skin on the solid, γ times as stiff."""
    solid: HasCompliance
    """The solid alone, as stiff as it is at once."""

    def compliance(self, q: Array) -> Array:
        """Return k₀/(k_skin + γ k₀)."""
        share: Array = self.whole.compliance(q) / self.solid.compliance(q)
        return share

    def mean_compliance(self) -> float:
        """Return it at q = 0, where a skin carries nothing; ∞ if the mean is not displaced."""
        solid = mean_compliance(self.solid)
        return mean_compliance(self.whole) / solid if 0 < solid < math.inf else math.inf


def skin_operators(
    kernel: SkinKernel, grid: Grid
) -> tuple[Callable[[TimeStep], PlaneOperator], Callable[[TimeStep], PlaneOperator]]:
    """Return the operators of a step from pressure to displacement, and to what the solid carries.

    The first is in m/Pa, the second without unit. Each is kept for `KEPT` stiffnesses γ.
    """
    solid = kernel.without_skin()

    def kept(make: Callable[[float], HasCompliance]) -> Callable[[TimeStep], PlaneOperator]:
        @lru_cache(maxsize=KEPT)
        def operator(share: float) -> PlaneOperator:
            with errors_attributed_to(kernel):
                return PlaneOperator(make(share), grid)

        return lambda step: operator(rounded_stiffness(step))

    return kept(kernel.scaled), kept(lambda share: CarriedShare(kernel.scaled(share), solid))


def rounded_stiffness(step: TimeStep) -> float:
    """Return γ of a step in twelve digits, by which steps share operators."""
    return float(f"{step.stiffness:.{_DIGITS}g}")
