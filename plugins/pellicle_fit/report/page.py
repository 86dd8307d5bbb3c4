"""The web page of a fit, with its figures, inputs and all numbers, and its HTML in a notebook."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from pellicle import show
from pellicle.components import Column, Table
from pellicle.files import atomic_write
from pellicle.show import Block, Code, Notice, Picture, Section, Text
from pellicle_fit.config import FitConfig
from pellicle_fit.population.fits import ManyFits
from pellicle_fit.record import Record
from pellicle_fit.result import Fit
from pellicle_fit.selection.verdict import Verdict
from pellicle_fit.words.population import advice_of_population, by_text, sentences_of_population
from pellicle_fit.words.story import story

from . import tables
from .figures import charts, panels

_WIDE = 8.0
"""Width of figures from which on they have that of the page [inch]."""
_LINES = 30
"""Most lines of a notice."""
_ELSEWHERE = {
    *("curves", "per_file", "rivals", "pool"),
    *("executor", "cache", "grid_points"),
}
"""Fields of a configuration that say nothing of the solid, or stand in the tables."""
_GOOD = {Verdict.CANNOT_TELL: None, Verdict.UNDESCRIBED: False}


def html_of_fit(fit: Fit) -> str:
    """Return a sentence, the estimates with their intervals, and the curve with its fit."""
    title = "Fit of a curve" if len(fit.curves) == 1 else f"Fit of {len(fit.curves)} curves"
    text = " ".join(map(_sentence, story(fit)))
    (chart, *_), *_ = charts(fit).values()
    return show.summary(title, text, tables.estimates(fit), picture=show.png(chart))


def save_report(fit: Fit | ManyFits, path: Path, title: str) -> Path:
    """Write the page of a fit or of many fits, and return its path.

    The page is one file that loads nothing.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    figures = [
        Picture(show.svg(draw, size), caption, caption, wide=size[0] > _WIDE)
        for caption, (draw, size) in panels(fit).items()
    ]
    if isinstance(fit, Fit):
        configuration, results = fit.config.to_dict(), _one(fit)
        code = [Code(fit.to_json(), "All numbers, in SI.", f"{path.stem}.json")]
    else:
        configuration, results, code = fit.configuration, _many(fit), []
    known = {name: value for name, value in configuration.items() if name not in _ELSEWHERE}
    inputs = show.input_table(known, FitConfig, "The indenter, and what was given or chosen.")
    sections = [
        Section("Result", results),
        Section("Figures", figures),
        Section("Inputs", [inputs] if known else []),
        Section("As JSON", code),
    ]
    now = datetime.now(UTC).isoformat(" ", timespec="seconds").replace("+00:00", " UTC")
    text = show.page(title, sections, f"Fitted by pellicle {version('pellicle')}, {now}")
    with atomic_write(path) as part:
        part.write_text(text, encoding="utf-8")
    return path


def _one(fit: Record) -> list[Block]:
    """Return the story of the fit of one curve or of several, and what it rests on."""
    numbers, verdict, *step = story(fit)
    blocks: list[Block] = [
        Text(_sentence(numbers), lead=True),
        Notice(_sentence(verdict), good=_GOOD.get(fit.verdict, True)),
        *map(Text, map(_sentence, step)),
    ]
    if fit.agreement:
        agree = fit.data["widening"] == 1
        blocks.append(Notice(_sentence(fit.agreement), good=agree))
    blocks += [tables.estimates(fit), *_told(fit.warnings, fit.notes)]
    blocks += [tables.sines(fit)] if fit.sines else []
    return [*blocks, tables.explanations(fit), tables.curves(fit), tables.correlations(fit)]


def _many(fits: ManyFits) -> list[Block]:
    rows = fits.rows
    failed = [(row.status, row.name) for row in rows if not row.is_fitted]
    notes, warnings = list[tuple[str, str]](), list[tuple[str, str]]()
    for row in rows:
        fit = row.fit
        notes += [(text, row.name) for text in fit.notes]
        warnings += [(text, row.name) for text in fit.warnings]
    blocks: list[Block] = [Text(line, lead=True) for line in sentences_of_population(rows)]
    if failed:
        lost = f"{len(failed)} of {len(rows)} curves could not be fitted:"
        blocks += _listed(lost, by_text(failed), good=False)
    if fits.notes:
        blocks.append(Notice("Population:", good=None, details=fits.notes))
    blocks += [*map(Text, advice_of_population(rows)), tables.rows(rows)]
    if (groups := tables.groups(rows)).columns:
        blocks.append(groups)
    return [*blocks, *_told(by_text(warnings), by_text(notes))]


def _told(warnings: Sequence[str], notes: Sequence[str]) -> Iterator[Block]:
    if warnings:
        yield from _listed("Warnings:", warnings)
    if notes:
        yield Table([Column("note", notes)], "Notes.", folded=True)


def _listed(text: str, lines: Sequence[str], good: bool | None = None) -> Iterator[Block]:
    """Yield a notice with its lines, or in front of a folded table if they are many."""
    if len(lines) <= _LINES:
        yield Notice(text, good, details=lines)
    else:
        yield Notice(f"{text} see the table below.", good)
        yield Table([Column("curves and reason", lines)], f"{text[:-1]}.", folded=True)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
