"""Figures of fits as panels beside each other: of one curve, of several, of a population."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.show import LINES
from pellicle.show import save_figure as save_drawing
from pellicle.units import axis_unit
from pellicle_fit.candidate import Candidate
from pellicle_fit.intervals import Estimate
from pellicle_fit.many import ManyFits
from pellicle_fit.objective import MODULUS
from pellicle_fit.population.row import Row
from pellicle_fit.recipe import TENSION
from pellicle_fit.result import Fit, parameters_of
from pellicle_fit.sentences import words as words_of
from pellicle_fit.wording import words

from . import distributions
from .likelihood_map import likelihood_map
from .map_files import figure_size, map_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, FigureBase

SIZE = (5.2, 4.6)
"""Width and height of a panel [inch]."""
_REACH = 1.8
"""Coordinates drawn to either side, over the distance of the end of the interval."""
_OPEN_DEVIATIONS = 3.0
"""Coordinates drawn towards an open end, in standard deviations."""
_PROFILE_POINTS = 15
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
    size: tuple[float, float] = SIZE
    """Width and height [inch]."""


def panels(fit: Fit | ManyFits) -> list[Panel]:
    """Return the panels of a fit or of many fits.

    The likelihood map needs a fitted modulus and tension; many fits need a fitted curve.
    """
    if isinstance(fit, ManyFits):
        return _panels_of_population(fit)
    chosen = fit.answer.chosen
    if len(fit.members) > 1:
        data = "Data and fit of each curve, relative to largest depth and force; below, residuals."
        shared = [k for k, slot in enumerate(chosen.objective.slots) if slot.curve is None]
        caption = (
            "The rise of the least χ² with a quantity fixed; dotted, the ends of its interval."
        )
        profiles = partial(_profiles, fit, shared)
        return [Panel(partial(_pool, fit), data), *([Panel(profiles, caption)] if shared else [])]
    other = _other(fit)
    caption = (
        f"Data, the fit, by {words_of(chosen)}, and {words_of(other)}; below, their residuals."
    )
    drawings = [Panel(partial(_curve, fit, other), caption)]
    tensed = fit.explained(TENSION)
    if tensed is not None and tensed.objective.index(MODULUS) is not None:
        caption = "The pairs of modulus and tension that describe the curve."
        drawings.append(Panel(partial(likelihood_map, tensed), caption))
    return drawings


def _other(fit: Fit) -> Candidate:
    """Return the best explanation without what is asked for, or with it if that one is chosen."""
    decision, chosen = fit.answer.decision, fit.answer.chosen.types
    types = decision.asked if chosen == decision.other else decision.other
    return next(one for one in fit.answer.explanations if one.types == types)


def _panels_of_population(fits: ManyFits) -> list[Panel]:
    """Return bars of the estimates, their distributions and the images of force maps."""
    drawings = []
    names = [name for name in (MODULUS, TENSION) if _fitted(fits.rows, name)]
    if names and len(fits.rows) <= _BARS:
        caption = "A bar is the interval: down to 0, or up to a triangle, where an end is open."
        drawings.append(Panel(partial(_bars, fits.rows, names), caption))
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


def save_figure(fit: Fit, path: Path) -> Path:
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


def plot(fit: Fit) -> Figure:
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


def _upper_and_lower(figure: FigureBase) -> tuple[Axes, Axes]:
    """Return axes of data and, a quarter as high, of residuals."""
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    lower.axhline(0, color="0.3", linewidth=0.8)
    lower.set_ylabel("residual / noise")
    return upper, lower


def _curve(fit: Fit, other: Candidate, figure: FigureBase) -> None:
    """Draw force against position: data, another explanation and the fit; below, residuals."""
    upper, lower = _upper_and_lower(figure)
    (curve,), (noise,) = fit.answer.chosen.whole, fit.answer.chosen.objective.noise
    newton, force_unit = axis_unit(curve.force, "N")
    metre, unit = axis_unit(curve.position, "m")
    data = curve.position * metre, curve.force * newton
    upper.plot(*data, ".", color="0.6", markersize=3, label="data")
    lines = ((other, "C1--", words_of(other)), (fit.answer.chosen, "C0-", "fit"))
    for explained, style, label in lines:
        (force,) = explained.forces()
        # The noise of the force is in the position of the tip, too, but not in that of the base.
        position = curve.base - force / curve.stiffness if curve.stiffness else curve.position
        upper.plot(position * metre, force * newton, style, label=label)
        residuals = (curve.force - force) / noise
        lower.plot(data[0], residuals, f"{style[:2]}.", markersize=2, alpha=0.5)
    # No line of the axes, beside which a legend would go.
    touch, across = fit.contact_point.value * metre, upper.get_xaxis_transform()
    upper.vlines(touch, 0, 1, "0.3", ":", linewidth=0.8, transform=across)
    upper.set_ylabel(f"force [{force_unit}]")
    upper.legend()
    lower.set_xlabel(f"position [{unit}]")


def _pool(fit: Fit, figure: FigureBase) -> None:
    """Draw data and fit of each of several curves relative to their maxima; below, residuals."""
    upper, lower = _upper_and_lower(figure)
    chosen, forces = fit.answer.chosen, fit.forces()
    for number, (member, force) in enumerate(zip(fit.members, forces, strict=True)):
        curve, colour = member.curve, f"C{number}"
        known = chosen.objective.known(chosen.minimum.at, number)
        depth = curve.base - known.solid.contact_point
        if curve.stiffness:
            depth = depth - force / curve.stiffness
        depth, largest = depth / depth.max(), float(np.max(np.abs(force)))
        upper.plot(depth, curve.force / largest, ".", color=colour, alpha=0.3, markersize=2)
        line = LINES[number % len(LINES)]
        upper.plot(depth, force / largest, line, color=colour, label=member.name)
        residuals = (curve.force - force) / chosen.objective.noise[number]
        lower.plot(depth, residuals, ".", color=colour, markersize=2, alpha=0.5)
    upper.set_ylabel("force / largest force")
    if len(fit.members) <= _LEGEND_CURVES:
        upper.legend(fontsize="small")
    lower.set_xlabel("depth / largest depth")


def _profiles(fit: Fit, shared: Sequence[int], figure: FigureBase) -> None:
    """Draw Δχ² against fixed values of each quantity that curves share."""
    chosen = fit.answer.chosen
    objective, minimum, own = chosen.objective, chosen.minimum, parameters_of(chosen)
    deviations = objective.deviations(minimum.at)
    for k, axes in zip(shared, figure.subplots(len(shared), 1, squeeze=False)[:, 0], strict=True):
        slot, best = objective.slots[k], minimum.at[k]
        far = _OPEN_DEVIATIONS * min(deviations[k], max(abs(best), 1.0))
        estimate = own[slot.name]
        low, high = (
            far if end is None else _REACH * abs(slot.coordinate(end) - best)
            for end in (estimate.low, estimate.high)
        )
        low, high = np.clip((best - low, best + high), *(ends[k] for ends in objective.limits))
        coordinates, rises = np.linspace(low, high, _PROFILE_POINTS), []
        for coordinate in coordinates:
            start = np.array(minimum.at)
            start[k] = coordinate
            rises.append(objective.minimise(start, (k,)).chi_squared - minimum.chi_squared)
        values = np.array([slot.value(coordinate) for coordinate in coordinates])
        factor, unit = axis_unit(values, slot.quantity.unit)
        axes.plot(values * factor, rises, "C0-")
        axes.axhline(fit.answer.threshold, color="0.3", linewidth=0.8, linestyle="--")
        for end in (estimate.low, estimate.high):
            if end is not None:
                axes.axvline(end * factor, color="0.2", linewidth=1.0, linestyle=":")
        axes.set(xlabel=f"{words(slot.name)} [{unit}]" if unit else words(slot.name), ylabel="Δχ²")
        axes.set_ylim(0, 3 * fit.answer.threshold)


def _fitted(rows: Sequence[Row], name: str) -> list[tuple[int, Estimate]]:
    """Return number and estimate of each row in which a quantity was fitted."""
    pairs = ((number, row.estimates.get(name)) for number, row in enumerate(rows, 1))
    return [(number, e) for number, e in pairs if e is not None and not e.held]


def _bars(rows: Sequence[Row], names: Sequence[str], figure: FigureBase) -> None:
    """Draw quantities of each curve with their intervals.

    A bar with an open end reaches down to 0, or up to a triangle at the top.
    """
    columns = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for name, axes in zip(names, columns, strict=True):
        numbers, estimates = zip(*_fitted(rows, name), strict=True)
        values = np.array([estimate.value for estimate in estimates])
        factor, unit = axis_unit(values, estimates[0].unit)
        low = np.array([estimate.low or 0.0 for estimate in estimates])
        # An open end is None, which becomes NaN.
        high: Array = np.array([estimate.high for estimate in estimates], dtype=float)
        opened = np.isnan(high)
        high[opened] = _OPEN_TOP * max(values.max(), high[~opened].max(initial=0.0))
        ends = np.array([values - low, high - values]) * factor
        axes.errorbar(numbers, values * factor, ends, fmt="o", markersize=4, capsize=2)
        tops = np.array(numbers)[opened], high[opened] * factor
        axes.plot(*tops, "^", color="C0", markersize=6)
        axes.set_ylabel(f"{words(name)} [{unit}]")
        axes.set_ylim(bottom=0.0)
        axes.grid(alpha=0.3)
    if len(rows) <= _TICK_CURVES:
        labels = [Path(row.name).name for row in rows]
        ticks = range(1, len(rows) + 1)
        columns[-1].set_xticks(ticks, labels, rotation=45, ha="right", fontsize="small")
    else:
        columns[-1].set_xlabel("curve")
