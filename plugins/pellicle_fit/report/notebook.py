"""HTML and pictures of a fit and of a population of fits, for a notebook."""

from __future__ import annotations

from io import BytesIO

from pellicle.show import FigureStyle, summary
from pellicle_fit.many import ManyFits
from pellicle_fit.result import Fit

from . import tables
from .figures import Panel, panels
from .sentences import sentence_of_fit, sentences_of_population

_DOTS_PER_INCH = 60


def html_of_fit(fit: Fit) -> str:
    """Return a sentence, the estimates with their intervals, and the curve with its fit."""
    count, warnings = len(fit.members), len(fit.warnings)
    title = f"Fit of {count} curves" if count > 1 else "Fit of a curve"
    text = f"{sentence_of_fit(fit)} {fit.comparison[:1].upper()}{fit.comparison[1:]}."
    if warnings:
        text += f" {warnings} warning{'s' * (warnings > 1)}: see warnings."
    return summary(title, text, tables.estimates(fit), picture=_picture(panels(fit)))


def html_of_population(fits: ManyFits) -> str:
    """Return how many curves were fitted, the quartiles of each group, and their distributions."""
    title, text = f"Fits of {len(fits.rows)} curves", sentences_of_population(fits)
    return summary(title, text, tables.groups(fits.rows), picture=_picture(panels(fits)[-1:]))


def _picture(shown: list[Panel]) -> bytes:
    """Return the first of some panels as a small PNG; empty if there is none."""
    from matplotlib.figure import Figure

    if not shown:
        return b""
    with FigureStyle().applied(), BytesIO() as file:
        figure = Figure(figsize=shown[0].size, layout="constrained")
        shown[0].draw(figure)
        figure.savefig(file, format="png", dpi=_DOTS_PER_INCH)
        return file.getvalue()
