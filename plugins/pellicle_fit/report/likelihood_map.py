"""The map of the pairs of modulus and tension that describe a curve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array
from pellicle.units import axis_unit
from pellicle_fit.candidate import Candidate
from pellicle_fit.objective import MODULUS
from pellicle_fit.recipe import TENSION
from pellicle_fit.result import parameters_of

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

_JOINT = (2.30, 5.99)
"""Δχ² that bounds 68 % and 95 % confidence regions of two quantities."""
_MODULI, _TENSIONS = 31, 21
"""Points along the modulus, and along the tension at each modulus."""
_HALF_WIDTH = 4.5
"""Moduli and tensions drawn to either side, in standard deviations."""
_FURTHEST = np.log(10.0)
"""Moduli drawn to either side at most, as a logarithm."""


def likelihood_map(explained: Candidate, figure: FigureBase) -> None:
    """Draw √Δχ² over modulus and tension of an explanation, minimised over the rest."""
    moduli, tensions, rises = _grid(explained)
    estimates, axes = parameters_of(explained), figure.add_subplot()
    (pascal, modulus_unit), (newton, tension_unit) = (
        axis_unit(moduli, "Pa"),
        axis_unit(tensions, "N/m"),
    )
    x, y = moduli * pascal, tensions * newton
    levels = np.linspace(0, 4, 17)
    filled = axes.contourf(x, y, np.sqrt(np.maximum(rises, 0)), levels, cmap="Blues_r")
    axes.contour(x, y, rises, _JOINT, colors="black", linewidths=0.8)
    modulus, tension = estimates[MODULUS], estimates[TENSION]
    axes.plot(modulus.value * pascal, tension.value * newton, "k+")
    for estimate, factor, line in (
        (modulus, pascal, axes.axvline),
        (tension, newton, axes.axhline),
    ):
        for end in (estimate.low, estimate.high):
            if end is not None:
                line(end * factor, color="0.2", linewidth=1.0, linestyle=":")
    axes.set(xlabel=f"reduced modulus [{modulus_unit}]", ylabel=f"tension [{tension_unit}]")
    axes.set_title("68 % and 95 % of the pair; dotted: 95 % of each alone", fontsize="medium")
    figure.colorbar(filled, ax=axes, label="√Δχ²")


def _grid(explained: Candidate) -> tuple[Array, Array, Array]:
    """Return moduli [Pa], tensions [N/m] and Δχ², each of shape (moduli, tensions).

    The tensions of a row surround the best tension at its modulus, so that the grid follows a
    narrow ridge.
    """
    objective, best = explained.objective, explained.minimum
    names = [slot.name for slot in objective.slots]
    e, t = names.index(MODULUS), names.index(TENSION)
    rest = [k for k in range(len(names)) if k not in (e, t)]
    half_width = min(_HALF_WIDTH * objective.deviations(best.at)[e], _FURTHEST)
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
        half = _HALF_WIDTH / np.linalg.norm(by_tension + by_rest @ along)
        tensions[row] = np.linspace(max(ridge[t] - half, 0.0), ridge[t] + half, _TENSIONS)
        for column, tension in enumerate(tensions[row]):
            at = np.array(ridge)
            at[t] = tension
            at[rest] += along * (tension - ridge[t])
            rises[row, column] = objective.chi_squared(at) - best.chi_squared
    moduli = [objective.slots[e].value(modulus) for modulus in coordinates]
    in_si = [[objective.slots[t].value(tension) for tension in row] for row in tensions]
    return np.repeat(np.array(moduli)[:, None], _TENSIONS, axis=1), np.array(in_si), rises
