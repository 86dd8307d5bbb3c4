"""Carry the memory of a solid that relaxes from one load step to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Self

from pellicle.arrays import Array
from pellicle.components import Branch, Setting
from pellicle.components.calls import branches_of
from pellicle.config.run import Run
from pellicle.numerics.relaxation import Memory, TimeStep, left_behind


class Relaxation:
    """The memory of a solid without a skin, brought forward by the displacements of the steps.

    The memory is a function of the displacements alone, so a resumed run brings it forward from
    those in its file and goes on with the same numbers.
    """

    def __init__(
        self, branches: Sequence[Branch], times: Sequence[float], shape: tuple[int, ...]
    ) -> None:
        self._branches = branches
        # The first step is a jump: the solid is undeformed before it.
        durations = [0.0, *(b - a for a, b in pairwise(times))]
        self._steps = [TimeStep.of(branches, duration) for duration in durations]
        self._memory = Memory.at_rest(branches, shape)
        self._done = 0

    @classmethod
    def of(cls, run: Run) -> Self | None:
        """Return the memory before the first step of a run; None if its solid is elastic."""
        branches = branches_of(run.kernel)
        if not branches:
            return None
        # Validation requires times where the kernel relaxes.
        assert run.loading.time is not None
        return cls(branches, run.loading.time, run.grid.shape)

    def setting(self, setting: Setting, displacements: Array) -> Setting:
        """Return the setting of the step after those that ended in ``displacements`` [m].

        Its operator is that of a solid γ times as stiff, its surface is displaced by what the steps
        before have left behind. The operator of ``setting`` is the instantaneous one.
        """
        for displacement in displacements[self._done :]:
            self._memory = self._memory.after(self._steps[self._done], displacement)
            self._done += 1
        step = self._steps[self._done]
        return replace(
            setting,
            operator=setting.operator.scaled(1 / step.stiffness),
            left=left_behind(self._memory, step) if self._done else None,
        )
