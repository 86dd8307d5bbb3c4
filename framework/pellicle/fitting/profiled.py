"""The least χ² with tension and without, and the interval of each parameter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pellicle.operators import Array

from .explained import best_of
from .interval import Better, Minimum, interval
from .likelihood import MODULUS, TENSION, ChiSquared, Likelihood
from .start import starts


def profiled(
    likelihood: Likelihood, start: Array, rise: float
) -> tuple[Minimum, Minimum, dict[int, tuple[float | None, float | None]]]:
    """Return the minimum, that without tension, and the interval of each free parameter."""
    best = Minimum(*likelihood.minimise(start))
    while True:
        without = _without_tension(likelihood, best)
        if TENSION in likelihood.free and without.chi_squared <= best.chi_squared + 1e-6:
            # As good, and then exactly on the edge.
            best = without
        try:
            ends = {k: interval(likelihood, best, k, rise) for k in likelihood.free}
        except Better as better:
            best = Minimum(*likelihood.minimise(better.minimum.parameters))
            if best.chi_squared > better.minimum.chi_squared:
                best = better.minimum
        else:
            return best, without, ends


def _without_tension(likelihood: Likelihood, best: Minimum) -> Minimum:
    start = best.parameters.copy()
    start[TENSION] = 0.0
    held = replace(likelihood, free=tuple(k for k in likelihood.free if k != TENSION))
    found = [held.minimise(start)]
    found += [held.minimise(each) for each in starts(held, start)[:1]]
    return best_of(found)


def widened(
    ends: dict[int, tuple[float | None, float | None]],
    likelihood: ChiSquared,
    best: Minimum,
    messages: list[str],
) -> dict[int, tuple[float | None, float | None]]:
    """Return intervals with what the grids of a simulated curve may have shifted added to them."""
    coarser = likelihood.coarse()
    if coarser is None:
        return ends
    coarse, _ = coarser.minimise(best.parameters)
    shift = np.abs(coarse - best.parameters)
    tension = best.parameters[TENSION]
    said = [f"the modulus by {100 * np.expm1(shift[MODULUS]):.2g} %"] * (MODULUS in ends)
    if TENSION in ends and tension:
        said.append(f"the tension by {100 * shift[TENSION] / tension:.2g} %")
    messages.append(
        f"the force curve is simulated, to {100 * likelihood.accuracy:.2g} %; half as many cells "
        f"change {' and '.join(said)}, and the intervals are widened by that"
    )
    wider = {}
    for which, (low, high) in ends.items():
        low = None if low is None else low - shift[which]
        if which == TENSION and low is not None and low <= 0:
            low = None
        wider[which] = low, None if high is None else high + shift[which]
    return wider
