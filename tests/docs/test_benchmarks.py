"""The scripts that print tables of the documentation run, on little."""

from __future__ import annotations

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from tests.framework.fitting.conftest import skip_rivals

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = {
    "adhesion.py": (["--points", "32", "--only", "jump_in", "wave"], 2 + 3),
    "adhesion_random.py": (["1"], 1),
    "fit_checks.py": (["1"], 11),
    "fit_rivals.py": (["1", "7", "no tension"], 1),
    "kernels.py": (["--cases", "rough", "--points", "32"], 20),
    "next_step.py": (["--cases", "rough", "--points", "32", "--number", "4"], 3),
}
MEASURING = {
    "cost.py": (["--cases", "rough", "punch", "--points", "32", "--tension", "0.02"], 2),
    "threads.py": (["--points", "32", "--repeats", "1"], 2 * 2),
}
"""Scripts that measure a process."""


@pytest.mark.parametrize(("script", "size"), SCRIPTS.items(), ids=SCRIPTS)
def test_table(
    script: str,
    size: tuple[list[str], int],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A heading, the line under it, and as many rows as were asked for, of as many columns."""
    options, rows = size
    if script == "fit_checks.py":
        # Its table is that of the checks.
        skip_rivals(monkeypatch)
    monkeypatch.setattr(sys, "argv", [script, *options])
    runpy.run_path(str(BENCHMARKS / script), run_name="__main__")
    assert_is_table(capsys.readouterr().out, rows)


@pytest.mark.parametrize(("script", "size"), MEASURING.items(), ids=MEASURING)
def test_table_of_a_process(script: str, size: tuple[list[str], int]) -> None:
    """The same of scripts that need a process of their own."""
    options, rows = size
    command = [sys.executable, str(BENCHMARKS / script), *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert_is_table(done.stdout, rows)


def assert_is_table(text: str, rows: int) -> None:
    """Assert that a text is a table of so many rows."""
    lines = text.splitlines()
    assert len(lines) == 2 + rows
    assert len({line.count(" | ") for line in lines}) == 1
