"""The notebook of the documentation is its page, and runs."""

from __future__ import annotations

import importlib.util
import json
from types import ModuleType
from typing import Any

import pytest

from tests.docs.blocks import DOCS, blocks


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    """Return the module that makes the notebook."""
    spec = importlib.util.spec_from_file_location("notebooks", DOCS / "notebooks.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def sources(notebook: dict[str, Any]) -> list[tuple[str, str]]:
    """Return kind and source of each cell."""
    return [(cell["cell_type"], "".join(cell["source"])) for cell in notebook["cells"]]


def test_the_notebook_is_its_page(maker: ModuleType) -> None:
    """Its cells are the tested blocks of the page, in order, each with an output but no error."""
    page = maker.PAGE.read_text(encoding="utf-8")
    stored = json.loads(maker.NOTEBOOK.read_text(encoding="utf-8"))
    assert sources(stored) == sources(maker.notebook(page)), "run python docs/notebooks.py"
    code = [text for kind, text in sources(stored) if kind == "code"]
    assert code == [b.text.strip() for b in blocks(maker.PAGE) if b.language == "python"]
    outputs = [cell["outputs"] for cell in stored["cells"] if cell["cell_type"] == "code"]
    assert all(outputs)
    assert "error" not in {output["output_type"] for cell in outputs for output in cell}


@pytest.mark.slow
def test_the_notebook_runs(maker: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel of Jupyter carries it out; runs, results, studies and fits show HTML."""
    pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    # Set, it would keep plots out of the notebook.
    monkeypatch.delenv("MPLBACKEND", raising=False)
    page = maker.PAGE.read_text(encoding="utf-8")
    cells = [cell for cell in maker.executed(page)["cells"] if cell["cell_type"] == "code"]
    shown = [
        "".join(str(output.get("data", {}).get("text/html", "")) for output in cell["outputs"])
        for cell in cells
    ]
    for words in ("surface tension", "2 steps, all converged", "3 runs", "Fit of a curve"):
        assert any(words in html for html in shown), words
    plots = [out for cell in cells for out in cell["outputs"] if "image/png" in out.get("data", ())]
    assert len(plots) == 3, "each figure is shown once"
