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
    """Return a title, a sentence and a table as HTML that loads nothing.

    Parameters
    ----------
    title, sentence, columns, rows
        Texts, which are escaped.
    picture
        PNG file to show beside the table.
    details
        HTML that is folded away.
    """
    head = _row("th", columns)
    body = "".join(_row("td", row) for row in rows)
    source = b64encode(picture).decode("ascii")
    image = f"<img alt='{escape(title)}' src='data:image/png;base64,{source}'>"
    parts = [
        f"<strong>{escape(title)}</strong><br>{escape(sentence)}",
        "<div style='display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start'>",
        f"<table><thead>{head}</thead><tbody>{body}</tbody></table>",
        image if picture else "",
        "</div>",
        f"<details><summary>all variables</summary>{details}</details>" if details else "",
    ]
    return f"<div>{''.join(parts)}</div>"


def _row(tag: str, cells: Sequence[str]) -> str:
    inner = "".join(f"<{tag} style='text-align:left'>{escape(cell)}</{tag}>" for cell in cells)
    return f"<tr>{inner}</tr>"
