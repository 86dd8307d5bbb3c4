"""The web page of a fit: what was found, how sure it is, the figure, and what it was told."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pellicle.fitting.fit import Fit
from pellicle.fitting.pooled import PooledFit
from pellicle.fitting.result import FitResult
from pellicle.fitting.statistics.estimate import Estimate
from pellicle.fitting.statistics.interval import CONFIDENCE
from pellicle.report.page import Column, Notice, Section, Table, Text
from pellicle.report.plotting import axis_unit

from . import drawing, pooled_drawing, sheet


def save_report(fit: Fit | PooledFit, path: Path, title: str) -> Path:
    """Write the page of a fit, one file that loads nothing, and return its name.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    if isinstance(fit, PooledFit):
        messages = [f"{curve.name}: {said}" for curve in fit.curves for said in curve.messages]
        agreement = Notice(sheet.sentence(fit.agreement), good=fit.agree)
        said = [agreement, *sheet.careful([*fit.messages, *messages])]
        found, drawn = [_estimates(fit), _curves(fit)], pooled_drawing.pictures(fit)
        told = [sheet.model([curve.model for curve in fit.curves])]
    else:
        said, found, drawn = sheet.careful(fit.messages), [_estimates(fit)], drawing.pictures(fit)
        told = [sheet.model([fit.model()]), _facts(fit)]
    comparison = Notice(sheet.sentence(fit.comparison), good=not fit.doubt)
    sections = [
        Section("Result", [comparison, *said, *found]),
        Section("Figures", sheet.pictures(drawn)),
        Section("What would tell more", [Text(sheet.sentence(fit.advice))] if fit.advice else []),
        Section("Inputs", told),
    ]
    return sheet.save(path, title, "Fit", sections, fit.to_dict())


def _estimates(fit: FitResult) -> Table:
    heads = ["value", "low", "high", "unit", "bound"]
    columns = [
        Column("parameter", words=True),
        *(Column(head, meaning=_MEANINGS.get(head, ""), words=head == "unit") for head in heads),
    ]
    rows = [[name.replace("_", " "), *_row(each)] for name, each in fit.estimates().items()]
    caption = f"What was found, with {100 * CONFIDENCE:.0f} % intervals of the profile likelihood."
    return Table(caption, columns, rows)


_MEANINGS = {
    "low": "lower end of the interval",
    "high": "upper end of the interval",
    "bound": "Cramér–Rao bound: the standard deviation that no unbiased fit could beat",
}


def _row(estimate: Estimate) -> list[str]:
    factor, unit = axis_unit(np.array([estimate.value]), estimate.unit)
    value = f"{estimate.value * factor:.4g}"
    if estimate.held:
        return [value, "held", "held", unit, ""]
    ends = ("open" if e is None else f"{e * factor:.4g}" for e in (estimate.low, estimate.high))
    bound = f"{estimate.bound * factor:.2g}" if np.isfinite(estimate.bound) else "none"
    return [value, *ends, unit, bound]


def _facts(fit: Fit) -> Table:
    factor, unit = axis_unit(np.array([fit.noise]), "N")
    rows = [
        ["points", str(fit.points)],
        ["noise of the force", f"{fit.noise * factor:.3g} {unit}, from {fit.noise_from}"],
        ["χ² of the fit", f"{fit.chi_squared:.5g}"],
        ["χ² without tension", f"{fit.chi_squared_without_tension:.5g}"],
    ]
    return Table("What the curve holds.", [Column(n, words=True) for n in ("what", "value")], rows)


def _curves(fit: PooledFit) -> Table:
    each = fit.curves
    points = [curve.contact_point.to_dict() for curve in each]
    ends = sheet.estimates("contact point", points, "m")
    columns = [
        sheet.words("curve", [curve.name for curve in each]),
        *(ends if fit.contact_points else ends[:1]),
        sheet.numbers("noise", [curve.noise for curve in each], "N"),
        sheet.Filled(Column("points"), [str(curve.points) for curve in each]),
        sheet.Filled(Column("χ²"), [f"{curve.chi_squared:.5g}" for curve in each]),
        sheet.Filled(Column("χ² alone"), [f"{curve.chi_squared_alone:.5g}" for curve in each]),
        sheet.numbers("modulus alone", [curve.reduced_modulus_alone for curve in each], "Pa"),
        sheet.numbers("tension alone", [curve.tension_alone for curve in each], "N/m"),
    ]
    return sheet.table("Each curve in the pool, and what it says alone.", columns)
