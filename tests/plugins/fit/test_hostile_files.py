"""Curve files that nobody should have written: they are refused in words, and at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from pellicle.errors import PellicleError
from pellicle_fit.curves.readers import read


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("position (um*9**9**9**9),force (nN)\n1,2\n", "not a unit of position"),
        ("position" + " " * 100_000 + "(,force (nN)\n1,2\n", "no column position"),
        (" " * 100_000 + "[[,force (nN)\n1,2\n", "no column position"),
        ("position (um),force (nN)\n" + "1" * 300_000 + ",2\n", "is neither text"),
    ],
)
def test_is_refused_at_once(content: str, message: str, tmp_path: Path) -> None:
    """A tower of powers, a sea of spaces and an endless number end in a message."""
    path = tmp_path / "a.csv"
    path.write_text(content, encoding="utf-8")
    error: object
    try:
        (error,) = read(path).values()
    except PellicleError as raised:
        error = raised
    assert isinstance(error, PellicleError)
    assert message in str(error)
