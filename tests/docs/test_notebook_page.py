"""The notebook of the documentation is its page, and runs."""

from __future__ import annotations

import json
from typing import Any

import notebooks
import pytest

from tests.docs.blocks import blocks


def sources(notebook: dict[str, Any]) -> list[tuple[str, str]]:
    """Return kind and source of each cell."""
    return [(cell["cell_type"], "".join(cell["source"])) for cell in notebook["cells"]]


def test_the_notebook_is_its_page() -> None:
    """Its cells are the tested blocks of the page, in order, each with an output but no error."""
    page = notebooks.PAGE.read_text(encoding="utf-8")
    stored = json.loads(notebooks.NOTEBOOK.read_text(encoding="utf-8"))
    assert sources(stored) == sources(notebooks.notebook(page)), "run python docs/notebooks.py"
    code = [text for kind, text in sources(stored) if kind == "code"]
    assert code == [b.text.strip() for b in blocks(notebooks.PAGE) if b.language == "python"]
    outputs = [cell["outputs"] for cell in stored["cells"] if cell["cell_type"] == "code"]
    assert all(outputs)
    assert "error" not in {output["output_type"] for cell in outputs for output in cell}


@pytest.mark.slow
def test_the_notebook_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel of Jupyter carries it out; results and fits show HTML."""
    pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    # Set, it would keep plots out of the notebook.
    monkeypatch.delenv("MPLBACKEND", raising=False)
    page = notebooks.PAGE.read_text(encoding="utf-8")
    cells = [cell for cell in notebooks.executed(page)["cells"] if cell["cell_type"] == "code"]
    shown = [
        "".join(str(output.get("data", {}).get("text/html", "")) for output in cell["outputs"])
        for cell in cells
    ]
    for words in ("All 2 load steps converged", "Fit of a curve"):
        assert any(words in html for html in shown), words
    plots = [out for cell in cells for out in cell["outputs"] if "image/png" in out.get("data", ())]
    assert len(plots) == 3, "each figure is shown once"
