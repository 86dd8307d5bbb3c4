"""Carry the memory of a solid that relaxes from one load step to the next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, Self

from pellicle.arrays import Array
from pellicle.components import Branch, HasRelaxation, Kernel, Setting
from pellicle.components.calls import branches_of
from pellicle.config.run import Run
from pellicle.grid import Grid
from pellicle.numerics.operators import Operator, make_operator, mean_compliance
from pellicle.numerics.relaxation import (
    Memory,
    TimeStep,
    left_behind,
    left_behind_under_skin,
    strain_under_skin,
)

# Equal steps whose times differ by rounding share their operators.
_DIGITS: Final = 12
_OPERATORS: Final = 4


@dataclass(frozen=True)
class CarriedShare:
    """The part of a pressure that the solid under a skin carries, as a kernel without unit."""

    whole: Kernel
    """The skin on the solid, γ times as stiff."""
    solid: Kernel
    """The solid alone, as stiff as it is at once."""

    def compliance(self, q: Array) -> Array:
        """Return k₀/(k_skin + γ k₀)."""
        share: Array = self.whole.compliance(q) / self.solid.compliance(q)
        return share

    def mean_compliance(self) -> float:
        """Return it at q = 0, where a skin carries nothing; ∞ if the mean is not displaced."""
        solid = mean_compliance(self.solid)
        return mean_compliance(self.whole) / solid if 0 < solid < math.inf else math.inf


class Skin:
    """The operators of a skin on a solid that relaxes, one pair for each stiffness γ."""

    def __init__(self, kernel: HasRelaxation, grid: Grid) -> None:
        solid = kernel.without_skin()

        @lru_cache(maxsize=_OPERATORS)
        def operators(share: float) -> tuple[Operator, Operator]:
            whole = kernel.scaled(share)
            return make_operator(whole, grid), make_operator(CarriedShare(whole, solid), grid)

        self._operators = operators

    def operators(self, step: TimeStep) -> tuple[Operator, Operator]:
        """Return those from pressure to displacement [m/Pa] and to what the solid carries."""
        return self._operators(float(f"{step.stiffness:.{_DIGITS}g}"))


class Relaxation:
    """The memory of a solid, brought forward by the pressures and displacements of the steps.

    The memory is a function of these alone, so a resumed run brings it forward from those in its
    file and goes on with the same numbers.
    """

    def __init__(
        self,
        branches: Sequence[Branch],
        durations: Sequence[float],
        shape: tuple[int, ...],
        skin: Skin | None = None,
    ) -> None:
        # The solid is undeformed before the first step.
        self._steps = [TimeStep.of(branches, duration) for duration in durations]
        self._memory = Memory.at_rest(branches, shape)
        self._skin = skin
        self._done = 0

    @classmethod
    def of(cls, run: Run) -> Self | None:
        """Return the memory before the first step of a run; None if its solid is elastic."""
        kernel, branches = run.kernel, branches_of(run.kernel)
        if not branches:
            return None
        assert isinstance(kernel, HasRelaxation)
        skin = Skin(kernel, run.grid) if kernel.without_skin() != kernel else None
        return cls(branches, run.loading.durations, run.grid.shape, skin)

    def setting(self, setting: Setting, pressures: Array, displacements: Array) -> Setting:
        """Return the setting of the step after those with these pressures and displacements.

        Its operator is that of a solid γ times as stiff, its surface is displaced by what the steps
        before have left behind. The operator of ``setting`` is the instantaneous one.
        """
        for index in range(self._done, len(displacements)):
            self._advance(pressures[index], displacements[index])
        step = self._steps[self._done]
        if not self._skin:
            operator = setting.operator.scaled(1 / step.stiffness)
            left = left_behind(self._memory, step)
        else:
            operator, _ = self._skin.operators(step)
            left = left_behind_under_skin(self._memory, step, operator)
        return replace(setting, operator=operator, left=left if self._done else None)

    def _advance(self, pressure: Array, displacement: Array) -> None:
        """Bring the memory forward to the end of the next step."""
        step = self._steps[self._done]
        strain = displacement
        if self._skin:
            _, carried = self._skin.operators(step)
            strain = strain_under_skin(self._memory, step, pressure, carried)
        self._memory = self._memory.after(step, strain)
        self._done += 1
