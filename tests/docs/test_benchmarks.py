"""The scripts that print tables of the documentation run, on little."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = {
    "adhesion.py": (["--points", "32", "--only", "jump_in", "wave"], 2 + 3),
    "adhesion_random.py": (["2"], 1),
    "fit_checks.py": (["1"], 11),
    "fit_rivals.py": (["1", "7", "no tension", "drift"], 2),
    "cost.py": (["--cases", "rough", "punch", "--points", "32"], 2 * 3),
    "kernels.py": (["--cases", "rough", "--points", "32"], 20),
    "threads.py": (["--points", "32", "--repeats", "1"], 2 * 2),
    "next_step.py": (["--cases", "rough", "--points", "32", "--number", "4"], 3),
}


@pytest.mark.parametrize(("script", "size"), SCRIPTS.items(), ids=SCRIPTS)
def test_table(script: str, size: tuple[list[str], int]) -> None:
    """A heading, the line under it, and as many rows as were asked for, of as many columns."""
    options, rows = size
    command = [sys.executable, str(BENCHMARKS / script), *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == 2 + rows
    assert len({line.count(" | ") for line in lines}) == 1
