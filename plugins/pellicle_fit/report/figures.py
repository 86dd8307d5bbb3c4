"""Figures of fits: of one curve, of several, of a population."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from pellicle.analysis import Leg
from pellicle.arrays import Array
from pellicle.components import Axis, Chart, Look, Series
from pellicle.show import figure_of
from pellicle.show import save_figure as save_drawing
from pellicle_fit.contact.curve import Curve
from pellicle_fit.dynamic import explained_moduli
from pellicle_fit.estimation.candidate import Candidate
from pellicle_fit.estimation.coordinates import MODULUS
from pellicle_fit.population.fits import ManyFits
from pellicle_fit.result import Fit
from pellicle_fit.selection.recipe import TENSION
from pellicle_fit.words.names import words_of

from .contact_sheet import PAGE, choose_curves, sheets
from .likelihood_map import likelihood_map
from .population import bars, distributions, guide, map_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    Drawing = tuple[Callable[[Figure], object], tuple[float, float]]
    """What fills a figure, and its width and height [inch]."""

_PAGES = 6
"""Pages of the contact sheet that are shown, which a browser has to load at once."""
_LETTERS = 30
"""Letters of a line of a legend."""
_LEGEND_CURVES = 8
"""Curves whose names have room in the legend of a pool."""
_RESIDUALS = Axis("residual / noise", signed=True)
_MODULI, _BEYOND = 61, 2.0
"""Points of a line of moduli, and how far it goes beyond the frequencies of sines, as a factor."""


def panels(fit: Fit | ManyFits) -> dict[str, Drawing]:
    """Return what fills the figures of a fit or of many fits, and their sizes, by caption."""
    if isinstance(fit, Fit):
        return {caption: figure_of(beside) for caption, beside in charts(fit).items()}
    is_held = any("common_errors" in row.fit.data for row in fit.rows)
    held = " Bars hold the calibration." if is_held else ""
    of_bars = f"Filled, accepted curves; hollow, rejected; bars to 0 or a triangle are open.{held}"
    accepted = "Best values of all accepted curves, by group; dotted, the median"
    accepted += " and the 95 % that the common error of the calibration leaves it." if held else "."
    beside = {of_bars: bars(fit.rows), accepted: distributions(fit.rows)}
    found: dict[str, Drawing] = {caption: figure_of(of) for caption, of in beside.items() if of}
    for name, images in fit.maps.items():
        title = Path(name).name
        caption = f"{title}: grey where there is no accepted fit or no value, hatched where one "
        caption += "end of the interval is open."
        found[caption] = map_figure(images, title)
    rows, words = choose_curves(fit.rows, _PAGES)
    which, pages = (
        "Some curves with their fits" if words else "Each curve with its fit",
        sheets(rows),
    )
    for number, draw in enumerate(pages, 1):
        found[f"{which}, page {number} of {len(pages)}{words}."] = draw, PAGE
    return found


def charts(fit: Fit) -> dict[str, list[Chart]]:
    """Return the charts of a fit, those that belong together by their caption.

    The pairs of modulus and tension are those of the chosen explanation or of one tied with it.
    """
    answer, selected = fit.answer, fit.answer.selected
    types, rival = {answer.decision.target, answer.decision.other} - {selected.types}, None
    caption = "Data and fit of each curve, each over its maxima; below, residuals."
    if len(fit.curves) == 1:
        rival = next((one for one in answer.explanations if one.types in types), None)
        beside = f", and {words_of(rival)}" if rival else ""
        caption = f"Data, the fit, by {words_of(selected)}{beside}; below, residuals."
    found = {caption: [_curves(fit, rival)]}
    if any(map(_has_hold, selected.all_rows)):
        found |= {"Force over time, with its hold; line, the fit.": [_over_time(fit)]}
    if fit.sines:
        caption = "Storage and loss modulus of the sines, with 95 % intervals; lines, by "
        found |= {f"{caption}{words_of(selected)}.": [_moduli(fit)]}
    for one in (selected, *answer.tied):
        if {MODULUS, TENSION} <= {slot.name for slot in one.objective.slots}:
            caption = f"The pairs of modulus and tension that describe the data by {words_of(one)}."
            return found | {caption: [likelihood_map(one, answer.agreement.factor)]}
    return found


def save_figure(fit: Fit, stem: Path, formats: Sequence[str] = ("png",)) -> tuple[Path, ...]:
    """Write the charts of a fit side by side as ``stem.format``: png, svg or pdf.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    draw, size = figure_of([*chain(*charts(fit).values())])
    return save_drawing(draw, stem, formats, size)


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


def _curves(fit: Fit, rival: Candidate | None = None) -> Chart:
    """Return data and fits over the indentation, of several curves over its largest; residuals."""
    selected, forces, count, series = fit.answer.selected, fit.forces(), len(fit.curves), []
    subtracted, depths = False, selected.depths
    for number, (curve, force) in enumerate(zip(selected.all_rows, forces, strict=True)):
        known = selected.known[number]
        baseline, turn = known.free_force(curve), int(curve.moves_out.argmax())
        subtracted, data = subtracted or bool(baseline.any()), curve.force - baseline
        measured = depths[number]
        deepest, largest = (measured.max(), abs(data).max()) if count > 1 else (1.0, 1.0)
        passes = Leg(slice(0, turn), "approach"), Leg(slice(turn, force.size), "retraction")
        legs = passes if len(curve.passes) > 1 else ()
        x, legend = measured / deepest, "data" if number == 0 else ""
        dots = Look(None, None, 0, filled=False if legs else None)
        series.append(Series(x, data / largest, legend=legend, look=dots, legs=legs))
        own = (
            fit.curves[number]["name"] * (count <= _LEGEND_CURVES)
            if count > 1
            else f"fit: {words_of(selected)}"
        )
        models = [(words_of(rival), 1, rival.forces()[0])] if rival else []
        for name, hue, modelled in [*models, (own, number, force)]:
            # The noise of the force is in the position of the tip, too, not in that of the base.
            given = (curve.force - modelled) / curve.stiffness if curve.stiffness else 0.0
            depth, legend = (measured + given) / deepest, fill(name, _LETTERS)
            look = Look(hue, 0 if legs else hue)
            left = (curve.force - modelled) / fit.answer.judgements[number].deviation
            y = (modelled - baseline) / largest
            series.append(Series(depth, y, legend=legend, look=look, legs=legs))
            series.append(Series(x, left, look=dots._replace(hue=hue), legs=legs, panel=1))
    drawn = np.concatenate([one.y for one in series if one.panel == 0])
    # It ends where the legend may begin.
    series.append(guide([0.0, 0.0], [drawn.min(), drawn.max() / 3], "contact point"))
    less = " less its baseline" if subtracted else ""
    across, up = Axis("indentation", "m"), Axis(f"force{less}", "N")
    if count > 1:
        across, up = Axis("indentation / largest indentation"), Axis(f"force{less} / largest force")
    return Chart(across, [up, _RESIDUALS], series, hues=max(count, 2), heights=(3, 1))


def _has_hold(curve: Curve) -> bool:
    """Return whether the base rests after the approach, at times that are known."""
    return curve.time is not None and bool(curve.rests.any())


def _over_time(fit: Fit) -> Chart:
    """Return force and fit over the time since the first row, of each curve with a hold."""
    series = list[Series]()
    pairs = zip(fit.answer.selected.all_rows, fit.forces(), strict=True)
    for number, (curve, force) in enumerate(pairs):
        if not _has_hold(curve):
            continue
        time = curve.clock - curve.clock[0]
        legends = ("", "") if series else ("data", "fit")
        series.append(Series(time, curve.force, legend=legends[0], look=Look(None, None, 0)))
        series.append(Series(time, force, legend=legends[1], look=Look(number, number)))
    return Chart(Axis("time", "s"), [Axis("force", "N")], series, hues=max(len(fit.curves), 2))


def _moduli(fit: Fit) -> Chart:
    """Return E′ and E″ of the reduced modulus over frequency, measured and by the explanation."""
    selected, series, rows = fit.answer.selected, list[Series](), iter(fit.sines)
    for number, (known, curve) in enumerate(zip(selected.known, selected.all_rows, strict=True)):
        if not curve.sines:
            continue
        told = [next(rows) for _ in curve.sines]
        frequency = np.array([sine["frequency"].value for sine in told])
        at = np.geomspace(frequency.min() / _BEYOND, frequency.max() * _BEYOND, _MODULI)
        dense = tuple(curve.sines[0]._replace(frequency=float(f)) for f in at)
        modulus = explained_moduli(known, replace(curve, sines=dense))
        for name, line, hue in (("storage", modulus.real, 0), ("loss", modulus.imag, 1)):
            hue = 2 * number + hue
            label = f"{name} modulus" if number == 0 else ""
            series.append(Series(at, _positive(line), look=Look(hue, hue)))
            for k, sine in enumerate(told):
                of = sine[f"{name}_modulus"]
                ends = (np.array([end]) for end in (of.low, of.high))
                low, high = (_positive(end) for end in ends)
                value, x = _positive(np.array([of.value])), frequency[[k]]
                legend = label if k == 0 else ""
                look = Look(hue, None, number)
                series.append(Series(x, value, legend=legend, look=look, low=low, high=high))
    y = Axis("storage and loss modulus", "Pa", log=True)
    return Chart(Axis("frequency", "Hz", log=True), [y], series, hues=2 * len(fit.curves))


def _positive(values: Array) -> Array:
    """Return values, of which a logarithmic axis shows those > 0."""
    return np.where(values > 0, values, np.nan)
