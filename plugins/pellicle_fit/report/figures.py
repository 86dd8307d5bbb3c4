"""Figures of fits as panels beside each other: of one curve, of a pooled fit, of many curves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConvergenceError
from pellicle.show import LINES
from pellicle.show import save_figure as save_drawing
from pellicle.units import axis_unit
from pellicle_fit.many import ManyFits
from pellicle_fit.one_curve import Fit
from pellicle_fit.parameters import (
    CONTACT_POINT,
    MODULUS,
    OFFSET,
    SLOPE,
    TENSION,
    Coordinates,
    Parameter,
)
from pellicle_fit.pooled import PooledFit
from pellicle_fit.population.judgement import Row
from pellicle_fit.result import FitResult
from pellicle_fit.statistics.chi_squared import ChiSquared
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.profile import Estimate

from . import distributions
from .map_files import figure_size, map_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

SIZE = (5.2, 4.6)
"""Width and height of a panel [inch]."""
_JOINT = (2.30, 5.99)
"""Δχ² that bounds 68 % and 95 % confidence regions of two parameters."""
_MODULI, _TENSIONS = 31, 21
"""Points of the likelihood map along the modulus, and along the tension at each modulus."""
_MAP_HALF_WIDTH = 4.5
"""Tensions drawn to either side of the ridge, in standard deviations at fixed modulus."""
_OPEN_FACTOR = 10.0
"""Moduli drawn beyond the best value where the interval is open, as a factor."""
_PROFILE_MARGIN = 0.4
"""Values drawn beyond an interval, as a fraction of its width."""
_OPEN_DEVIATIONS = 3.0
"""Values drawn towards an open end, in standard deviations."""
_LEGEND_CURVES, _TICK_CURVES = 8, 20
"""Curves whose names have room in the legend of a pool, and below the axis of many fits."""
_BARS = 200
"""Curves whose intervals are drawn beside each other."""
_OPEN_TOP = 1.1
"""Position of an open upper end, as a multiple of the largest value drawn."""


class Panel(NamedTuple):
    """A part of a figure and its caption."""

    draw: Callable[[FigureBase], None]
    caption: str
    size: tuple[float, float] | None = None
    """Width and height [inch]; None for `SIZE`."""


def panels(fit: FitResult | ManyFits) -> list[Panel]:
    """Return the panels of a fit, of a pooled fit, or of many fits.

    The likelihood map needs a fitted modulus and tension; many fits need a fitted curve.
    """
    if isinstance(fit, ManyFits):
        return _panels_of_population(fit)
    if isinstance(fit, PooledFit):
        data = "Data and fit of each curve, relative to largest depth and force; below, residuals."
        profiles = (
            "The rise of the least χ² with a parameter fixed; dotted, the ends of its interval."
        )
        return [
            Panel(partial(_with_residuals, fit), data),
            Panel(partial(_profiles, fit), profiles),
        ]
    assert isinstance(fit, Fit)
    caption = "Data, fit, and the fit without tension; below, the residuals of both."
    drawings = [Panel(partial(_with_residuals, fit), caption)]
    if not (fit.reduced_modulus.held or fit.tension.held):
        caption = "The pairs of modulus and tension that describe the curve."
        drawings.append(Panel(lambda part: likelihood_map(fit, part.add_subplot()), caption))
    return drawings


def _panels_of_population(fits: ManyFits) -> list[Panel]:
    """Return bars of the estimates, their distributions and the images of force maps."""
    if not any("tension" in row for row in fits.rows):
        return []
    caption = "A bar is the interval: down to 0, or up to a triangle, where an end is open."
    drawings = []
    if len(fits.rows) <= _BARS:
        drawings.append(Panel(partial(_estimates, fits.rows), caption))
    if distributions.drawable(fits.rows):
        caption = (
            "Accepted curves, by group, in histograms those with closed intervals; dashed, the "
            "median; ringed, a modulus that stands out."
        )
        draw = partial(distributions.distributions, fits.rows)
        drawings.append(Panel(draw, caption, distributions.SIZE))
    for name, images in fits.maps.items():
        title = Path(name).name
        caption = f"{title}: grey where there is no accepted fit, or an interval is open."
        drawings.append(Panel(map_figure(images, title), caption, figure_size(images)))
    return drawings


def save_figure(fit: FitResult, path: Path) -> Path:
    """Write the panels of a fit beside each other as png, pdf or svg, and return the file.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    beside = panels(fit)
    draw, size = partial(_beside, beside), _size(beside)
    (file,) = save_drawing(draw, path.with_suffix(""), [path.suffix[1:]], size)
    return file


def plot(fit: FitResult) -> Figure:
    """Return a figure of pyplot with the panels of a fit beside each other.

    A notebook shows it once, also where it is the last line of a cell.
    """
    from matplotlib import pyplot

    from .pyplot_figure import PyplotFigure

    beside = panels(fit)
    figure = pyplot.figure(FigureClass=PyplotFigure, figsize=_size(beside), layout="constrained")
    _beside(beside, figure)
    return figure


def _size(beside: Sequence[Panel]) -> tuple[float, float]:
    return len(beside) * SIZE[0], SIZE[1]


def _beside(beside: Sequence[Panel], figure: FigureBase) -> None:
    parts = figure.subfigures(1, len(beside), squeeze=False)[0]
    for panel, part in zip(beside, parts, strict=True):
        panel.draw(part)


def curve(fit: Fit, axes: Axes) -> None:
    """Draw force against position: data, fit, and the fit without tension."""
    data = fit.likelihood
    scale, name = axis_unit(data.force, "N")
    length, _ = axis_unit(data.position, "m")
    axes.plot(
        data.position * length, data.force * scale, ".", color="0.6", markersize=3, label="data"
    )
    fine = data.resampled(500)
    for parameters, style, label in (
        (fit.parameters_without_tension, "C1--", "without tension"),
        (fit.parameters, "C0-", "fit"),
    ):
        position, force = fine.fitted(parameters)
        axes.plot(position * length, force * scale, style, label=label)
    axes.axvline(fit.contact_point.value * length, color="0.3", linewidth=0.8, linestyle=":")
    axes.set_ylabel(f"force [{name}]")
    axes.legend()


def curves(fit: PooledFit, axes: Axes) -> None:
    """Draw data and model of each curve of a pool, depth and force relative to their maxima."""
    for number, (member, parameters) in enumerate(fit.pool.curves(fit.parameters)):
        position, force = member.fitted(parameters)
        baseline = parameters[OFFSET] + parameters[SLOPE] * member.travel
        largest = float(np.max(np.abs(force - baseline)))
        data, model = (member.force - baseline) / largest, (force - baseline) / largest
        measured = _relative_depth(member, member.position, parameters)
        axes.plot(measured, data, ".", color=f"C{number}", alpha=0.3, markersize=2)
        depth = _relative_depth(member, position, parameters)
        axes.plot(
            depth,
            model,
            LINES[number % len(LINES)],
            color=f"C{number}",
            label=fit.curves[number].name,
        )
    axes.set_ylabel("force / largest force")
    if len(fit.curves) <= _LEGEND_CURVES:
        axes.legend(fontsize="small")


def residuals(fit: Fit | PooledFit, axes: Axes) -> None:
    """Draw the residuals of the force over the noise.

    Those of a single fit are drawn with and without tension against the position, those of a pool
    for each curve against the depth relative to its maximum.
    """
    if isinstance(fit, PooledFit):
        label = "depth / largest depth"
        lines = [
            (f"C{number}", _relative_depth(member, member.position, part), member, part)
            for number, (member, part) in enumerate(fit.pool.curves(fit.parameters))
        ]
    else:
        length, name = axis_unit(fit.likelihood.position, "m")
        label, position = f"position [{name}]", fit.likelihood.position * length
        lines = [
            ("C1", position, fit.likelihood, fit.parameters_without_tension),
            ("C0", position, fit.likelihood, fit.parameters),
        ]
    for colour, x, likelihood, parameters in lines:
        values = -likelihood.residuals(parameters)
        axes.plot(x, values, ".", color=colour, markersize=2, alpha=0.5)
    axes.axhline(0, color="0.3", linewidth=0.8)
    axes.set(xlabel=label, ylabel="residual / noise")


def likelihood_map(fit: Fit, axes: Axes) -> None:
    """Draw √Δχ² over reduced modulus and tension, minimised over the other parameters."""
    moduli, tensions, rises = _likelihood_grid(fit)
    rise = np.ma.masked_invalid(rises)
    scale, name = axis_unit(moduli, "Pa")
    tension_scale, tension_name = axis_unit(tensions, "N/m")
    x, y = moduli * scale, tensions * tension_scale
    filled = axes.contourf(
        x, y, np.sqrt(np.maximum(rise, 0)), np.linspace(0, 4, 17), cmap="Blues_r"
    )
    axes.contour(x, y, rise, _JOINT, colors="black", linewidths=0.8)
    axes.plot(fit.reduced_modulus.value * scale, fit.tension.value * tension_scale, "k+")
    _mark_interval(fit.reduced_modulus, scale, axes.axvline)
    _mark_interval(fit.tension, tension_scale, axes.axhline)
    axes.set(xlabel=f"reduced modulus [{name}]", ylabel=f"tension [{tension_name}]")
    axes.set_title("68 % and 95 % of the pair; dotted: 95 % of each alone", fontsize="medium")
    figure = axes.get_figure()
    if figure is not None:
        figure.colorbar(filled, ax=axes, label="√Δχ²")


def _mark_interval(estimate: Estimate, scale: float, line: Callable[..., object]) -> None:
    for end in (estimate.low, estimate.high):
        if end is not None:
            line(end * scale, color="0.2", linewidth=1.0, linestyle=":")


def _likelihood_grid(fit: Fit) -> tuple[Array, Array, Array]:
    """Return moduli, tensions and Δχ², each of shape (moduli, tensions).

    The tensions of a row surround the best tension at its modulus, so that the grid follows a
    narrow ridge.
    """
    estimate = fit.reduced_modulus
    low = estimate.value / _OPEN_FACTOR if estimate.low is None else estimate.low
    high = estimate.value * _OPEN_FACTOR if estimate.high is None else estimate.high
    moduli = np.geomspace(low**1.4 / high**0.4, high**1.4 / low**0.4, _MODULI)
    fixed = replace(fit.likelihood, free=tuple(k for k in fit.likelihood.free if k != MODULUS))
    tensions = np.empty((_MODULI, _TENSIONS))
    rise = np.empty_like(tensions)
    for row, modulus in enumerate(moduli):
        start = fit.parameters | {MODULUS: MODULUS.coordinate(modulus)}
        ridge = start
        with suppress(ConvergenceError):
            ridge = fixed.minimise(start).parameters
        deviation = fixed.deviations(ridge)[TENSION]
        half = _MAP_HALF_WIDTH * (deviation if np.isfinite(deviation) else ridge[TENSION])
        lowest = max(ridge[TENSION] - half, 0.0)
        tensions[row] = np.linspace(lowest, ridge[TENSION] + half, _TENSIONS)
        for column, tension in enumerate(tensions[row]):
            rise[row, column] = _rise(fixed, ridge | {TENSION: tension}, TENSION, fit.chi_squared)
    return np.repeat(moduli[:, None], _TENSIONS, axis=1), tensions, rise


def _rise(likelihood: ChiSquared, start: Coordinates, fixed: Parameter, least: float) -> float:
    """Return Δχ² with a parameter fixed; NaN, which leaves a gap, if the search fails."""
    try:
        return likelihood.minimise(start, (fixed,)).chi_squared - least
    except ConvergenceError:
        return np.nan


def profile(fit: PooledFit, parameter: Parameter, axes: Axes) -> None:
    """Draw the profile likelihood of a pool: Δχ² against fixed values of modulus or tension."""
    estimate = fit.estimates()[parameter.name]
    half = _OPEN_DEVIATIONS * (estimate.bound if np.isfinite(estimate.bound) else estimate.value)
    low = max(estimate.value - half, 0.0) if estimate.low is None else estimate.low
    high = estimate.value + half if estimate.high is None else estimate.high
    margin = _PROFILE_MARGIN * (high - low)
    values = np.linspace(max(low - margin, 1e-3 * estimate.value), high + margin, 15)
    rises = np.empty_like(values)
    for index, value in enumerate(values):
        start = fit.parameters | {parameter: parameter.coordinate(value)}
        rises[index] = _rise(fit.pool, start, parameter, fit.chi_squared)
    scale, unit = axis_unit(values, estimate.unit)
    axes.plot(values * scale, rises, "C0-")
    axes.axhline(fit.rise, color="0.3", linewidth=0.8, linestyle="--")
    _mark_interval(estimate, scale, axes.axvline)
    label = f"{parameter.name.replace('_', ' ')} [{unit}]"
    axes.set(xlabel=label, ylabel="Δχ²", ylim=(0, 3 * fit.rise))


def estimates(rows: Sequence[Row], name: str, axes: Axes) -> None:
    """Draw a parameter of each fitted curve with its interval.

    A bar with an open end reaches down to 0, or up to a triangle at the top.
    """
    fitted = [(number, row[name]) for number, row in enumerate(rows, 1) if name in row]
    numbers = np.array([number for number, _ in fitted])
    values = np.array([estimate["value"] for _, estimate in fitted])
    scale, unit = axis_unit(values, fitted[0][1]["unit"])
    low = np.array([estimate["low"] or 0.0 for _, estimate in fitted])
    # An open end is None, which becomes NaN.
    high = np.array([estimate["high"] for _, estimate in fitted], dtype=float)
    opened = np.isnan(high)
    high[opened] = _OPEN_TOP * max(values.max(), high[~opened].max(initial=0.0))
    ends = np.array([values - low, high - values]) * scale
    axes.errorbar(numbers, values * scale, ends, fmt="o", color="C0", markersize=4, capsize=2)
    axes.plot(numbers[opened], high[opened] * scale, "^", color="C0", markersize=6)
    axes.set_ylabel(f"{name.replace('_', ' ')} [{unit}]")
    axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)


def _with_residuals(fit: Fit | PooledFit, figure: FigureBase) -> None:
    if isinstance(fit, PooledFit):
        cells = figure.add_gridspec(4, 1)
        upper = figure.add_subplot(cells[:3])
        curves(fit, upper)
    else:
        cells = figure.add_gridspec(2, 1, height_ratios=(3, 1))
        upper = figure.add_subplot(cells[0])
        curve(fit, upper)
    residuals(fit, figure.add_subplot(cells[-1], sharex=upper))


def _profiles(fit: PooledFit, figure: FigureBase) -> None:
    free = [parameter for parameter in fit.pool.free if parameter.shared]
    for number, shared in enumerate(free, 1):
        profile(fit, shared, figure.add_subplot(len(free), 1, number))


def _estimates(rows: Sequence[Row], figure: FigureBase) -> None:
    upper, lower = figure.subplots(2, 1, sharex=True)
    estimates(rows, "reduced_modulus", upper)
    estimates(rows, "tension", lower)
    if len(rows) <= _TICK_CURVES:
        names = [Path(row["curve"]).name for row in rows]
        lower.set_xticks(range(1, len(rows) + 1), names, rotation=45, ha="right", fontsize="small")
    else:
        lower.set_xlabel("curve")


def _relative_depth(member: Likelihood, position: Array, parameters: Coordinates) -> Array:
    deepest = member.deepest(parameters)
    depth: Array = (position - parameters[CONTACT_POINT]) / deepest
    return depth
