"""Figures of fits: of one curve, of several, of a population."""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pellicle.components import Axis, Chart, Look, Series
from pellicle.show import figure_of
from pellicle.show import save_figure as save_drawing
from pellicle_fit.objective import MODULUS
from pellicle_fit.population.fits import ManyFits
from pellicle_fit.recipe import TENSION
from pellicle_fit.result import Fit, parameters_of
from pellicle_fit.words.effects import words as words_of
from pellicle_fit.words.quantities import words

from .guides import guide
from .likelihood_map import likelihood_map
from .population import map_figure
from .population_figures import bars, distributions

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_REACH = 1.8
"""Coordinates drawn to either side, over the distance of the end of the interval."""
_OPEN_DEVIATIONS = 3.0
"""Coordinates drawn towards an open end, in standard deviations."""
_PROFILE_POINTS = 15
_LEGEND_CURVES = 8
"""Curves whose names have room in the legend of a pool."""
_RESIDUALS = Axis("residual / noise", signed=True)


class Panel(NamedTuple):
    """A figure and its caption."""

    draw: Callable[[Figure], object]
    size: tuple[float, float]
    """Width and height [inch]."""
    caption: str


def panels(fit: Fit | ManyFits) -> list[Panel]:
    """Return the figures of a fit or of many fits.

    The likelihood map needs a fitted modulus and tension; many fits need a fitted curve.
    """
    if isinstance(fit, Fit):
        return [Panel(*figure_of(beside), caption) for caption, beside in charts(fit).items()]
    of_bars = "A bar is the interval: down to 0, or up to a triangle, where an end is open."
    of_distributions = (
        "Accepted curves, by group, in histograms those with closed intervals; dotted, the median; "
        "square, a modulus that stands out."
    )
    beside = {of_bars: bars(fit.rows), of_distributions: distributions(fit.rows)}
    found = [Panel(*figure_of(of), caption) for caption, of in beside.items() if of]
    for name, images in fit.maps.items():
        title = Path(name).name
        caption = f"{title}: grey where there is no accepted fit, or an interval is open."
        found.append(Panel(*map_figure(images, title), caption))
    return found


def charts(fit: Fit) -> dict[str, list[Chart]]:
    """Return the charts of a fit, those that belong together by their caption."""
    chosen = fit.answer.chosen
    if len(fit.members) > 1:
        data = "Data and fit of each curve, relative to largest depth and force; below, residuals."
        rise = "The rise of the least χ² with a quantity fixed; dotted, the ends of its interval."
        profiles = _profiles(fit)
        return {data: [_pool(fit)]} | ({rise: profiles} if profiles else {})
    decision = fit.answer.decision
    types = decision.asked if chosen.types == decision.other else decision.other
    rival = next(one for one in fit.answer.explanations if one.types == types)
    (curve,), (noise,) = chosen.whole, chosen.objective.noise
    series = [Series(curve.position, curve.force, legend="data", look=Look(None, None, 0))]
    for hue, one, name in ((1, rival, words_of(rival)), (0, chosen, "fit")):
        (force,) = one.forces()
        # The noise of the force is in the position of the tip, too, but not in that of the base.
        position = curve.base - force / curve.stiffness if curve.stiffness else curve.position
        series.append(Series(position, force, legend=name, look=Look(hue, hue)))
        residuals, look = (curve.force - force) / noise, Look(hue, None, 0)
        series.append(Series(curve.position, residuals, look=look, panel=1))
    touch = [fit.contact_point.value] * 2
    series.append(guide(touch, [curve.force.min(), curve.force.max()]))
    axes = Axis("position", "m"), [Axis("force", "N"), _RESIDUALS]
    caption = (
        f"Data, the fit, by {words_of(chosen)}, and {words_of(rival)}; below, their residuals."
    )
    found = {caption: [Chart(*axes, series, hues=2, heights=(3, 1))]}
    tensed = fit.explained(TENSION)
    if tensed is not None and tensed.objective.index(MODULUS) is not None:
        caption = "The pairs of modulus and tension that describe the curve."
        found[caption] = [likelihood_map(tensed)]
    return found


def save_figure(fit: Fit, path: Path) -> Path:
    """Write the charts of a fit side by side as png, pdf or svg, and return the file.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    draw, size = figure_of([*chain(*charts(fit).values())])
    (file,) = save_drawing(draw, path.with_suffix(""), [path.suffix[1:]], size)
    return file


def plot(fit: Fit) -> Figure:
    """Return a figure of pyplot with the charts of a fit side by side.

    A notebook shows it where it is the last line of a cell.
    """
    import matplotlib as mpl
    from matplotlib import pyplot

    draw, size = figure_of([*chain(*charts(fit).values())])
    figure = pyplot.figure(figsize=size, layout="constrained")
    draw(figure)
    if "inline" in mpl.get_backend():
        # At the end of a cell this would show the figures of pyplot once more.
        pyplot.close(figure)
    return figure


def _pool(fit: Fit) -> Chart:
    """Return data and fit of each of several curves relative to their maxima; below, residuals."""
    series, chosen, count = [], fit.answer.chosen, len(fit.members)
    for number, (member, force) in enumerate(zip(fit.members, fit.forces(), strict=True)):
        curve = member.curve
        known = chosen.objective.known(chosen.minimum.at, number)
        depth = curve.base - known.solid.contact_point
        if curve.stiffness:
            depth = depth - force / curve.stiffness
        depth, largest = depth / depth.max(), float(np.max(np.abs(force)))
        residuals = (curve.force - force) / chosen.objective.noise[number]
        name, points = member.name if count <= _LEGEND_CURVES else "", Look(number, None, 0)
        series += [
            Series(depth, curve.force / largest, look=Look(None, None, 0)),
            Series(depth, force / largest, legend=name, look=Look(number, number)),
            Series(depth, residuals, look=points, panel=1),
        ]
    axes = [Axis("force / largest force"), _RESIDUALS]
    return Chart(Axis("depth / largest depth"), axes, series, hues=count, heights=(3, 1))


def _profiles(fit: Fit) -> list[Chart]:
    """Return Δχ² against fixed values of each quantity that curves share."""
    chosen, found = fit.answer.chosen, []
    objective, minimum, own = chosen.objective, chosen.minimum, parameters_of(chosen)
    deviations, threshold = objective.deviations(minimum.at), fit.answer.threshold
    for k, slot in enumerate(objective.slots):
        if slot.curve is not None:
            continue
        estimate, best = own[slot.name], minimum.at[k]
        far = _OPEN_DEVIATIONS * min(deviations[k], max(abs(best), 1.0))
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
        top = 3 * threshold
        ends = [[end] * 2 for end in (estimate.low, estimate.high) if end is not None]
        series = [Series(values, np.array(rises)), *(guide(end, [0, top]) for end in ends)]
        series.append(guide([values[0], values[-1]], [threshold] * 2))
        x = Axis(words(slot.name), slot.quantity.unit)
        found.append(Chart(x, [Axis("Δχ²", limits=(0, top))], series))
    return found
