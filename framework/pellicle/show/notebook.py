"""What a notebook shows: a table with a sentence as short HTML, and drawings."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from html import escape

from pellicle.components.charts import Table

from .saving import png as png


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
