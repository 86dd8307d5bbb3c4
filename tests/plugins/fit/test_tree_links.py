"""Files of curves that are hostile: links in circles, claims of memory, what is no file."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

import pellicle as pl
from pellicle_fit.files.choice import read
from pellicle_fit.files.columns import Calibration
from pellicle_fit.files.sources import gather
from pellicle_fit.files.tree import read_tree


def test_each_folder_of_a_tree_is_entered_once(tmp_path: Path) -> None:
    """Forty folders with two ways to each, and all ways back: its curve is read, and soon."""
    path = tmp_path / "curves.h5"
    depth, force = np.linspace(0, 1e-6, 20), np.linspace(0, 1e-9, 20)
    with h5py.File(path, "w") as file:
        file["depth"], file["force"] = depth, force
        group = file
        for _ in range(40):
            below = group.create_group("a")
            group["b"] = below
            below["back"] = file["/"]
            group = below
        group["depth"], group["force"] = depth, force
    curves, heads = read_tree(path, {})[:2]
    assert len(curves) == 1
    assert len(heads) == 4


def _linked(file: h5py.File) -> None:
    file["force"] = h5py.SoftLink("/force")


def _typed(file: h5py.File) -> None:
    file["force"] = np.dtype("f8")


def _claiming(file: h5py.File) -> None:
    file.create_dataset("force", (10**12,), chunks=(1000,), dtype="f8")
    file.create_dataset("position", (10**12,), chunks=(1000,), dtype="f8")


@pytest.mark.parametrize("ending", ["h5", "mat"])
@pytest.mark.parametrize("fill", [_linked, _typed, _claiming])
def test_hostile_trees(tmp_path: Path, fill: Callable[[h5py.File], None], ending: str) -> None:
    """Each is refused in words, without memory for what it claims."""
    path = tmp_path / f"a.{ending}"
    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
        if "position" not in file:
            file["position"] = np.arange(9.0)
    with pytest.raises(pl.PellicleError, match=r"a\.(h5|mat)"):
        [reader() for reader in read(path).values()]


def test_a_text_needs_no_more_memory_than_there_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its cells take more than its bytes do."""
    path = tmp_path / "a.csv"
    path.write_text("position [um],force [nN]\n" + "1,2\n" * 1000)
    monkeypatch.setattr("pellicle.memory.available", lambda: 1e6)
    assert read(path)
    for limit in (1e5, 1e4):
        monkeypatch.setattr("pellicle.memory.available", lambda limit=limit: limit)
        with pytest.raises(pl.ConfigError, match=r"a\.csv as a text needs about"):
            read(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="has no pipes")
def test_pipes_devices_and_long_names(tmp_path: Path) -> None:
    """What never ends is not read."""
    os.mkfifo(tmp_path / "a.csv")
    (tmp_path / "b.csv").symlink_to("/dev/zero")
    sources = [*gather(tmp_path, Calibration(), {}), *gather("x" * 300 + ".csv", Calibration(), {})]
    texts = [str(source.curve) for source in sources]
    assert ["is a pipe or a device; give a file" in text for text in texts] == [True, True, False]
    assert "cannot be read" in texts[2]


def test_an_archive_without_curves(tmp_path: Path) -> None:
    """It has folders only."""
    path = tmp_path / "a.jpk-force"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("segments/", b"")
        archive.writestr("header.properties", b"")
    with pytest.raises(pl.StorageError, match="afmformats cannot read it"):
        read(path, Calibration(spring_constant=1.0, sensitivity=1e-7))
