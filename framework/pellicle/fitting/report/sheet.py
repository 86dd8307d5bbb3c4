"""What the pages of fits share: how they are written, their pictures, numbers and inputs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pellicle.config.describe import inputs
from pellicle.files import atomic_write, storage_errors
from pellicle.fitting.result import as_json
from pellicle.report.page import Cell, Code, Column, Notice, Picture, Section, Table, page
from pellicle.report.plotting import axis_unit, svg

from .pictures import SIZE, Drawn

_MOST = 8
"""Values of an input that have room side by side."""


class Filled(NamedTuple):
    """A column of a table: its head, and a text in each row."""

    head: Column
    texts: Sequence[str | Cell]


def save(path: Path, title: str, what: str, sections: list[Section], said: object) -> Path:
    """Write a page, one file that loads nothing, with all that was ``said`` as JSON at its end.

    Raises
    ------
    StorageError
        The file cannot be written.
    """
    last = Section("As JSON", [Code(as_json(said), "All numbers, SI.", f"{path.stem}.json")])
    now = datetime.now(UTC).isoformat(" ", timespec="seconds").replace("+00:00", " UTC")
    made = page(title, [*sections, last], f"{what} of pellicle {version('pellicle')}, {now}")
    with storage_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as part:
            part.write_text(made, encoding="utf-8")
    return path


def sentence(words: str) -> str:
    """Return words as a sentence."""
    return f"{words[:1].upper()}{words[1:]}."


def careful(messages: Sequence[str]) -> list[Notice]:
    """Return what to be careful of, if there is anything."""
    return [Notice("To be careful of:", good=False, details=messages)] if messages else []


def pictures(drawn: Iterable[Drawn]) -> list[Picture]:
    """Return pictures as a page holds them."""
    return [Picture(svg(d.draw, SIZE), d.caption, d.caption) for d in drawn]


def table(caption: str, columns: Sequence[Filled]) -> Table:
    """Return a table of columns."""
    rows = list(zip(*(column.texts for column in columns), strict=True))
    return Table(caption, [column.head for column in columns], rows)


def words(name: str, texts: Sequence[str | Cell]) -> Filled:
    """Return a column of words."""
    return Filled(Column(name, words=True), texts)


def numbers(name: str, values: Sequence[float], unit: str) -> Filled:
    """Return a column of numbers, in a unit that brings them near 1 … 1000."""
    factor, shown = axis_unit(np.array(values), unit)
    return Filled(Column(name, shown), [f"{value * factor:.4g}" for value in values])


def estimates(name: str, said: Sequence[Mapping[str, Any] | None], unit: str) -> list[Filled]:
    """Return columns of a parameter of many curves: its value, and the ends of its interval.

    ``said`` are what `Estimate.to_dict` returns, None of a curve that was not fitted.
    """
    factor, shown = axis_unit(np.array([each["value"] for each in said if each]), unit)

    def text(each: Mapping[str, Any] | None, key: str) -> str:
        if not each:
            return ""
        if each["held"] and key != "value":
            return "held"
        return "open" if each[key] is None else f"{each[key] * factor:.4g}"

    heads = {"value": name, "low": f"{name}, low", "high": f"{name}, high"}
    return [
        Filled(Column(head, shown, _ENDS.get(key, "")), [text(each, key) for each in said])
        for key, head in heads.items()
    ]


_ENDS = {"low": "lower end of the interval", "high": "upper end of the interval"}


def model(models: Sequence[Mapping[str, Any]]) -> Table:
    """Return what was pressed into what, of one curve or of many."""
    told = [
        {
            field.name: field
            for field in inputs({name: part for name, part in each.items() if name != "accuracy"})
        }
        for each in models
    ]
    fields = {name: field for each in told for name, field in each.items()}
    rows = []
    for name, field in fields.items():
        values = [each[name].value if name in each else "none" for each in told]
        rows.append([name, _together(values), field.meaning])
    columns = [Column(head, words=True) for head in ("field", "value", "meaning")]
    return Table("What was pressed in, and what was known of the solid.", columns, rows)


def _together(values: list[str]) -> str:
    """Return the value of all curves, or those of each in their order."""
    if len(set(values)) == 1:
        return values[0]
    if len(values) <= _MOST:
        return ", ".join(values)
    return f"{values[0]} … {values[-1]} ({len(set(values))} values)"
