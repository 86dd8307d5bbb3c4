"""Short HTML for notebooks."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape


def summary(
    title: str,
    sentence: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    picture: bytes = b"",
    details: str = "",
) -> str:
    """Return a title, a sentence and a table, all escaped, as HTML that loads nothing.

    A ``picture``, a PNG file, stands beside the table; ``details``, HTML, are folded away.
    """
    body = "".join(_row("td", row) for row in rows)
    parts = [
        f"<div><strong>{escape(title)}</strong><br>{escape(sentence)}",
        "<div style='display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start'>",
        f"<table><thead>{_row('th', columns)}</thead><tbody>{body}</tbody></table>",
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
