"""Carry the history of a solid that relaxes from one load step to the next.

Its displacements are the history cell by cell where all waves relax alike and nothing but the solid
carries, and wave by wave on a periodic boundary. On a free boundary the solid is displaced outside
the domain too; there its pressures are the history, which the domain holds.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Final, TypeVar

import numpy as np
import scipy.fft

from pellicle.arrays import Array
from pellicle.checks import errors_attributed_to
from pellicle.components import Kernel, Setting
from pellicle.components.kernel import branches_of, instantaneous
from pellicle.config.run import Run
from pellicle.contact.load_step import FinishedStep
from pellicle.contact.problem import Traction
from pellicle.contact.time_step import History, TimeStep, depend_on_wave
from pellicle.grid import Grid
from pellicle.surface import Operator, operator_of
from pellicle.surface.few_waves import FewWaves, Span, sampled_waves

Composed = TypeVar("Composed", Setting, Traction)
# Lengths of steps whose operators are kept on a periodic boundary, and the size of what is kept of
# one in arrays of the grid's shape.
_KEPT: Final = 4
_OF_LENGTH: Final = 1.15
# Arrays of a few waves on a free boundary: those of one on all grids, and of their sum.
_OF_WAVE: Final = 4.3
_OF_SUM: Final = 9.0
# Equal steps whose times differ by rounding share their operators.
_DIGITS: Final = 12
# Earlier steps whose responses a span is made of, at most, and the steps after each that count.
_SAMPLED: Final = 64
_LATER: Final = (0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 256, 512, 1024)


class Relaxation:
    """The history of a solid, brought forward by the pressures and displacements of the steps.

    The history is a function of these alone, so a resumed run brings it forward from those in its
    file and goes on with the same numbers.
    """

    def __init__(self, run: Run, operator: Operator) -> None:
        """Take the operator of the instantaneous response."""
        self._run, self._history = run, _kind_of(run)(run, operator)

    @property
    def applications(self) -> int:
        """Operator applications of the last `setting` to bring the history forward by one step."""
        return self._history.applications

    def setting(self, setting: Composed, path: Sequence[FinishedStep]) -> Composed:
        """Return the setting of the step after those of a path; each of them is taken once.

        Its operator is that of a solid γ times as stiff, its surface is displaced by what the steps
        before have left behind. The operator of ``setting`` is the instantaneous one.
        """
        with errors_attributed_to(self._run.kernel):
            operator, left = self._history.step(path)
        return replace(setting, operator=operator, left=left if path else None)


def history_arrays(run: Run) -> float:
    """Return the memory of the history of a solid, in arrays of the grid's shape; 0 if elastic.

    The displacement that is left and the profile that it displaces are part of it.
    """
    with errors_attributed_to(run.kernel):
        return _kind_of(run).arrays(run) if run.branches else 0.0


def _kind_of(run: Run) -> type[_Cells | _Waves | _Pressures]:
    if run.kernel.without_skin() == run.kernel and not depend_on_wave(run.branches):
        return _Cells
    return _Waves if run.grid.boundary == "periodic" else _Pressures


class _Cells:
    """The displacement of each cell, of a solid without a skin all of whose waves relax alike."""

    applications = 0

    @staticmethod
    def arrays(run: Run) -> float:
        # Branches twice, as they are brought forward.
        return 2 * len(run.branches) + 3.0

    def __init__(self, run: Run, operator: Operator) -> None:
        self._operator = operator
        self._steps = [TimeStep.of(run.branches, duration) for duration in run.loading.durations]
        self._history, self._done = History.at_rest(run.branches, run.grid.shape), 0

    def step(self, path: Sequence[FinishedStep]) -> tuple[Operator, Array]:
        for done, finished in zip(self._steps[self._done :], path[self._done :], strict=False):
            self._history = self._history.after(done, finished.displacement)
        self._done = len(path)
        step = self._steps[self._done]
        left: Array = self._history.residual(step) / -step.stiffness
        return self._operator.scaled(1 / float(step.stiffness)), left


class _Waves:
    """The displacement of each wave of a periodic domain."""

    applications = 0

    @staticmethod
    def arrays(run: Run) -> float:
        lengths = len({*map(_rounded, run.loading.durations)})
        return 2 * len(run.branches) + 6.0 + min(_KEPT, lengths) * _OF_LENGTH

    def __init__(self, run: Run, operator: Operator) -> None:
        self._run, self._operator = run, operator
        self._solid = operator_of(run.kernel.without_skin(), run.grid).factors
        self._q = np.hypot(*run.grid.wavenumbers())
        self._history, self._done = History.at_rest(run.branches, self._q.shape, complex), 0
        self._step = self._step_at(0)
        self._of_length = lru_cache(_KEPT)(self._make)

    def step(self, path: Sequence[FinishedStep]) -> tuple[Operator, Array]:
        for finished in path[self._done :]:
            waves = scipy.fft.rfft2(finished.displacement)
            self._history = self._history.after(self._step, waves)
            self._done += 1
            self._step = self._step_at(self._done)
        operator, carried = self._of_length(_rounded(self._run.loading.durations[self._done]))
        left = -carried * self._history.residual(self._step)
        return operator, scipy.fft.irfft2(left, self._run.grid.shape)

    def _step_at(self, index: int) -> TimeStep:
        return TimeStep.of(self._run.branches, self._run.loading.durations[index], self._q)

    def _make(self, duration: float) -> tuple[Operator, Array]:
        """Return the operator of a step, and its factors over those of the solid at once."""
        operator = self._operator
        if duration:
            operator = operator_of(stiffen(self._run.kernel, duration), self._run.grid)
        # A mean that is not displaced has a compliance of 0.
        nothing = np.zeros_like(self._solid)
        return operator, np.divide(
            operator.factors, self._solid, out=nothing, where=self._solid > 0
        )


class _Pressures:
    """The pressures of all steps, and the responses of the surface to each of them.

    They act within the domain, and the responses are those of the infinite surface.
    """

    @staticmethod
    def arrays(run: Run) -> float:
        durations = run.loading.durations
        waves = len(span_of(run.kernel, durations, run.grid).waves)
        return _OF_SUM + _OF_WAVE * waves + run.steps

    def __init__(self, run: Run, operator: Operator) -> None:
        durations = run.loading.durations
        self._operator, self._durations, self._kernel = operator, durations, run.kernel
        span = span_of(run.kernel, durations, run.grid)
        self._waves, self._few = span.waves, FewWaves(instantaneous(run.kernel), span, operator)
        self._of_length: tuple[float, Operator] | None = None
        self._responses = responses(run.kernel, durations, span.waves, range(len(durations)))
        self._done = -1

    @property
    def applications(self) -> int:
        """Those that take as long as the transforms of one step."""
        return self._few.applications if self._done > 0 else 0

    def step(self, path: Sequence[FinishedStep]) -> tuple[Operator, Array | None]:
        values = None
        while self._done < len(path):
            values = next(self._responses)
            self._done += 1
        assert values is not None, "each step is taken once"
        operator = self._stepping(_rounded(self._durations[self._done]))
        if not path:
            return operator, None
        pressures = np.array([finished.state.pressure for finished in path])
        return operator, self._few.displacement(np.tensordot(values[: len(path)].T, pressures, 1))

    def _stepping(self, duration: float) -> Operator:
        """Return the operator of a step, which equal steps in a row share."""
        if not duration:
            return self._operator
        if self._of_length is None or self._of_length[0] != duration:
            # The last one goes before the next is made.
            self._of_length = None
            stiffer = stiffen(self._kernel, duration).compliance(self._waves)
            operator = self._few.interpolated(stiffer / self._kernel.compliance(self._waves))
            self._of_length = duration, operator
        return self._of_length[1]


def _rounded(duration: float) -> float:
    return float(f"{duration:.{_DIGITS}g}")


def stiffen(kernel: Kernel, duration: float) -> Kernel:
    """Return the elastic kernel of a step of ``duration`` [s]: γ times the solid under its skin."""
    branches = branches_of(kernel)
    if depend_on_wave(branches):
        return kernel.scaled(lambda q: TimeStep.of(branches, duration, q).stiffness)
    return kernel.scaled(float(TimeStep.of(branches, duration).stiffness))


def responses(
    kernel: Kernel, durations: Sequence[float], q: Array, sources: Sequence[int]
) -> Iterator[Array]:
    """Yield after each step the displacement of waves ``q`` over that at once, G(q).

    It is of shape (sources, q): by a unit pressure at each of the steps ``sources``, and by none at
    any other.
    """
    branches = branches_of(kernel)
    solid, whole = kernel.without_skin().compliance(q), kernel.compliance(q)
    history = History.at_rest(branches, (len(sources), q.size))
    for index, duration in enumerate(durations):
        step, operator = TimeStep.of(branches, duration, q), stiffen(kernel, duration)
        compliance = operator.compliance(q)
        displacement = history.residual(step) * (-compliance / solid)
        if index in sources:
            displacement[sources.index(index)] += compliance / whole
        history = history.after(step, displacement)
        yield displacement


@lru_cache(maxsize=4)
def span_of(kernel: Kernel, durations: tuple[float, ...], grid: Grid) -> Span:
    """Return the span of the responses of an isotropic kernel to the steps of a path."""
    q = sampled_waves(grid)
    sources = np.unique(np.linspace(0, len(durations) - 1, _SAMPLED).round().astype(int)).tolist()
    samples = [np.ones((1, q.size))]
    for index, displacement in enumerate(responses(kernel, durations, q, sources)):
        samples.append(displacement[[index - source in _LATER for source in sources]])
    return Span(q, np.concatenate(samples))
