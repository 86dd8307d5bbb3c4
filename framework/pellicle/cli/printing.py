"""Tables and JSON on the terminal."""

from __future__ import annotations

import sys
from typing import Any

import typer
from rich.console import Console
from rich.table import Table

from pellicle.files import for_document


def print_table(
    names: list[str], rows: list[dict[str, str]], heads: dict[str, str] | None = None
) -> None:
    """Print rows under the names of their columns, or the ``heads`` that replace them."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in names:
        table.add_column((heads or {}).get(name, name), overflow="fold")
    for row in rows:
        # A terminal obeys control characters.
        table.add_row(*(for_document(row[name]) for name in names))
    # Output into a pipe is neither cut nor folded.
    console = Console(markup=False, highlight=False)
    if not console.is_terminal:
        console.width = 1000
        console.soft_wrap = True
    console.print(table)


def print_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning; further arguments of `warnings.showwarning` are ignored."""
    typer.echo(f"warning: {message}", err=True)


def print_json(value: object) -> None:
    """Print JSON in ASCII, which every code page contains."""
    import json

    sys.stdout.write(json.dumps(value, indent=2) + "\n")
