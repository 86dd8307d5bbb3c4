"""Tables as text, for a terminal or a pipe."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Literal

from pellicle.components.charts import Table
from pellicle.files import for_document

if TYPE_CHECKING:
    from rich.console import Console


def text_of(table: Table, console: Console, *, si: bool = False) -> str:
    """Return the lines of a table; long heads and cells are folded to the width of the console."""
    from rich.table import Table as RichTable
    from rich.text import Text

    grid = RichTable(box=None, padding=(0, 2, 0, 0), pad_edge=False, header_style="")
    columns = []
    for column in table.columns:
        head, cells = column.read(si=si)
        side: Literal["right", "left"] = "right" if all(map(is_number, cells)) else "left"
        grid.add_column(Text(for_document(head)), justify=side, overflow="fold")
        columns.append(cells)
    for row in zip(*columns, strict=True):
        grid.add_row(*(Text(for_document(cell)) for cell in row))
    lines = "".join(segment.text for segment in console.render(grid)).splitlines()
    return "".join(f"{line.rstrip()}\n" for line in lines)


def is_number(text: str) -> bool:
    """Return whether a text is empty, a number, or a dash in place of one."""
    with suppress(ValueError):
        float(text.replace("∞", "inf").replace("–", "nan") or "0")
        return True
    return False
