"""The freeze lets rounding pass and nothing more, and `same_as.py` tells every bit."""

import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import same_as

from pellicle.arrays import Array
from tests.physics.frozen import benchmarks, record, store
from tests.physics.frozen.comparison import changes, compact

STORED = {
    "force": [0.0, -2.0],
    "energy": [5.0, float("nan")],
    "jump_energy": [0.0, 1e-4],
    "contact_area": [1e-8, 2e-8],
    "patches": [1, 3],
    "iterations": [4, 40],
    "status_code": ["CONVERGED", "COARSE"],
}


@pytest.mark.parametrize(
    ("name", "values", "differs"),
    [
        ("force", [1e-6, -2.0], False),
        ("force", [0.0, -2.00001], True),
        ("force", [0.0, -2.0, -2.0], True),
        ("energy", [5.0, 1.0], True),
        ("energy", [float("nan"), float("nan")], True),
        ("jump_energy", [0.0, 1.02e-4], False),
        ("jump_energy", [0.0, 1.2e-4], True),
        ("contact_area", [1e-8, 2.000001e-8], True),
        ("patches", [1, 4], True),
        ("iterations", [4, 48], False),
        ("iterations", [5, 40], True),
        ("iterations", [4, 30], True),
        ("status_code", ["CONVERGED", "STEEP"], True),
        ("depth", [1.0, 2.0], True),
    ],
)
def test_changes(name: str, values: list[object], differs: bool) -> None:
    """A fifth digit, a quarter of a count, a code and a variable that is not stored are told."""
    assert bool(changes(STORED, STORED | {name: values}, 1e-6)) is differs


def test_what_is_gone_is_told() -> None:
    """A variable that a run no longer has is a change."""
    assert [*changes(STORED, {"force": [0.0, -2.0]}, 1e-6)] == [n for n in STORED if n != "force"]


def test_a_field_is_seen_everywhere() -> None:
    """A cell that changes by a per mille changes the mean of its block; a round axis is free."""
    field = np.random.default_rng(0).random((1, 13, 11))
    shape = {"semi_major_axis": np.array([2.0]), "semi_minor_axis": np.array([2.0])}
    run = shape | {"pressure": field, "major_axis_angle": np.array([0.3])}
    stored = compact(run)
    assert not changes(stored, compact(run | {"major_axis_angle": np.array([-0.7])}), 1e-6)
    for cell in np.ndindex(13, 11):
        other = field.copy()
        other[0][cell] += 1e-3
        assert [*changes(stored, compact(run | {"pressure": other}), 1e-6)] == ["pressure"]


def test_record_tells_what_it_changes(
    tmp_path: object, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Counts that have changed are printed and stored; what rounding may do is left as it was."""
    monkeypatch.setattr(store, "FOLDER", tmp_path)
    counts = {"rounded": 11, "slower": 25, "added": 7}
    cases = [benchmarks.Case(name, partial(counts.__getitem__, name), False) for name in counts]
    monkeypatch.setattr(record, "CASES", cases)
    store.store("applications", {"rounded": 10, "slower": 20, "removed": 3})
    record.applications()
    assert store.stored("applications") == {"rounded": 10, "slower": 25, "added": 7}
    told = capsys.readouterr().out.splitlines()
    assert [line.partition(": ")[0] for line in told if "slower" in line] == ["slower"]
    assert len(told) == 3


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
