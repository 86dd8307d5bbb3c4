"""The figure of a pooled fit: its curves, what is left, and the profiles of what is shared."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array
from pellicle.fitting.models.force_model import (
    MODULUS,
    OFFSET,
    SLOPE,
    Coordinates,
    Parameter,
)
from pellicle.fitting.pooled import PooledFit
from pellicle.fitting.statistics.likelihood import Likelihood
from pellicle.report.plotting import axis_unit

from .pictures import Drawn, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

_STEPS = 15
_BEYOND = 0.4
"""How far beyond an interval a profile is drawn, over its width."""
_NAMED = 8
"""Curves that a legend has room for."""
_OPEN = 3.0
"""How far an open end is drawn, in standard deviations."""


def curves(fit: PooledFit, axes: Axes) -> None:
    """Draw data and fit of each curve, depth and force each over its largest."""
    for number, (member, part) in enumerate(_each(fit)):
        baseline = part[OFFSET] + part[SLOPE] * (member.position - member.position[0])
        model = member.model(part) - baseline
        largest = float(np.max(np.abs(model)))
        data = (member.force - baseline) / largest
        depth, colour = _depth(member, part), f"C{number}"
        axes.plot(depth, data, ".", color=colour, alpha=0.3, markersize=2)
        axes.plot(depth, model / largest, color=colour, label=fit.curves[number].name)
    axes.set_ylabel("force / its largest")
    if len(fit.curves) <= _NAMED:
        axes.legend(fontsize="small")


def residuals(fit: PooledFit, axes: Axes) -> None:
    """Draw what is left of the force of each curve, over its noise."""
    for number, (member, part) in enumerate(_each(fit)):
        left = -member.residuals(part)
        axes.plot(_depth(member, part), left, ".", color=f"C{number}", markersize=2, alpha=0.5)
    axes.axhline(0, color="0.3", linewidth=0.8)
    axes.set(xlabel="depth / its largest", ylabel="residual / noise")


def profile(fit: PooledFit, which: Parameter, axes: Axes) -> None:
    """Draw the rise of the least χ² where modulus or tension is held."""
    estimate = fit.reduced_modulus if which == MODULUS else fit.tension
    values = _values(estimate.value, estimate.low, estimate.high, estimate.bound)
    rises = np.empty_like(values)
    warm = fit.parameters
    for at in np.argsort(np.abs(values - estimate.value)):
        start = warm.copy()
        start[which] = which.coordinate(values[at])
        rises[at] = fit.pool.minimise(start, (which,)).chi_squared - fit.chi_squared
    scale, unit = axis_unit(values, estimate.unit)
    axes.plot(values * scale, rises, "C0-")
    axes.axhline(fit.rise, color="0.3", linewidth=0.8, linestyle="--")
    for end in (estimate.low, estimate.high):
        if end is not None:
            axes.axvline(end * scale, color="C3", linewidth=0.8, linestyle=":")
    name = "reduced modulus" if which == MODULUS else "tension"
    axes.set(xlabel=f"{name} [{unit}]", ylabel="Δχ²", ylim=(0, 3 * fit.rise))


def pictures(fit: PooledFit) -> list[Drawn]:
    """Return the pictures of a pooled fit: its curves, and the profiles of what was fitted."""
    return [
        Drawn(
            partial(_left, fit),
            "Data and fit of each curve, depth and force over its largest; below, what is left.",
        ),
        Drawn(
            partial(_right, fit),
            "The rise of the least χ² where a parameter is held; dotted, the ends of its interval.",
        ),
    ]


def _left(fit: PooledFit, figure: FigureBase) -> None:
    cells = figure.add_gridspec(4, 1)
    upper = figure.add_subplot(cells[:3])
    curves(fit, upper)
    residuals(fit, figure.add_subplot(cells[3], sharex=upper))


def _right(fit: PooledFit, figure: FigureBase) -> None:
    free = [parameter for parameter in fit.pool.free if parameter.shared]
    for number, which in enumerate(free):
        profile(fit, which, figure.add_subplot(len(free), 1, number + 1))


def save_figure(fit: PooledFit, path: Path) -> Path:
    """Write the figure of a pooled fit and return its file.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    return save(pictures(fit), path)


def _each(fit: PooledFit) -> list[tuple[Likelihood, Coordinates]]:
    return list(zip(fit.pool.members, fit.pool.parts(fit.parameters), strict=True))


def _depth(member: Likelihood, part: Coordinates) -> Array:
    depth = member.depth(part)
    depth /= depth[-1]
    return depth


def _values(value: float, low: float | None, high: float | None, bound: float) -> Array:
    """Return values from somewhat below an interval to somewhat above, none of them negative."""
    half = _OPEN * (bound if np.isfinite(bound) else value)
    low = max(value - half, 0.0) if low is None else low
    high = value + half if high is None else high
    margin = _BEYOND * (high - low)
    return np.linspace(max(low - margin, 1e-3 * value), high + margin, _STEPS)
