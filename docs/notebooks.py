"""Make the notebook of docs/notebook.md from the page: ``python docs/notebooks.py``.

Prose becomes Markdown cells, Python blocks become code cells, which are executed.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
PAGE, NOTEBOOK = DOCS / "notebook.md", DOCS / "notebook.ipynb"
_BLOCK = re.compile(r"^```python\n(.*?)^```\n", re.DOTALL | re.MULTILINE)


def cells(page: str) -> Iterator[dict[str, Any]]:
    """Yield the cells of a page, not executed."""
    for number, text in enumerate(_BLOCK.split(page)):
        source = text.strip()
        if not source:
            continue
        cell: dict[str, Any] = {"id": f"cell-{number}", "metadata": {}, "source": source}
        if number % 2:
            yield cell | {"cell_type": "code", "execution_count": None, "outputs": []}
        else:
            yield cell | {"cell_type": "markdown"}


def notebook(page: str) -> dict[str, Any]:
    """Return a page as a notebook, not executed."""
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return {
        "cells": list(cells(page)),
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def executed(page: str) -> dict[str, Any]:
    """Return a page as a notebook with the outputs of its cells.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        A cell raises.
    """
    import nbformat
    from nbclient import NotebookClient

    node = nbformat.from_dict(notebook(page))  # type: ignore[no-untyped-call]
    NotebookClient(node, timeout=300, kernel_name="python3").execute()
    for cell in node.cells:
        # The times of execution change each time.
        cell.metadata = {}
    return dict(node)


if __name__ == "__main__":
    content = executed(PAGE.read_text(encoding="utf-8"))
    NOTEBOOK.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
