"""Trees of curves whose links lead in circles."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

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
