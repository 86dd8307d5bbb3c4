"""One step in time of a linear solid that relaxes.

The stiffness of the solid is k₀ (gₑ + Σ gⱼ e^(−t/τⱼ)), with the instantaneous stiffness k₀ and
shares g of it. A skin adds a stiffness that does not relax. If the displacement is linear in time
over a step, the problem at its end is exactly that of an elastic solid, γ times as stiff as the
instantaneous one, whose surface the steps before have displaced. Without a skin the history of the
solid consists of displacements, cell by cell; under a skin, of pressures that the solid carries.

With `History.residual_stress` h, the displacement u that a step without pressure leaves, to which
A p adds, is −A h, and −h/γ without a skin: A = 1/(k_skin + γ k₀) is the operator of the step. Under
a skin the strain is s = k₀ u = B (p − h), by the operator B = k₀/(k_skin + γ k₀) without unit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from pellicle.arrays import Array


class Branch(NamedTuple):
    """A share of a solid's stiffness that relaxes as e^(−t/τ)."""

    share: float
    """Share g of the instantaneous stiffness."""
    time: float
    """Relaxation time τ [s]."""


def stiffness_after(branches: Sequence[Branch], duration: float) -> float:
    """Return the stiffness of a solid ``duration`` [s] after a jump over the instantaneous one."""
    return 1.0 + math.fsum(b.share * math.expm1(-duration / b.time) for b in branches)


@dataclass(frozen=True)
class TimeStep:
    """The response of the branches of a solid, in their order, to one step in time."""

    decays: tuple[float, ...]
    """e^(−Δ/τ) of each branch, of a step of duration Δ."""
    weights: tuple[float, ...]
    """g (τ/Δ)(1 − e^(−Δ/τ)) of each branch; its share g in a jump, where Δ = 0."""
    stiffness: float
    """γ: the stiffness of the solid in this step over its instantaneous stiffness."""

    @property
    def is_jump(self) -> bool:
        """Whether nothing relaxes in the step: it takes no time."""
        return all(decay == 1.0 for decay in self.decays)

    @classmethod
    def of(cls, branches: Sequence[Branch], duration: float) -> Self:
        """Return the step of ``duration`` ≥ 0 [s] of a solid with these branches.

        The shares are positive and sum to at most 1, up to rounding. The solid is a liquid if they
        sum to 1; γ then falls as 1/Δ.
        """
        ratios = [duration / branch.time for branch in branches]
        # (1 − e^(−x))/x is the mean of e^(−t) over 0 < t < x.
        weights = [
            b.share * (-math.expm1(-x) / x if x else 1.0)
            for b, x in zip(branches, ratios, strict=True)
        ]
        permanent = max(0.0, 1.0 - math.fsum(branch.share for branch in branches))
        return cls(
            tuple(math.exp(-x) for x in ratios), tuple(weights), math.fsum([permanent, *weights])
        )


@dataclass(frozen=True)
class History:
    """The state of a solid with m branches at the end of a step, in units of its strain.

    The strain is the displacement u [m] of a solid without a skin. Under a skin it is s = k₀ u
    [Pa], the pressure that the solid would carry if it did not relax.
    """

    strain: Array
    """The strain at the end of the step, of the grid's shape."""
    branches: Array
    """The part of the strain that each branch still carries, times its share; (m, nx, ny)."""

    @classmethod
    def at_rest(cls, branches: Sequence[Branch], shape: tuple[int, ...]) -> Self:
        """Return the history of a solid that has never been deformed."""
        return cls(np.zeros(shape), np.zeros((len(branches), *shape)))

    def residual_stress(self, step: TimeStep) -> Array:
        """Return the stress at the end of ``step`` less γ times the strain there, whatever it is.

        It is Σ (e vⱼ − c gⱼ · strain), with the part vⱼ that a branch carries and the decay e and
        weight c gⱼ of the step.
        """
        stress = np.zeros_like(self.strain)
        for part, decay, weight in zip(self.branches, step.decays, step.weights, strict=True):
            stress += decay * part
            stress -= weight * self.strain
        return stress

    def after(self, step: TimeStep, strain: Array) -> History:
        """Return the history at the end of ``step``, where the strain is ``strain``."""
        growth = strain - self.strain
        branches = np.empty_like(self.branches)
        for index, (decay, weight) in enumerate(zip(step.decays, step.weights, strict=True)):
            branches[index] = decay * self.branches[index] + weight * growth
        return History(strain, branches)
