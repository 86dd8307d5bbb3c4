"""The map of the pairs of modulus and tension that describe a curve."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Axis, Chart, Look, Series
from pellicle_fit.candidate import Candidate
from pellicle_fit.objective import MODULUS
from pellicle_fit.recipe import TENSION
from pellicle_fit.result import parameters_of

from .guides import guide

_JOINT = {2.30: "68 % of the pair", 5.99: "95 % of the pair"}
"""Δχ² that bounds confidence regions of two quantities."""
_MODULI, _TENSIONS = 31, 21
"""Points along the modulus, and along the tension at each modulus."""
_HALF_WIDTH = 4.5
"""Moduli and tensions drawn to either side, in standard deviations."""
_FURTHEST = np.log(10.0)
"""Moduli drawn to either side at most, as a logarithm."""


def likelihood_map(explained: Candidate, widened: float) -> Chart:
    """Return the edges of what describes curves, with all but modulus and tension sought.

    Δχ² at the edges is ``widened`` for curves that do not agree.
    """
    from matplotlib.figure import Figure

    grid, own = _grid(explained, widened), parameters_of(explained)
    edges = Figure().add_subplot().contour(*grid, [level * widened for level in _JOINT]).allsegs
    series = [
        Series(points[:, 0], points[:, 1], legend=name * (points is lines[0]), look=Look(0, line))
        for line, (name, lines) in enumerate(zip(_JOINT.values(), edges, strict=True))
        for points in lines
    ]
    modulus, tension = own[MODULUS], own[TENSION]
    best = np.array([modulus.value]), np.array([tension.value])
    series.append(Series(*best, legend="best", look=Look(0, None, 0)))
    x, y = (np.concatenate(ends) for ends in zip(*((s.x, s.y) for s in series), strict=True))
    across, along = [x.min(), x.max()], [y.min(), y.max()]
    moduli = [guide([end] * 2, along) for end in (modulus.low, modulus.high) if end is not None]
    tensions = [guide(across, [end] * 2) for end in (tension.low, tension.high) if end is not None]
    named = guide([], [], "95 % of each alone")
    axes = Axis("reduced modulus", "Pa"), [Axis("tension", "N/m")]
    return Chart(*axes, [*series, *moduli, *tensions, named])


def _grid(explained: Candidate, widened: float = 1.0) -> tuple[Array, Array, Array]:
    """Return moduli [Pa], tensions [N/m] and Δχ², each of shape (moduli, tensions).

    The tensions of a row surround the best tension at its modulus, so that the grid follows a
    narrow ridge.
    """
    objective, best = explained.objective, explained.minimum
    names = [slot.name for slot in objective.slots]
    e, t = names.index(MODULUS), names.index(TENSION)
    rest = [k for k in range(len(names)) if k not in (e, t)]
    reach = _HALF_WIDTH * np.sqrt(widened)
    half_width = min(reach * objective.deviations(best.at)[e], _FURTHEST)
    coordinates = best.at[e] + np.linspace(-half_width, half_width, _MODULI)
    tensions = np.empty((_MODULI, _TENSIONS))
    rises = np.empty_like(tensions)
    for row, modulus in enumerate(coordinates):
        start = np.array(best.at)
        start[e] = modulus
        ridge = objective.minimise(start, (e,)).at
        # Away from the ridge the rest moves, to first order, as this makes χ² least.
        by_tension = objective.jacobian(ridge, (t,))[:, 0]
        by_rest = objective.jacobian(ridge, rest) if rest else np.empty((by_tension.size, 0))
        along = -np.linalg.lstsq(by_rest, by_tension, rcond=1e-12)[0]
        half = reach / np.linalg.norm(by_tension + by_rest @ along)
        tensions[row] = np.linspace(max(ridge[t] - half, 0.0), ridge[t] + half, _TENSIONS)
        for column, tension in enumerate(tensions[row]):
            at = np.array(ridge)
            at[t] = tension
            at[rest] += along * (tension - ridge[t])
            rises[row, column] = objective.chi_squared(at) - best.chi_squared
    moduli = [objective.slots[e].value(modulus) for modulus in coordinates]
    in_si = [[objective.slots[t].value(tension) for tension in row] for row in tensions]
    return np.repeat(np.array(moduli)[:, None], _TENSIONS, axis=1), np.array(in_si), rises
