"""The scripts that print tables of the documentation run, on little, and so does its notebook."""

import json
import re
import runpy
import sys
from pathlib import Path
from typing import Any

import notebooks
import pytest

from tests.docs.blocks import blocks

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = [
    pytest.param(
        *("adhesion.py", "--points 32 --only full_contact", 1, {"N": "32", "": "(missed)?"}),
        id="adhesion.py",
    ),
    pytest.param(
        *("fit_verdicts.py", "outcomes.jsonl 1 7 drift", 1),
        {"needed": "0 of 1", "τ₀ held": "1 of 1"},
        id="fit_verdicts.py",
        marks=pytest.mark.slow,
    ),
    pytest.param(
        *("operator_counts.py", "--cases rough --points 32", 20, {"rough, N = 32": r"[1-4]?\d"}),
        id="operator_counts.py",
    ),
]
"""A script, its options, number of rows, and patterns that all cells of a column match."""


@pytest.mark.parametrize(("script", "options", "rows", "patterns"), SCRIPTS)
def test_table(
    script: str,
    options: str,
    rows: int,
    patterns: dict[str, str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A heading, the line under it, and as many rows as were asked for, with sound values."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [script, *options.split()])
    runpy.run_path(str(BENCHMARKS / script), run_name="__main__")
    assert_is_table(capsys.readouterr().out, rows, patterns)


def assert_is_table(text: str, rows: int, patterns: dict[str, str]) -> None:
    """Assert that a text is a table of so many rows, whose columns match their patterns."""
    heads, line, *body = (
        [cell.strip() for cell in line.removeprefix("|").removesuffix("|").split("|")]
        for line in text.splitlines()
    )
    assert set(line) == {"---"}
    assert len(body) == rows
    assert {len(cells) for cells in (line, *body)} == {len(heads)}
    for head, pattern in patterns.items():
        column = [cells[heads.index(head)] for cells in body]
        assert all(re.fullmatch(pattern, cell) for cell in column), (head, column)


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
