"""The web page of a fit: what was found, how sure it is, the figure, and what it was told."""

from __future__ import annotations

from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from pellicle.inputs import inputs
from pellicle.page import Code, Column, Notice, Picture, Section, Table, Text, page
from pellicle.plotting import axis_unit, svg
from pellicle.storage import aside, reported

from . import drawing
from .estimate import Estimate
from .fit import Fit
from .interval import CONFIDENCE
from .pictures import HEIGHT, Drawn


def save_report(fit: Fit, path: Path, title: str) -> Path:
    """Write the page of a fit, one file that loads nothing, and return its name.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    made = page(
        title,
        [
            Section("Result", [*_said(fit), _estimates(fit)]),
            Section("Figures", _pictures(drawing.pictures(fit))),
            Section("What would tell more", [Text(_sentence(fit.advice))] if fit.advice else []),
            Section("Inputs", [_model(fit), _facts(fit)]),
            Section("As JSON", [Code(fit.to_json(), "All numbers, SI.", f"{path.stem}.json")]),
        ],
        f"Fit of pellicle {version('pellicle')}, "
        f"{datetime.now(UTC).isoformat(' ', timespec='seconds').replace('+00:00', ' UTC')}",
    )
    with reported(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with aside(path) as part:
            part.write_text(made, encoding="utf-8")
    return path


def _said(fit: Fit) -> list[Notice]:
    said = [Notice(_sentence(fit.comparison), good=True)]
    if fit.messages:
        said.append(Notice("To be careful of:", good=False, details=fit.messages))
    return said


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."


def _estimates(fit: Fit) -> Table:
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


def _pictures(drawn: list[Drawn]) -> list[Picture]:
    return [Picture(svg(d.draw, (d.width, HEIGHT)), d.caption, d.caption) for d in drawn]


def _model(fit: Fit) -> Table:
    told = {name: part for name, part in fit.model().items() if name != "accuracy"}
    columns = [Column(head, words=True) for head in ("field", "value", "meaning")]
    caption = "What was pressed in, and what was known of the solid."
    return Table(caption, columns, [[i.name, i.value, i.meaning] for i in inputs(told)])


def _facts(fit: Fit) -> Table:
    factor, unit = axis_unit(np.array([fit.noise]), "N")
    rows = [
        ["points", str(fit.points)],
        ["noise of the force", f"{fit.noise * factor:.3g} {unit}, from {fit.noise_from}"],
        ["χ² of the fit", f"{fit.chi_squared:.5g}"],
        ["χ² without tension", f"{fit.chi_squared_without_tension:.5g}"],
    ]
    return Table("What the curve holds.", [Column(n, words=True) for n in ("what", "value")], rows)
