"""The figure of a fit: the curve, what is left of it, and which pairs of parameters explain it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array
from pellicle.fitting.fit import Fit
from pellicle.fitting.models.force_model import MODULUS, TENSION
from pellicle.report.plotting import axis_unit

from .pictures import Drawn, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

_JOINT = (2.30, 5.99)
"""Rises of χ² that two parameters together exceed by chance in 32 % and 5 % of curves."""
_ROWS, _STEPS = 31, 21
_FINE = 500
_HALF = 4.5
"""How far from the ridge tensions are drawn, in standard deviations at one modulus."""
_OPEN = 10.0
"""How far an open interval of the modulus is drawn, as a factor."""
_LEVELS = np.linspace(0, 4, 17)
_WITHOUT = "without tension"


def curve(fit: Fit, axes: Axes) -> None:
    """Draw data, fit and the fit without tension."""
    data = fit.likelihood
    scale, name, length, _ = _units(fit)
    z = data.position * length
    axes.plot(z, data.force * scale, ".", color="0.6", markersize=3, label="data")
    fine = replace(data, position=np.linspace(data.position[0], data.position[-1], _FINE))
    for parameters, style, label in (
        (fit.parameters_without_tension, "C1--", _WITHOUT),
        (fit.parameters, "C0-", "fit"),
    ):
        axes.plot(fine.position * length, fine.model(parameters) * scale, style, label=label)
    axes.axvline(fit.contact_point.value * length, color="0.3", linewidth=0.8, linestyle=":")
    axes.set_ylabel(f"force [{name}]")
    axes.legend()


def residuals(fit: Fit, axes: Axes) -> None:
    """Draw what is left of the force, over the noise, with tension and without."""
    data = fit.likelihood
    *_, length, length_name = _units(fit)
    z = data.position * length
    for parameters, colour, label in (
        (fit.parameters_without_tension, "C1", _WITHOUT),
        (fit.parameters, "C0", "fit"),
    ):
        left = -data.residuals(parameters)
        axes.plot(z, left, ".", color=colour, markersize=2, alpha=0.5, label=f"_{label}")
    axes.axhline(0, color="0.3", linewidth=0.8)
    axes.set(xlabel=f"position [{length_name}]", ylabel="residual / noise")


def likelihood_map(fit: Fit, axes: Axes) -> None:
    """Draw the rise of the least χ² at held modulus and tension, along their ridge."""
    moduli, tensions, rise = _rises(fit)
    scale, name = axis_unit(moduli, "Pa")
    tension_scale, tension_name = axis_unit(tensions, "N/m")
    x, y = moduli * scale, tensions * tension_scale
    filled = axes.contourf(x, y, np.sqrt(np.maximum(rise, 0)), _LEVELS, cmap="Blues_r")
    axes.contour(x, y, rise, _JOINT, colors="black", linewidths=0.8)
    axes.plot(fit.reduced_modulus.value * scale, fit.tension.value * tension_scale, "k+")
    for estimate, unit, line in (
        (fit.reduced_modulus, scale, axes.axvline),
        (fit.tension, tension_scale, axes.axhline),
    ):
        for end in (estimate.low, estimate.high):
            if end is not None:
                line(end * unit, color="C3", linewidth=0.8, linestyle=":")
    axes.set(xlabel=f"reduced modulus [{name}]", ylabel=f"tension [{tension_name}]")
    axes.set_title("68 % and 95 % of the pair; dotted: 95 % of each alone", fontsize="medium")
    figure = axes.get_figure()
    if figure is not None:
        figure.colorbar(filled, ax=axes, label="√Δχ²")


def _rises(fit: Fit) -> tuple[Array, Array, Array]:
    """Return moduli, tensions and rises of χ², each of shape (m, n), row by row of one modulus."""
    fixed = replace(fit.likelihood, free=tuple(p for p in fit.likelihood.free if p != MODULUS))
    moduli = _moduli(fit)
    tensions = np.empty((_ROWS, _STEPS))
    rise = np.empty_like(tensions)
    warm = fit.parameters
    nearest = np.argsort(np.abs(moduli - fit.reduced_modulus.value))
    for row in nearest:
        start = warm.copy()
        start[MODULUS] = np.log(moduli[row])
        ridge = fixed.minimise(start).parameters
        deviation = fixed.deviations(ridge)[TENSION]
        half = _HALF * (deviation if np.isfinite(deviation) else ridge[TENSION])
        lowest = max(ridge[TENSION] - half, 0.0)
        tensions[row] = np.linspace(lowest, ridge[TENSION] + half, _STEPS)
        for column, tension in enumerate(tensions[row]):
            start = ridge.copy()
            start[TENSION] = tension
            rise[row, column] = fixed.minimise(start, (TENSION,)).chi_squared - fit.chi_squared
    return np.repeat(moduli[:, None], _STEPS, axis=1), tensions, rise


def pictures(fit: Fit) -> list[Drawn]:
    """Return the pictures of a fit: the curve, and the map if there is one."""
    drawn = [
        Drawn(
            partial(_left, fit),
            "Data, fit, and the fit without tension; below, what each leaves.",
        )
    ]
    if not (fit.reduced_modulus.held or fit.tension.held):
        said = "The pairs of modulus and tension that explain the curve."
        drawn.append(Drawn(partial(_right, fit), said))
    return drawn


def _left(fit: Fit, figure: FigureBase) -> None:
    cells = figure.add_gridspec(2, 1, height_ratios=(3, 1))
    upper = figure.add_subplot(cells[0])
    curve(fit, upper)
    residuals(fit, figure.add_subplot(cells[1], sharex=upper))


def _right(fit: Fit, figure: FigureBase) -> None:
    likelihood_map(fit, figure.add_subplot())


def save_figure(fit: Fit, path: Path) -> Path:
    """Write the figure of a fit and return its file.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    return save(pictures(fit), path)


def _units(fit: Fit) -> tuple[float, str, float, str]:
    return (*axis_unit(fit.likelihood.force, "N"), *axis_unit(fit.likelihood.position, "m"))


def _moduli(fit: Fit) -> Array:
    """Return moduli from somewhat below the interval to somewhat above."""
    estimate = fit.reduced_modulus
    low = estimate.value / _OPEN if estimate.low is None else estimate.low
    high = estimate.value * _OPEN if estimate.high is None else estimate.high
    return np.geomspace(low**1.4 / high**0.4, high**1.4 / low**0.4, _ROWS)
