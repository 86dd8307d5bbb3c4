"""`same_as.py` tells every bit in which runs of two commits differ."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import same_as

from pellicle.arrays import Array

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("old", "new", "differs"),
    [
        (np.array([0.1, np.nan]), np.array([0.1, np.nan]), False),
        (np.array([0.1, np.nan]), np.array([np.nextafter(0.1, 1), np.nan]), True),
        (np.array([0.0]), np.array([-0.0]), True),
        (np.array([1]), np.array([1.0]), True),
        (np.array([True]), np.array([False]), True),
        (np.array([1.0]), np.array([1.0, 1.0]), True),
        (np.array(["COARSE"]), np.array(["STEEP"]), True),
        (np.array(["COARSE"], dtype="U6"), np.array(["COARSE"], dtype="U9"), False),
    ],
)
def test_differences(old: Array, new: Array, differs: bool) -> None:
    """One bit is a difference; variables of one side, and those left out, are none."""
    told = same_as.differences({"force": old, "gone": old}, {"force": new, "added": new}, ())
    assert len([*told]) == differs
    assert not [*same_as.differences({"force": old}, {"force": new}, ("force",))]


@pytest.mark.slow
def test_a_commit_is_the_same_as_itself() -> None:
    """Both are installed beside each other and solve alike, interrupted runs too."""
    git = ["git", "-C", str(ROOT), "status", "--porcelain", "framework", "plugins"]
    status = subprocess.run(git, capture_output=True, text=True, check=False)
    if status.returncode or status.stdout:
        pytest.skip("this is no checkout, or it differs from its commit")
    command = [sys.executable, same_as.__file__, "HEAD", "--only", "sticks and relaxes"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("0 of 2 runs")
