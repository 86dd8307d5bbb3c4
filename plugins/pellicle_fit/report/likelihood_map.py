"""The map of the pairs of modulus and tension that describe a curve."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Axis, Chart, Look, Series
from pellicle_fit.estimation.candidate import Candidate
from pellicle_fit.estimation.coordinates import MODULUS
from pellicle_fit.selection.recipe import TENSION

_JOINT = {2.30: "68 % of the pair", 5.99: "95 % of the pair"}
"""Δχ² that bounds confidence regions of two quantities."""
_MODULI = 61
"""Moduli at which all else is sought."""
_HALF_WIDTH = 4.5
"""Distance of these to either side, in standard deviations."""
_FURTHEST = np.log(10.0)
"""The same at most, as a logarithm."""
_POINTS = 201
"""Points of an edge."""


def likelihood_map(explained: Candidate, widened: float) -> Chart:
    """Return the edges of what describes curves, with all but modulus and tension sought.

    At each modulus χ² is a parabola of the tension, whose width is that to first order: the rest
    moves as this makes χ² least, as do errors of the calibration that are weighed. Δχ² at the edges
    is ``widened`` for curves that do not agree.
    """
    objective, best = explained.calibration_minimum or (explained.objective, explained.minimum)
    names = [slot.name for slot in objective.slots]
    e, t = names.index(MODULUS), names.index(TENSION)
    rest = [k for k in range(len(names)) if k not in (e, t)]

    def in_si(k: int, coordinates: Array) -> Array:
        return np.array([objective.slots[k].value(coordinate) for coordinate in coordinates])

    half_width = _HALF_WIDTH * np.sqrt(widened) * objective.deviations(best.at)[e]
    moduli = best.at[e] + min(half_width, _FURTHEST) * np.linspace(-1.0, 1.0, _MODULI)
    ridge = np.empty((4, _MODULI))
    for column, modulus in enumerate(moduli):
        start = np.array(best.at)
        start[e] = modulus
        found = objective.minimise(start, (e,))
        at, chi_squared = found.at, found.chi_squared
        by_tension, *by_rest = objective.jacobian(at, [t, *rest]).T
        others = np.array(by_rest).reshape(len(rest), -1).T
        along = by_tension - others @ np.linalg.lstsq(others, by_tension, rcond=1e-12)[0]
        width = 1 / np.linalg.norm(along)
        # Where the best tension is 0, χ² has a slope there.
        slope = width * (along @ objective.terms(at))
        ridge[:, column] = at[t], chi_squared - best.chi_squared, width, max(slope, 0.0)
    rises, lowest, series = ridge[1], int(ridge[1].argmin()), []
    angle = np.linspace(0.0, 2 * np.pi, _POINTS)
    for line, (level, name) in enumerate(_JOINT.items()):
        top, branches = level * widened, (slice(lowest, None, -1), slice(lowest, None))
        left, right = (np.interp(top, rises[one], moduli[one]) for one in branches)
        x = (left + right) / 2 - (right - left) / 2 * np.cos(angle)
        tension, rise, width, slope = (np.interp(x, moduli, of) for of in ridge)
        reach = width * (np.sqrt(slope**2 + np.maximum(top - rise, 0.0)) - slope)
        y = np.maximum(tension + np.where(angle < np.pi, reach, -reach), 0.0)
        series.append(Series(in_si(e, x), in_si(t, y), legend=name, look=Look(0, line)))
    pair = in_si(e, best.at[[e]]), in_si(t, best.at[[t]])
    series.append(Series(*pair, legend="best", look=Look(0, None, 0)))
    return Chart(Axis("reduced modulus", "Pa"), [Axis("tension", "N/m")], series)
