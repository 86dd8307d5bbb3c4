"""Carry the history of a solid that relaxes from one load step to the next."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, TypeVar

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import errors_attributed_to
from pellicle.components import Kernel, Setting
from pellicle.config.run import Run
from pellicle.contact.load_step import FinishedStep
from pellicle.contact.problem import Traction
from pellicle.contact.time_step import History, TimeStep
from pellicle.grid import Grid
from pellicle.surface import HasSymbol, mean_compliance
from pellicle.surface.plane import PlaneOperator

Composed = TypeVar("Composed", Setting, Traction)
KEPT: Final = 4
"""Number of stiffnesses γ for which `skin_operators` are kept."""
# Equal steps whose times differ by rounding share their operators.
_DIGITS: Final = 12


class Relaxation:
    """The history of a solid, brought forward by the pressures and displacements of the steps.

    The history is a function of these alone, so a resumed run brings it forward from those in its
    file and goes on with the same numbers.
    """

    def __init__(self, run: Run) -> None:
        kernel, branches = run.kernel, run.branches
        # The solid is undeformed before the first step.
        self._steps = [TimeStep.of(branches, duration) for duration in run.loading.durations]
        self._history = History.at_rest(branches, run.grid.shape)
        # Integrals over the plane [N]: long waves do not bend the skin, so the solid carries all.
        self._integral = History.at_rest(branches, ())
        self._cell_area = run.grid.cell_area
        has_skin = kernel.without_skin() != kernel
        self._skin = skin_operators(kernel, run.grid) if has_skin else None
        self._done = 0

    @property
    def applications(self) -> int:
        """Operator applications of the last `setting` to bring the history forward by one step."""
        return 2 if self._skin and self._done else 0

    def setting(self, setting: Composed, path: Sequence[FinishedStep]) -> Composed:
        """Return the setting of the step after those of a path; each of them is taken once.

        Its operator is that of a solid γ times as stiff, its surface is displaced by what the steps
        before have left behind. The operator of ``setting`` is the instantaneous one.
        """
        for finished in path[self._done :]:
            self._advance(finished.state.pressure, finished.displacement)
        step, left = self._steps[self._done], None
        if self._skin and not self._done and step.is_jump:
            return setting
        stress = self._history.residual_stress(step)
        if self._skin:
            whole = self._skin[0](step)
            operator = whole.operator
            if self._done:
                left = -whole(stress, float(self._integral.residual_stress(step)))
        else:
            operator = setting.operator.scaled(1 / step.stiffness)
            if self._done:
                left = stress / -step.stiffness
        return replace(setting, operator=operator, left=left)

    def _advance(self, pressure: Array, displacement: Array) -> None:
        step = self._steps[self._done]
        strain = displacement
        if self._skin:
            force = np.asarray(pressure.sum() * self._cell_area)
            remaining = float(force - self._integral.residual_stress(step))
            # What the solid carries of the pressure, in units of its strain s = k₀ u.
            strain = self._skin[1](step)(pressure - self._history.residual_stress(step), remaining)
            self._integral = self._integral.after(step, np.asarray(remaining / step.stiffness))
        self._history = self._history.after(step, strain)
        self._done += 1


@dataclass(frozen=True)
class CarriedShare:
    """The part of a pressure that the solid under a skin carries, as a kernel without unit."""

    whole: HasSymbol
    """The skin on the solid, γ times as stiff."""
    solid: HasSymbol
    """The solid alone, as stiff as it is at once."""

    @property
    def is_isotropic(self) -> bool:
        """Whether both are."""
        return self.whole.is_isotropic and self.solid.is_isotropic

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return k₀/(k_skin + γ k₀)."""
        share: Array = self.whole.symbol(qx, qy) / self.solid.symbol(qx, qy)
        return share

    def mean_compliance(self) -> float:
        """Return it at q = 0, where a skin carries nothing; ∞ if the mean is not displaced."""
        solid = mean_compliance(self.solid)
        return mean_compliance(self.whole) / solid if 0 < solid < math.inf else math.inf


def skin_operators(
    kernel: Kernel, grid: Grid
) -> tuple[Callable[[TimeStep], PlaneOperator], Callable[[TimeStep], PlaneOperator]]:
    """Return the operators of a step from pressure to displacement, and to what the solid carries.

    The first is in m/Pa, the second without unit. Each is kept for `KEPT` stiffnesses γ.
    """
    solid = kernel.without_skin()

    def kept(make: Callable[[float], HasSymbol]) -> Callable[[TimeStep], PlaneOperator]:
        @lru_cache(maxsize=KEPT)
        def operator(share: float) -> PlaneOperator:
            with errors_attributed_to(kernel):
                return PlaneOperator(make(share), grid)

        return lambda step: operator(rounded_stiffness(step))

    return kept(kernel.scaled), kept(lambda share: CarriedShare(kernel.scaled(share), solid))


def rounded_stiffness(step: TimeStep) -> float:
    """Return γ of a step in twelve digits, by which steps share operators."""
    return float(f"{step.stiffness:.{_DIGITS}g}")
