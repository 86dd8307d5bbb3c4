"""Short HTML of runs, studies and results, for notebooks."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence
from html import escape

from pellicle.components.charts import Table
from pellicle.config.describe import inputs, words_at
from pellicle.config.run import Run
from pellicle.config.study import Study
from pellicle.results.result import Result

from . import tables
from .saving import png as png
from .sentences import status_of_run

_MOST = 12
"""Rows of the steps of a result."""


def summary(
    title: str, sentence: str, table: Table, *, picture: bytes = b"", details: str = ""
) -> str:
    """Return a title, a sentence or several lines, and a table as HTML that loads nothing.

    A ``picture``, a PNG file, stands beside the table; ``details``, HTML, are folded away.
    """
    heads, columns = zip(*(column.read() for column in table.columns), strict=True)
    body = "".join(_row("td", row) for row in zip(*columns, strict=True))
    parts = [
        f"<div><strong>{escape(title)}</strong><br>{escape(sentence).replace(chr(10), '<br>')}",
        "<div style='display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start'>",
        f"<table><thead>{_row('th', heads)}</thead><tbody>{body}</tbody></table>",
    ]
    if picture:
        source = b64encode(picture).decode("ascii")
        parts.append(f"<img alt='{escape(title)}' src='data:image/png;base64,{source}'>")
    parts.append("</div>")
    if details:
        parts.append(f"<details><summary>all variables</summary>{details}</details>")
    return f"{''.join(parts)}</div>"


def _row(tag: str, cells: Sequence[str]) -> str:
    inner = "".join(f"<{tag} style='text-align:left'>{escape(cell)}</{tag}>" for cell in cells)
    return f"<tr>{inner}</tr>"


def of_run(run: Run) -> str:
    """Return every value of a run with its unit and meaning."""
    values = list(inputs(json.loads(run.to_json()), Run))
    types = {i.name: i.value for i in values}
    sentence = f"{types.get('indenter') or types['load']} on {types['kernel']}"
    return summary(run.title or "Run", sentence, tables.inputs(values))


def of_study(study: Study) -> str:
    """Return the varied parameters of a study and the number of its runs."""
    run = study.points[0].run
    configuration = json.loads(run.to_json())
    rows = [
        (words_at(configuration, Run, name), ", ".join(map(str, values)), name)
        for axes in study.dimensions.values()
        for name, values in axes.items()
    ]
    table = Table.of_rows(("varied", "values", "field"), rows)
    return summary(run.title or "Study", f"{len(study.points)} runs", table)


def of_result(result: Result) -> str:
    """Return how a run ended, the main numbers of its steps, and all variables, folded away."""
    data, (sentence, _, details) = result.dataset, status_of_run(result)
    many = data.sizes["step"] > _MOST
    shortened = data.isel(step=[*range(_MOST - 1), -1]) if many else data
    text = "\n".join((sentence, *details))
    title = str(data.attrs["title"] or "Result")
    return summary(title, text, tables.main_steps(shortened), details=data._repr_html_())
