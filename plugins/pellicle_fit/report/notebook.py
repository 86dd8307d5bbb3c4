"""HTML and pictures of a fit and of a population of fits, for a notebook."""

from __future__ import annotations

from io import BytesIO

from pellicle.components import Table
from pellicle.show import FigureStyle, summary
from pellicle.units import decimal
from pellicle_fit.many import ManyFits
from pellicle_fit.result import FitResult
from pellicle_fit.wording import group_scales, interval, scale, words

from .figures import SIZE, Panel, panels
from .sentences import sentence_of_fit, sentences_of_population

_DOTS_PER_INCH = 60


def html_of_fit(fit: FitResult) -> str:
    """Return a sentence, the estimates with their intervals, and the curve with its fit."""
    rows = []
    for name, estimate in fit.estimates().items():
        factor, unit = scale(estimate)
        rows.append([words(name), decimal(estimate.value * factor, 4), interval(estimate), unit])
    count = len(fit.curve_rows())
    title = f"Fit of {count} curves" if count else "Fit of a curve"
    sentence = f"{sentence_of_fit(fit)} {_state(fit)}"
    heads = "parameter", "value", "95 % interval", "unit"
    return summary(title, sentence, Table.of_rows(heads, rows), picture=_picture(panels(fit)))


def _state(fit: FitResult) -> str:
    """Return whether a tension is needed, and the number of warnings."""
    state = f"{fit.comparison[:1].upper()}{fit.comparison[1:]}."
    count = len(fit.warnings)
    return f"{state} {count} warning{'s' * (count > 1)}: see warnings." if count else state


def html_of_population(fits: ManyFits) -> str:
    """Return how many curves were fitted, the quartiles of each group, and their distributions."""
    parts = fits.summary()
    scales = group_scales(parts)
    rows = [
        [
            f"{words(part.parameter)} [{scales[part.parameter].unit}]",
            part.group,
            f"{part.n} of {part.curves}",
            str(part.open),
            *map(
                scales[part.parameter].number,
                (part.median, part.lower_quartile, part.upper_quartile),
            ),
        ]
        for part in parts
    ]
    heads = "parameter", "group", "accepted", "open", "median", "lower quartile", "upper quartile"
    title = f"Fits of {len(fits.rows)} curves"
    picture, table = _picture(panels(fits)[-1:]), Table.of_rows(heads, rows)
    return summary(title, sentences_of_population(fits), table, picture=picture)


def _picture(shown: list[Panel]) -> bytes:
    """Return the first of some panels as a small PNG; empty if there is none."""
    from matplotlib.figure import Figure

    if not shown:
        return b""
    with FigureStyle().applied(), BytesIO() as file:
        figure = Figure(figsize=shown[0].size or SIZE, layout="constrained")
        shown[0].draw(figure)
        figure.savefig(file, format="png", dpi=_DOTS_PER_INCH)
        return file.getvalue()
