"""Frozen models, and the files that they name."""

from __future__ import annotations

from pathlib import Path

import pytest

from pellicle.schema import InputPath, Model, paths_relative_to


class Reader(Model):
    """A model with a file."""

    path: InputPath


def test_frozen() -> None:
    """A model cannot be changed."""
    reader = Reader(path="a.npy")
    with pytest.raises(ValueError, match="frozen"):
        reader.path = Path("b.npy")  # type: ignore[misc]


def test_paths_are_relative_to_the_file(tmp_path: Path) -> None:
    """Within a TOML file a relative path is seen from its folder, and elsewhere left alone."""
    with paths_relative_to(tmp_path):
        assert Reader(path="a/b.npy").path == tmp_path / "a/b.npy"
        assert Reader(path=Path.home() / "c.npy").path == Path.home() / "c.npy"
    assert Reader(path="a/b.npy").path == Path("a/b.npy")
