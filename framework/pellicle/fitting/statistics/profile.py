"""The least χ² with tension and without, and the interval of each parameter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConvergenceError

from .estimate import Estimate
from .interval import Better, Ends, interval
from .likelihood import MODULUS, NAMES, TENSION, ChiSquared, Minimum, least


@dataclass(frozen=True)
class Profiled:
    """Minima of χ², and the intervals around the least."""

    likelihood: ChiSquared
    best: Minimum
    without_tension: Minimum
    """The least with tension held at 0."""
    ends: Mapping[int, Ends]
    """Of the interval of each parameter; log E* in Pa for the modulus."""
    messages: tuple[str, ...]
    """By how much the intervals were widened, and which could not be found."""

    @cached_property
    def _bound(self) -> Array:
        return self.likelihood.deviations(self.best.parameters)

    def estimate(self, which: int, unit: str) -> Estimate:
        """Return what is known of a parameter; of `MODULUS`, E* itself.

        What no interval was sought of has no ends.  An interval that is narrower than the bound
        has none: the bound is that of a model linear in its parameters, and this one is not.
        """
        value, bound = float(self.best.parameters[which]), float(self._bound[which])
        held = which not in self.likelihood.free
        low, high = (value, value) if held else self.ends.get(which, (None, None))
        # The tension ends at 0.
        lowest = 0.0 if which == TENSION and low is None else low
        if lowest is not None and high is not None and max(high - value, value - lowest) < bound:
            bound = np.inf
        found = Estimate(value, low, high, unit, bound, held)
        return found.exponential() if which == MODULUS else found


def profiled(
    likelihood: ChiSquared,
    best: Minimum,
    rise: float,
    wanted: Sequence[int],
    without_tension: Callable[[Minimum], Minimum],
    report: Callable[[str], None] = lambda words: None,
) -> Profiled:
    """Return the minimum near ``best``, that without tension, and intervals of what is ``wanted``.

    ``without_tension`` finds a minimum without tension from one with it.  The intervals are where
    χ² has risen by ``rise``, widened by what the grids of a simulated curve may have shifted.
    ``report`` is called with what is sought.
    """
    while True:
        report("without tension")
        without = without_tension(best)
        if TENSION in likelihood.free and without.chi_squared <= best.chi_squared + 1e-6:
            # As good, and then exactly on the edge.
            best = without
        ends: dict[int, Ends] = {}
        lost = []
        try:
            for which in wanted:
                report(f"interval of {NAMES[likelihood.kind(which)]}")
                try:
                    ends[which] = interval(likelihood, best, which, rise)
                except ConvergenceError:
                    ends[which] = None, None
                    lost.append(NAMES[likelihood.kind(which)])
        except Better as better:
            again = likelihood.minimise(better.minimum.parameters)
            best = least([again, better.minimum])
        else:
            wider, messages = widened(ends, likelihood, best)
            if lost:
                messages += (_unsettled(lost),)
            return Profiled(likelihood, best, without, wider, messages)


def _unsettled(lost: Sequence[str]) -> str:
    return (
        f"no search for the interval of {', '.join(lost)} came to an end, and it is left open: the "
        "curve does not tell the parameters apart; hold one of them, or fit less of the baseline"
    )


def widened(
    ends: Mapping[int, Ends], likelihood: ChiSquared, best: Minimum
) -> tuple[Mapping[int, Ends], tuple[str, ...]]:
    """Return intervals with what the grids of a simulated curve may have shifted, and say it."""
    coarser = likelihood.coarse()
    if coarser is None:
        return ends, ()
    shift = np.abs(coarser.minimise(best.parameters).parameters - best.parameters)
    tension = best.parameters[TENSION]
    said = [f"the modulus by {100 * np.expm1(shift[MODULUS]):.2g} %"] * (MODULUS in ends)
    if TENSION in ends and tension:
        said.append(f"the tension by {100 * shift[TENSION] / tension:.2g} %")
    message = (
        f"the force curve is simulated, to {100 * likelihood.accuracy:.2g} %; half as many cells "
        f"change {' and '.join(said)}, and the intervals are widened by that"
    )
    wider = {}
    for which, (low, high) in ends.items():
        low = None if low is None else low - shift[which]
        if which == TENSION and low is not None and low <= 0:
            low = None
        wider[which] = low, None if high is None else high + shift[which]
    return wider, (message,)
