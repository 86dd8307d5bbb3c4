"""The scripts that print tables of the documentation run, on little."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = {
    "adhesion.py": (
        ["--points", "32", "--only", "full_contact"],
        1,
        {"N": "32", "": "(missed)?"},
    ),
    "fit_verdicts.py": (
        ["outcomes.jsonl", "1", "7", "drift"],
        1,
        {"needed": "0 of 1", "τ₀ held": "1 of 1"},
    ),
    "operator_counts.py": (
        ["--cases", "rough", "--points", "32"],
        20,
        {"rough, N = 32": r"[1-4]?\d"},
    ),
    "cost.py": (
        ["--cases", "rough", "punch", "--points", "32", "--tension", "0.02"],
        2,
        {"applications": r"[1-3]\d", "contact": r"0\.\d+", "seconds": r"\d+\.\d+"},
    ),
}
"""Options of a script, number of rows, and patterns that all cells of a column match."""
SLOW = {"fit_verdicts.py", "cost.py"}


@pytest.mark.parametrize(
    ("script", "size"),
    [
        pytest.param(script, size, id=script, marks=[pytest.mark.slow] * (script in SLOW))
        for script, size in SCRIPTS.items()
    ],
)
def test_table(
    script: str,
    size: tuple[list[str], int, dict[str, str]],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A heading, the line under it, and as many rows as were asked for, with sound values."""
    options, rows, patterns = size
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [script, *options])
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
