"""Carry the memory of a solid that relaxes from one load step to the next."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Final

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import errors_attributed_to
from pellicle.components import Kernel, Setting
from pellicle.components.calls import branches_of
from pellicle.config.run import Run
from pellicle.contact.time_step import (
    Memory,
    TimeStep,
    left_behind,
    left_behind_under_skin,
    stiffness_after,
    strain_under_skin,
)
from pellicle.grid import Grid
from pellicle.surface.kernel_calls import mean_compliance
from pellicle.surface.outside import PlaneOperator

# Equal steps whose times differ by rounding share their operators.
_DIGITS: Final = 12
# Softest solid, over its instantaneous stiffness, and longest wave, over a third of the domain,
# that are told from a liquid.
_SOFTEST: Final = 1e-9
_LONGEST: Final = 1e9
# Largest stiffness in the end, over the instantaneous one, of a liquid; it is rounding.
_LIQUID: Final = 1e-12
# Relaxation times below this share of the shortest step are far below it.
_FAST: Final = 0.01
# Size of both operators of a stiffness γ, in arrays of the grid's shape.
_PAIR: Final = {"free": 13.5, "periodic": 1.3}
# 8 radii of a contact, to each of which its counted cells may add a hundredth.
_RADII: Final = 7.9
# Number of stiffnesses γ whose operators are kept under a skin.
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


class SkinOperators:
    """The operators of a skin on a solid that relaxes, for each stiffness γ of the solid."""

    def __init__(self, kernel: Kernel, grid: Grid) -> None:
        solid = kernel.without_skin()

        @lru_cache(maxsize=_OPERATORS)
        def whole(share: float) -> PlaneOperator:
            with errors_attributed_to(kernel):
                return PlaneOperator(kernel.scaled(share), grid)

        @lru_cache(maxsize=_OPERATORS)
        def carried(share: float) -> PlaneOperator:
            with errors_attributed_to(kernel):
                return PlaneOperator(CarriedShare(kernel.scaled(share), solid), grid)

        self._whole, self._carried = whole, carried

    def whole(self, step: TimeStep) -> PlaneOperator:
        """Return the operator from pressure to displacement [m/Pa]."""
        return self._whole(_share(step))

    def carried(self, step: TimeStep) -> PlaneOperator:
        """Return the operator from pressure to what the solid carries, without unit."""
        return self._carried(_share(step))


def _share(step: TimeStep) -> float:
    return float(f"{step.stiffness:.{_DIGITS}g}")


def warn_of_relaxation(run: Run) -> None:
    """Warn if a solid relaxes to a liquid, or far faster than the steps of its run.

    A kernel that states its time span has a share of its own for all times beyond.
    """
    kernel, branches = run.kernel, branches_of(run.kernel)
    if not branches:
        return
    shortest, longest = kernel.time_span()
    if longest == math.inf and stiffness_after(branches, math.inf) < _LIQUID:
        warnings.warn(
            f"kernel: the shares of {kernel.type_name!r} that relax sum to 1, which makes the "
            "solid a liquid: in the end only a skin carries; let them sum to less for a solid",
            stacklevel=3,
        )
    least = min((duration for duration in run.loading.durations if duration > 0), default=0.0)
    fastest = min(branch.time for branch in branches)
    if shortest == 0.0 and fastest < _FAST * least:
        warnings.warn(
            f"loading: the shortest step takes {least:g} s, far longer than the relaxation time "
            f"{fastest:g} s of a share of the solid, so that how this share relaxes is not seen; "
            "use shorter steps where it matters, or a softer solid without the share",
            stacklevel=3,
        )


def least_domain(run: Run, index: int, largest_area: float) -> float:
    """Return the edge [m] that a domain needs at a step, for what its solid carries outside.

    It is 8 radii of the largest contact so far, since a solid remembers a contact that has shrunk,
    or 7.9 of those that the cells of ``largest_area`` [m²] count; and 3 times the length 1/q of the
    wave for which the skin is as stiff as the solid is after the duration of the run so far: 2τ₀/E*
    under a tension. It is 0 where there is nothing outside: at the first step, without a skin, and
    on a periodic boundary.
    """
    kernel, branches = run.kernel, branches_of(run.kernel)
    if not index or not branches or run.grid.boundary == "periodic":
        return 0.0
    solid = kernel.without_skin()
    if solid == kernel:
        return 0.0
    elapsed = math.fsum(run.loading.durations[: index + 1])
    share = max(_SOFTEST, stiffness_after(branches, elapsed))
    carried = CarriedShare(kernel.scaled(share), solid)
    shortest = 3 / min(run.grid.size)
    radius = math.sqrt(largest_area / math.pi)
    length = 0.0
    if share * carried.compliance(np.array([shortest])).item() < 0.5:
        waves = shortest * np.geomspace(1 / _LONGEST, 1.0, 1 + 20 * round(math.log10(_LONGEST)))
        stiff = np.flatnonzero(share * carried.compliance(waves) >= 0.5)
        length = 1 / float(waves[stiff[-1]]) if stiff.size else math.inf
    return max(_RADII * radius, 3 * length)


def history_arrays(run: Run) -> float:
    """Return the peak memory of the history of a solid, in arrays of the grid's shape.

    These are the branches, twice as they are brought forward, what they leave behind and the
    profile that it displaces; under a skin also the strain and the operators that are kept.
    """
    kernel, branches = run.kernel, branches_of(run.kernel)
    if not branches:
        return 0.0
    arrays = 2 * len(branches) + 3.0
    if kernel.without_skin() != kernel:
        steps = {TimeStep.of(branches, duration) for duration in run.loading.durations}
        kept = min(_OPERATORS, len({_share(step) for step in steps}))
        arrays += 1 + kept * _PAIR[run.grid.boundary]
    return arrays


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
        self._skin = SkinOperators(kernel, run.grid) if has_skin else None
        self._done = 0

    @property
    def applications(self) -> int:
        """Operator applications of the last `setting` to bring the memory forward by one step."""
        return 2 if self._skin and self._done else 0

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
            left = left_behind(self._memory, step) if self._done else None
            return replace(setting, operator=operator, left=left)
        if not self._done and step.is_jump:
            return setting
        whole, left = self._skin.whole(step), None
        if self._done:
            displacement = partial(whole, integral=float(self._integral.history(step)))
            left = left_behind_under_skin(self._memory, step, displacement)
        return replace(setting, operator=whole.operator, left=left)

    def _advance(self, pressure: Array, displacement: Array) -> None:
        """Bring the memory forward to the end of the next step."""
        step = self._steps[self._done]
        strain = displacement
        if self._skin:
            force = np.asarray(pressure.sum() * self._cell_area)
            remaining = float(force - self._integral.history(step))
            strain = strain_under_skin(
                self._memory, step, pressure, partial(self._skin.carried(step), integral=remaining)
            )
            self._integral = self._integral.after(step, np.asarray(remaining / step.stiffness))
        self._memory = self._memory.after(step, strain)
        self._done += 1
