"""The web page of a fit, with its figures, inputs and all numbers, and its HTML in a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from pellicle.components import Column, Table
from pellicle.files import atomic_write, json_text
from pellicle.show import (
    Block,
    Code,
    Notice,
    Picture,
    Section,
    Text,
    input_table,
    png,
    summary,
    svg,
)
from pellicle.show import page as render
from pellicle_fit.config import FitConfig
from pellicle_fit.population.fits import ManyFits
from pellicle_fit.result import Fit
from pellicle_fit.verdict import Verdict
from pellicle_fit.words.population import advice_of_population, sentences_of_population
from pellicle_fit.words.story import story

from . import tables
from .contact_sheet import PAGE, sheets
from .figures import charts, panels

_LINES = 200
"""Lines of a list of warnings or failed curves."""
_PAGES = 6
"""Pages of the contact sheet on the page, which a browser has to load at once."""
_LONGEST = 2_000_000
"""Letters of JSON that the page repeats."""
_ELSEWHERE = {
    *("curves", "per_file", "rivals", "pool", "compare"),
    *("executor", "cache", "grid_points"),
}
"""Fields of a configuration that say nothing of the solid, or stand in the tables."""
_UNDECIDED = Verdict.CANNOT_TELL, Verdict.UNDESCRIBED


def html_of_fit(fit: Fit) -> str:
    """Return a sentence, the estimates with their intervals, and the curve with its fit."""
    count = len(fit.members)
    title = f"Fit of {count} curves" if count > 1 else "Fit of a curve"
    text = " ".join(map(_sentence, story(fit)))
    (chart, *_), *_ = charts(fit).values()
    return summary(title, text, tables.estimates(fit), picture=png(chart))


def save_report(fit: Fit | ManyFits, path: Path, title: str) -> Path:
    """Write the page of a fit or of many fits, and return its path.

    The page is one file that loads nothing.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    figures: list[Block] = [
        Picture(svg(p.draw, p.size), p.caption, p.caption, wide=p.size[0] > 2 * p.size[1])
        for p in panels(fit)
    ]
    content = json_text(fit.to_dict())
    code: Block = Code(content, "All numbers, in SI.", f"{path.stem}.json")
    if len(content) > _LONGEST:
        code = Text("With this number of curves the page does not repeat the tables of --output.")
    if isinstance(fit, Fit):
        configuration = fit.config.to_dict()
        results, data = _one(fit), _data(fit)
    else:
        configuration, results, data = fit.configuration, _many(fit), []
        figures += _sheets(fit)
    known = {name: value for name, value in configuration.items() if name not in _ELSEWHERE}
    inputs = input_table(known, FitConfig, "The indenter, and what was given or chosen.")
    sections = [
        Section("Result", results),
        Section("Figures", figures),
        Section("Inputs", [inputs] if known else []),
        Section("Data", data),
        Section("As JSON", [code]),
    ]
    now = datetime.now(UTC).isoformat(" ", timespec="seconds").replace("+00:00", " UTC")
    kind = "Fit" if isinstance(fit, Fit) else "Fits"
    text = render(title, sections, f"{kind} of pellicle {version('pellicle')}, {now}")
    with atomic_write(path) as part:
        part.write_text(text, encoding="utf-8")
    return path


def _one(fit: Fit) -> list[Block]:
    """Return the story of the fit of one curve or of several, and what it rests on."""
    numbers, verdict, *step = story(fit)
    blocks: list[Block] = [
        Text(_sentence(numbers), lead=True),
        Notice(_sentence(verdict), good=fit.verdict not in _UNDECIDED),
        *map(Text, map(_sentence, step)),
    ]
    if fit.agreement:
        agree = fit.answer.agreement.factor == 1
        blocks.append(Notice(_sentence(fit.agreement), good=agree))
    blocks += [*_warnings(fit.warnings), tables.estimates(fit), tables.curves(fit)]
    blocks.append(tables.explanations(fit))
    return [*blocks, *([Notice("Notes:", good=True, details=fit.notes)] if fit.notes else [])]


def _many(fits: ManyFits) -> list[Block]:
    """Return the results of many fits."""
    rows = fits.rows
    failed = [f"{row.name}: {row.status}" for row in rows if not row.is_fitted]
    blocks: list[Block] = [Text(" ".join(map(_sentence, sentences_of_population(fits))), lead=True)]
    if failed:
        lost = f"{len(failed)} of {len(rows)} curves could not be fitted:"
        blocks.append(Notice(lost, good=False, details=_first(failed)))
    elif all(row.accepted for row in rows):
        blocks.append(Notice("Every curve was fitted and accepted.", good=True))
    if fits.notes:
        blocks.append(Notice("Population:", good=False, details=_first(fits.notes)))
    if any(row.accepted for row in rows):
        blocks.append(tables.groups(rows))
    blocks += map(Text, map(_sentence, advice_of_population(rows)))
    messages = [f"{row.name}: {text}" for row in rows for text in row.fit.get("messages", ())]
    return [*blocks, tables.rows(rows), *_warnings(_first(messages))]


def _first(lines: Sequence[str]) -> list[str]:
    """Return the first lines, and how many more there are."""
    more = len(lines) - _LINES
    return [*lines[:_LINES], *([f"… and {more} more, in the table of --output"] * (more > 0))]


def _sheets(fits: ManyFits) -> list[Block]:
    """Return the first pages of the contact sheet."""
    pages = sheets(fits.rows)
    shown, caption = pages[:_PAGES], "Each curve with its fit."
    if len(pages) > len(shown):
        caption += f" The first {len(shown)} of {len(pages)} pages; all are in fits-curves.pdf."
    return [Picture(svg(draw, PAGE), caption, caption, wide=True) for draw in shown]


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."


def _warnings(messages: Sequence[str]) -> list[Block]:
    return [Notice("Warnings:", good=False, details=messages)] if messages else []


def _data(fit: Fit) -> list[Block]:
    """Return the table of the files that were fitted, and the versions."""
    data = [member.data for member in fit.members]
    roles = (entry["columns"].items() for entry in data)
    columns = [
        Column("file", [entry["file"] or "numbers given in Python" for entry in data]),
        Column("curve", [entry["curve"] or "" for entry in data]),
        Column("columns", [", ".join(f"{role} = {column}" for role, column in of) for of in roles]),
        Column("segment", [entry["segment"] for entry in data]),
        Column("baseline", [entry["baseline"] for entry in data]),
        Column("SHA-256", [entry["sha256"] or "" for entry in data]),
        Column("spring constant", [entry["spring_constant"] or "" for entry in data], "N/m"),
        Column("sensitivity", [entry["sensitivity"] or "" for entry in data], "m/V"),
    ]
    shown = [column for column in columns if any(column.values)]
    versions = ", ".join(f"{name} {number}" for name, number in fit.record.versions.items())
    return [Table(shown, "The data, and how they were read."), Text(f"Versions: {versions}.")]
