"""The web page of a fit: estimates, warnings, figures, inputs, and everything as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from pellicle.components import Column, Table
from pellicle.files import atomic_write, json_text
from pellicle.show import Block, Code, Notice, Picture, Section, Text, input_table, svg
from pellicle.show import page as render
from pellicle.units import readable
from pellicle_fit.config import FitConfig
from pellicle_fit.many import ManyFits
from pellicle_fit.result import Fit
from pellicle_fit.verdict import Verdict
from pellicle_fit.wording import words

from . import tables
from .contact_sheet import PAGE, sheets
from .figures import panels
from .sentences import sentence_of_fit, sentences_of_population

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


def save_report(fit: Fit | ManyFits, path: Path, title: str) -> Path:
    """Write the page of a fit or of many fits, and return its path.

    The page is one file that loads nothing.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    many = isinstance(fit, ManyFits)
    results = _many(fit) if isinstance(fit, ManyFits) else _one(fit)
    advice = "" if isinstance(fit, ManyFits) else fit.advice
    figures: list[Block] = [
        Picture(svg(p.draw, p.size), p.caption, p.caption, wide=p.size[0] > 2 * p.size[1])
        for p in panels(fit)
    ]
    if isinstance(fit, ManyFits):
        figures += _sheets(fit)
    content = json_text(fit.to_dict())
    code: Block = Code(content, "All numbers, in SI.", f"{path.stem}.json")
    if len(content) > _LONGEST:
        code = Text("With this number of curves the page does not repeat the tables of --output.")
    given = fit.config.to_dict() if fit.config else {}
    known = {name: value for name, value in given.items() if name not in _ELSEWHERE}
    inputs = input_table(known, FitConfig, "The indenter, and what was given or chosen.")
    sections = [
        Section("Result", results),
        Section("Figures", figures),
        Section("More informative experiments", [Text(_sentence(advice))] if advice else []),
        Section("Inputs", [inputs] if known else []),
        Section("Data", [] if isinstance(fit, ManyFits) else _record(fit)),
        Section("As JSON", [code]),
    ]
    now = datetime.now(UTC).isoformat(" ", timespec="seconds").replace("+00:00", " UTC")
    kind = "Fits" if many else "Fit"
    text = render(title, sections, f"{kind} of pellicle {version('pellicle')}, {now}")
    with atomic_write(path) as part:
        part.write_text(text, encoding="utf-8")
    return path


def _one(fit: Fit) -> list[Block]:
    """Return the results of the fit of one curve or of several."""
    agree = fit.answer.agreement.factor == 1
    return [
        Text(sentence_of_fit(fit), lead=True),
        Notice(_sentence(fit.comparison), good=fit.verdict not in _UNDECIDED),
        *([Notice(_sentence(fit.agreement), good=agree)] if fit.agreement else []),
        Text(_sentence(fit.sentences[0])),
        *_warnings(fit.warnings),
        tables.estimates(fit),
        tables.explanations(fit),
        tables.curves(fit),
        *([Notice("Notes:", good=True, details=fit.notes)] if fit.notes else []),
    ]


def _many(fits: ManyFits) -> list[Block]:
    """Return the results of many fits."""
    rows = fits.rows
    failed = [f"{row.name}: {row.status}" for row in rows if not row.is_fitted]
    blocks: list[Block] = [Text(sentences_of_population(fits), lead=True)]
    if failed:
        lost = f"{len(failed)} of {len(rows)} curves could not be fitted:"
        blocks.append(Notice(lost, good=False, details=_first(failed)))
    elif all(row.accepted for row in rows):
        blocks.append(Notice("Every curve was fitted and accepted.", good=True))
    if fits.notes:
        blocks.append(Notice("Population:", good=False, details=_first(fits.notes)))
    if any(row.accepted for row in rows):
        blocks.append(tables.groups(rows))
    messages = [f"{row.name}: {text}" for row in rows for text in row.messages]
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


def _record(fit: Fit) -> list[Block]:
    """Return the table of the files that were fitted, and the versions."""
    data = [member.data for member in fit.members]
    roles = (entry["columns"].items() for entry in data)
    heads = {
        "file": [entry["file"] or "numbers given in Python" for entry in data],
        "curve": [entry["curve"] or "" for entry in data],
        "columns": [", ".join(f"{role} = {column}" for role, column in items) for items in roles],
        "segment": [entry["segment"] for entry in data],
        "baseline": [entry["baseline"] for entry in data],
        "SHA-256": [entry["sha256"] or "" for entry in data],
    }
    for name, unit in (("spring_constant", "N/m"), ("sensitivity", "m/V")):
        values = (entry[name] for entry in data)
        heads[words(name)] = ["" if value is None else readable(value, unit) for value in values]
    columns = [Column(head, texts) for head, texts in heads.items() if any(texts)]
    blocks: list[Block] = [Table(columns, "The data, and how they were read.")]
    if fit.record is not None:
        versions = fit.record.versions.items()
        blocks.append(Text(f"Versions: {', '.join(f'{n} {number}' for n, number in versions)}."))
    return blocks
