"""Carry the memory of a solid that relaxes from one load step to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Setting
from pellicle.components.kernel import branches_of
from pellicle.config.run import Run
from pellicle.contact.finished_step import FinishedStep
from pellicle.contact.skin_operators import skin_operators
from pellicle.contact.time_step import (
    Memory,
    TimeStep,
    left_behind,
    strain_under_skin,
)


class Relaxation:
    """The memory of a solid, brought forward by the pressures and displacements of the steps.

    The memory is a function of these alone, so a resumed run brings it forward from those in its
    file and goes on with the same numbers.
    """

    def __init__(self, run: Run) -> None:
        kernel, branches = run.kernel, branches_of(run.kernel)
        # The solid is undeformed before the first step.
        self._steps = [TimeStep.of(branches, duration) for duration in run.loading.durations]
        self._memory = Memory.at_rest(branches, run.grid.shape)
        # Integrals over the plane [N]: long waves do not bend the skin, so the solid carries all.
        self._integral = Memory.at_rest(branches, ())
        self._cell_area = run.grid.cell_area
        has_skin = kernel.without_skin() != kernel
        self._skin = skin_operators(kernel, run.grid) if has_skin else None
        self._done = 0

    @property
    def applications(self) -> int:
        """Operator applications of the last `setting` to bring the memory forward by one step."""
        return 2 if self._skin and self._done else 0

    def setting(self, setting: Setting, path: Sequence[FinishedStep]) -> Setting:
        """Return the setting of the step after those of a path; each of them is taken once.

        Its operator is that of a solid γ times as stiff, its surface is displaced by what the steps
        before have left behind. The operator of ``setting`` is the instantaneous one.
        """
        for finished in path[self._done :]:
            self._advance(finished.state.pressure, finished.displacement)
        step, displacement = self._steps[self._done], None
        if self._skin and not self._done and step.is_jump:
            return setting
        if self._skin:
            whole = self._skin[0](step)
            operator = whole.operator
            displacement = partial(whole, integral=float(self._integral.history(step)))
        else:
            operator = setting.operator.scaled(1 / step.stiffness)
        left = left_behind(self._memory, step, displacement) if self._done else None
        return replace(setting, operator=operator, left=left)

    def _advance(self, pressure: Array, displacement: Array) -> None:
        """Bring the memory forward to the end of the next step."""
        step = self._steps[self._done]
        strain = displacement
        if self._skin:
            force = np.asarray(pressure.sum() * self._cell_area)
            remaining = float(force - self._integral.history(step))
            carried = partial(self._skin[1](step), integral=remaining)
            strain = strain_under_skin(self._memory, step, pressure, carried)
            self._integral = self._integral.after(step, np.asarray(remaining / step.stiffness))
        self._memory = self._memory.after(step, strain)
        self._done += 1
