"""The web page of a fit: estimates, warnings, figures, inputs, and everything as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from pellicle import Run
from pellicle.components import Column, Table
from pellicle.config.describe import inputs
from pellicle.files import atomic_write, json_text
from pellicle.show import Block, Code, Notice, Picture, Section, Text, svg
from pellicle.show import page as render
from pellicle.units import axis_unit, decimal, readable
from pellicle_fit.many import FITTED, ManyFits
from pellicle_fit.one_curve import Fit
from pellicle_fit.pooled import PooledFit
from pellicle_fit.population.judgement import Row
from pellicle_fit.result import FitResult
from pellicle_fit.statistics.profile import CONFIDENCE
from pellicle_fit.wording import group_scales, interval, scale, words

from .contact_sheet import LEGEND, PAGE, sheets
from .figures import SIZE, panels
from .sentences import sentence_of_fit, sentences_of_population

_LISTED = 8
"""Values of an input that are listed side by side."""
_LINES = 200
"""Lines of a list of warnings or failed curves."""
_PAGES = 6
"""Pages of the contact sheet on the page, which a browser has to load at once."""
_LONGEST = 2_000_000
"""Letters of JSON that the page repeats."""
_COLUMNS = (
    ("reduced_modulus", "Pa"),
    ("tension", "N/m"),
    ("work_of_adhesion", "J/m**2"),
    ("thickness", "m"),
    ("contact_point", "m"),
)
_OF_TENSION = "They are those of an elastic solid under tension, which is not the model chosen."
_MEANINGS = {
    "interval": "values that describe the data nearly as well; < and >: open to the other side",
    "low": "lower end of the interval",
    "high": "upper end of the interval",
    "bound": "Cramér–Rao bound: the standard deviation that no unbiased fit could beat",
}


def save_report(fit: Fit | PooledFit | ManyFits, path: Path, title: str) -> Path:
    """Write the page of a fit, a pooled fit or many fits, and return its path.

    The page is one file that loads nothing.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    results, fields = _many(fit) if isinstance(fit, ManyFits) else _fit(fit)
    advice = "" if isinstance(fit, ManyFits) else fit.advice
    figures: list[Block] = [
        Picture(svg(p.draw, size), p.caption, p.caption, wide=size[0] > 2 * size[1])
        for p in panels(fit)
        for size in (p.size or SIZE,)
    ]
    if isinstance(fit, ManyFits):
        figures += _sheets(fit)
    content = json_text(fit.to_dict())
    code: Block = Code(content, "All numbers, in SI.", f"{path.stem}.json")
    if len(content) > _LONGEST:
        code = Text("With this number of curves the page does not repeat the tables of --output.")
    sections = [
        Section("Result", results),
        Section("Figures", figures),
        Section("More informative experiments", [Text(_sentence(advice))] if advice else []),
        Section("Inputs", fields),
        Section("As JSON", [code]),
    ]
    now = datetime.now(UTC).isoformat(" ", timespec="seconds").replace("+00:00", " UTC")
    kind = "Fits" if isinstance(fit, ManyFits) else "Fit"
    text = render(title, sections, f"{kind} of pellicle {version('pellicle')}, {now}")
    with atomic_write(path) as part:
        part.write_text(text, encoding="utf-8")
    return path


def _fit(fit: Fit | PooledFit) -> tuple[list[Block], list[Block]]:
    """Return results and inputs of a fit or a pooled fit."""
    results: list[Block] = [
        Text(sentence_of_fit(fit), lead=True),
        Notice(_sentence(fit.comparison), good=fit.rivals is None or fit.rivals.is_decided),
        *_rivals(fit),
    ]
    if isinstance(fit, Fit):
        results += [*_warnings(fit.warnings), _estimates(fit), *_notes(fit)]
        return results, [_inputs([fit.model()]), _data(fit), *_record(fit)]
    results.append(Notice(_sentence(fit.agreement), good=fit.agree))
    results += [*_warnings(fit.warnings), _estimates(fit), _curves(fit), *_notes(fit)]
    return results, [_inputs([curve.model for curve in fit.curves]), *_record(fit)]


def _many(fits: ManyFits) -> tuple[list[Block], list[Block]]:
    """Return results and inputs of a table of many fits."""
    rows = fits.rows
    failed = [f"{row['curve']}: {row['status']}" for row in rows if row["status"] != FITTED]
    good = not failed and all(row["accepted"] for row in rows)
    lost = f"{len(failed)} of {len(rows)} curves could not be fitted:"
    messages = [f"{row['curve']}: {text}" for row in rows for text in row.get("messages", ())]
    models = [row["model"] for row in rows if "model" in row]
    blocks: list[Block] = [Text(sentences_of_population(fits), lead=True)]
    if failed:
        blocks.append(Notice(lost, good=False, details=_first(failed)))
    elif good:
        blocks.append(Notice("Every curve was fitted and accepted.", good=True))
    if fits.notes:
        blocks.append(Notice("Population:", good=False, details=_first(fits.notes)))
    if any(row["accepted"] for row in rows):
        blocks.append(_groups(fits))
    blocks += [_rows_of_curves(rows), *_warnings(_first(messages))]
    return blocks, [_inputs(models)] if models else []


def _first(lines: Sequence[str]) -> list[str]:
    """Return the first lines, and how many more there are."""
    more = len(lines) - _LINES
    return [*lines[:_LINES], *([f"… and {more} more, in the table of --output"] * (more > 0))]


def _rows_of_curves(rows: Sequence[Row]) -> Table:
    """Return the table with a row for each curve."""
    columns = [Column("curve", [row["curve"] for row in rows])]
    if any(row["group"] for row in rows):
        columns.append(Column("group", [row["group"] for row in rows]))
    if any(row.get("elastic") for row in rows):
        columns.append(Column("model", [row.get("chosen", {}).get("model", "") for row in rows]))
    for name, unit in _COLUMNS:
        estimates = [row.get(name) for row in rows]
        if any(estimates):
            columns += _intervals(name.replace("_", " "), estimates, unit)
    for name, head in (("chi_squared", "χ²"), ("r_squared", "R²")):
        texts = [decimal(row[name], 5) if name in row else "" for row in rows]
        columns.append(Column(head, texts))
    verdicts = [row["status"].partition(":")[0] for row in rows]
    columns.append(Column("status", verdicts, bad=[v != FITTED for v in verdicts]))
    marked = [True] * len(rows)
    if any(row["status"] == FITTED and not row["accepted"] for row in rows):
        reasons = [row["reason"] if row["status"] == FITTED else "" for row in rows]
        columns.append(Column("rejected", reasons, bad=marked))
    if any(row["outlier"] for row in rows):
        marks = ["stands out" if row["outlier"] else "" for row in rows]
        columns.append(Column("modulus", marks, bad=marked))
    return Table(columns, "Each curve on its own, with its 95 % intervals.")


def _groups(fits: ManyFits) -> Table:
    """Return median and quartiles of each parameter in each group."""
    heads = ["parameter", "group", "accepted", "open", "stand out", "median", "lower quartile"]
    rows, parts = [], fits.summary()
    scales = group_scales(parts)
    for part in parts:
        how = scales[part.parameter]
        values = part.median, part.lower_quartile, part.upper_quartile
        counts = [f"{part.n} of {part.curves}", str(part.open), str(part.outliers)]
        name = f"{words(part.parameter)} [{how.unit}]"
        rows.append([name, part.group, *counts, *map(how.number, values)])
    return Table.of_rows([*heads, "upper quartile"], rows, "The accepted curves.")


def _sheets(fits: ManyFits) -> list[Block]:
    """Return the first pages of the contact sheet."""
    pages = sheets(fits)
    shown = pages[:_PAGES]
    caption = f"Each curve with its fit. {LEGEND}"
    if len(pages) > len(shown):
        caption += f" The first {len(shown)} of {len(pages)} pages; all are in fits-curves.pdf."
    return [Picture(svg(draw, PAGE), caption, caption, wide=True) for draw in shown]


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."


def _warnings(messages: Sequence[str]) -> list[Notice]:
    return [Notice("Warnings:", good=False, details=messages)] if messages else []


def _notes(fit: FitResult) -> list[Block]:
    """Return what was done with the data, apart from the warnings."""
    return [Notice("Notes:", good=True, details=fit.notes)] if fit.notes else []


def _record(fit: FitResult) -> list[Block]:
    """Return the table of the files that were fitted, and the versions."""
    if fit.record is None:
        return []
    heads: dict[str, list[str]] = {
        "file": [entry["file"] or "numbers given in Python" for entry in fit.record.data],
        "curve": [entry["curve"] or "" for entry in fit.record.data],
        "columns": [
            ", ".join(f"{role} = {column}" for role, column in entry["columns"].items())
            for entry in fit.record.data
        ],
        **{
            name.replace("_", " "): [
                "" if entry[name] is None else readable(entry[name], unit)
                for entry in fit.record.data
            ]
            for name, unit in (("spring_constant", "N/m"), ("sensitivity", "m/V"))
        },
        "segment": [entry["segment"] for entry in fit.record.data],
        "baseline": [entry["baseline"] for entry in fit.record.data],
        "SHA-256": [entry["sha256"] or "" for entry in fit.record.data],
    }
    columns = [Column(head, texts) for head, texts in heads.items() if any(texts)]
    versions = ", ".join(f"{name} {number}" for name, number in fit.record.versions.items())
    return [Table(columns, "The data, and how they were read."), Text(f"Versions: {versions}.")]


def _estimates(fit: Fit | PooledFit) -> Table:
    rows = []
    # A tension at its limit is left out of the bounds of the others, but not of their intervals.
    bounded = fit.tension.held or fit.tension.value > 0
    for name, estimate in fit.estimates().items():
        factor, unit = scale(estimate)
        is_known = bounded and np.isfinite(estimate.bound)
        bound = decimal(estimate.bound * factor, 2) if is_known else "none"
        bound = "" if estimate.held else bound
        value = decimal(estimate.value * factor, 4)
        rows.append([words(name), value, interval(estimate), unit, bound])
    caption = f"Estimates, with {100 * CONFIDENCE:.0f} % intervals of the profile likelihood."
    if fit.chosen is not None:
        caption += f" {_OF_TENSION}"
    table = Table.of_rows(("parameter", "value", "interval", "unit", "bound"), rows, caption)
    columns = [replace(c, meaning=_MEANINGS.get(c.words, "")) for c in table.columns]
    return replace(table, columns=columns)


def _rivals(fit: FitResult) -> list[Block]:
    """Return the pull-off force, and the table of the explanations that were compared."""
    if fit.rivals is None:
        return []
    rows = fit.rivals.rows()
    margin, pull_off = fit.rivals.margin, fit.rivals.pull_off
    caption = f"What describes the data, best first; below {decimal(margin, 3)}, ΔAIC is a tie."
    table = Table.of_rows([*rows[0]], [[*row.values()] for row in rows], caption)
    return [*([Text(_sentence(pull_off))] if pull_off else []), table]


def _data(fit: Fit) -> Table:
    factor, unit = axis_unit(np.array([fit.noise]), "N")
    rows = [
        ["points", str(fit.points)],
        ["noise of the force", f"{fit.noise * factor:.3g} {unit}, from {fit.noise_from}"],
        ["χ² of the fit", decimal(fit.chi_squared, 5)],
        ["χ² without tension", decimal(fit.chi_squared_without_tension, 5)],
    ]
    return Table.of_rows(("what", "value"), rows, "Noise and residuals of the curve.")


def _curves(fit: PooledFit) -> Table:
    curves = fit.curves
    points = [Column("contact point", [c.contact_point.value for c in curves], "m")]
    if fit.contact_points:
        points = _intervals("contact point", [c.contact_point.to_dict() for c in curves], "m")
    columns = [
        Column("curve", [c.name for c in curves]),
        *points,
        Column("noise", [c.noise for c in curves], "N"),
        Column("points", [c.points for c in curves]),
        Column("χ²", [c.chi_squared for c in curves], digits=5),
        Column("χ² alone", [c.chi_squared_alone for c in curves], digits=5),
        Column("modulus alone", [c.reduced_modulus_alone for c in curves], "Pa"),
        Column("tension alone", [c.tension_alone for c in curves], "N/m"),
    ]
    return Table(columns, "Each curve in the pool, and its own fit.")


def _inputs(models: Sequence[Mapping[str, Any]]) -> Table:
    """Return the fields of indenter and kernel, of one curve or of many."""
    configurations = [
        {
            field.name: field
            for field in inputs({k: v for k, v in model.items() if k != "accuracy"}, Run)
        }
        for model in models
    ]
    rows = []
    for name, field in {k: v for fields in configurations for k, v in fields.items()}.items():
        values = [fields[name].value if name in fields else "none" for fields in configurations]
        distinct = len(set(values))
        if distinct == 1:
            text = values[0]
        elif len(values) <= _LISTED:
            text = ", ".join(values)
        else:
            text = f"{values[0]} … {values[-1]} ({distinct} values)"
        words = "type" if field.words == field.part else field.words
        rows.append([field.part, words, text, field.meaning])
    caption = "The indenter, and the known properties of the solid."
    return Table.of_rows(("of", "input", "value", "meaning"), rows, caption)


def _intervals(name: str, estimates: Sequence[Mapping[str, Any] | None], unit: str) -> list[Column]:
    """Return the columns value, low and high of a parameter of many curves.

    An estimate is the dictionary of `Estimate.to_dict`, or None for a curve that was not fitted.
    """
    factor, prefixed = axis_unit([e["value"] for e in estimates if e], unit)
    heads = {"value": name, "low": f"{name}, low", "high": f"{name}, high"}
    return [
        Column(
            f"{head} [{prefixed}]",
            [_end(e[key], factor, e["held"] and key != "value") if e else "" for e in estimates],
            meaning=_MEANINGS.get(key, ""),
        )
        for key, head in heads.items()
    ]


def _end(value: float | None, factor: float, fixed: bool) -> str:
    if fixed:
        return "fixed"
    return "open" if value is None else decimal(value * factor, 4)
