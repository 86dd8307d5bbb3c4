"""One step in time of a linear solid that relaxes.

The stiffness of the solid is k₀ (gₑ + Σ gⱼ e^(−t/τⱼ)), with the instantaneous stiffness k₀ and
shares g of it; the times τ are numbers, or depend on the wave. A skin adds a stiffness k_skin that
does not relax. If the displacement is linear in time over a step, the problem at its end is exactly
that of an elastic solid, γ times as stiff as the instantaneous one, whose surface the steps before
have displaced: with `History.residual` r, by −k₀ r/(k_skin + γ k₀), which is −r/γ without a skin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array

OfWave = Callable[[Array], Array]
"""A function of wavenumbers q ≥ 0 [rad/m], of their shape."""


class Branch(NamedTuple):
    """A share of a solid's stiffness that relaxes as e^(−t/τ)."""

    share: float
    """Share g of the instantaneous stiffness."""
    time: float | OfWave
    """Relaxation time τ [s]; it may depend on the wave, and be ∞ at q = 0."""

    def time_at(self, q: Array | None) -> Array:
        """Return τ [s] of the waves ``q`` [rad/m], or the number that it is for all waves."""
        return np.asarray(self.time(q) if callable(self.time) and q is not None else self.time)


def depend_on_wave(branches: Iterable[Branch]) -> bool:
    """Return whether any relaxation time does."""
    return any(callable(branch.time) for branch in branches)


def have_equal_branches(first: Sequence[Branch], second: Sequence[Branch]) -> bool:
    """Return whether two solids have the same branches, as far as times at some waves tell."""
    q = np.geomspace(1e-3, 1e12, 31)
    return len(first) == len(second) and all(
        b.share == o.share and np.array_equal(b.time_at(q), o.time_at(q))
        for b, o in zip(first, second, strict=True)
    )


def permanent_share(branches: Iterable[Branch]) -> float:
    """Return the share of the instantaneous stiffness that never relaxes; 0 of a liquid."""
    return max(0.0, 1.0 - math.fsum(branch.share for branch in branches))


@dataclass(frozen=True)
class TimeStep:
    """The response of the branches of a solid, in their order, to one step in time.

    Each is a number, or has the shape of the waves.
    """

    decays: tuple[Array, ...]
    """e^(−Δ/τ) of each branch, of a step of duration Δ."""
    weights: tuple[Array, ...]
    """g (τ/Δ)(1 − e^(−Δ/τ)) of each branch; its share g in a jump, where Δ = 0."""
    stiffness: Array
    """γ: the stiffness of the solid in this step over its instantaneous stiffness."""

    @classmethod
    def of(cls, branches: Sequence[Branch], duration: float, q: Array | None = None) -> Self:
        """Return the step of ``duration`` ≥ 0 [s] of a solid with these branches, for waves ``q``.

        Without ``q`` [rad/m] the times have to be numbers. The shares are positive and sum to at
        most 1, up to rounding. The solid is a liquid if they sum to 1; γ then falls as 1/Δ.
        """
        ratios = [duration / branch.time_at(q) for branch in branches]
        weights = [b.share * _mean_decay(x) for b, x in zip(branches, ratios, strict=True)]
        stiffness = np.asarray(permanent_share(branches) + sum(weights))
        return cls(tuple(np.exp(-x) for x in ratios), tuple(weights), stiffness)


def _mean_decay(x: Array) -> Array:
    """Return (1 − e^(−x))/x, the mean of e^(−t) over 0 < t < x."""
    return np.divide(-np.expm1(-x), x, out=np.ones_like(x), where=x > 0)


@dataclass(frozen=True)
class History:
    """The state of a solid with m branches at the end of a step.

    Its arrays are over cells, or over waves where a wave has a stiffness of its own.
    """

    displacement: NDArray[Any]
    """The displacement at the end of the step, in any unit."""
    branches: NDArray[Any]
    """The part of it that each branch still carries, times its share; one more axis, of m."""

    @classmethod
    def at_rest(
        cls, branches: Sequence[Branch], shape: tuple[int, ...], dtype: type = float
    ) -> Self:
        """Return the history of a solid that has never been deformed."""
        return cls(np.zeros(shape, dtype), np.zeros((len(branches), *shape), dtype))

    def residual(self, step: TimeStep) -> NDArray[Any]:
        """Return the stress at the end of ``step`` over k₀, less γ times the displacement there.

        It is Σ (e vⱼ − c gⱼ u), with the part vⱼ that a branch carries, the decay e and weight c gⱼ
        of the step, and the displacement u before it.
        """
        stress = np.zeros_like(self.displacement)
        for part, decay, weight in zip(self.branches, step.decays, step.weights, strict=True):
            stress += decay * part
            stress -= weight * self.displacement
        return stress

    def after(self, step: TimeStep, displacement: NDArray[Any]) -> History:
        """Return the history at the end of ``step``, where the displacement is this."""
        growth = displacement - self.displacement
        branches = np.empty_like(self.branches)
        for index, (decay, weight) in enumerate(zip(step.decays, step.weights, strict=True)):
            branches[index] = decay * self.branches[index] + weight * growth
        return History(displacement, branches)
