"""A rough punch that sticks to springs, each of which jumps on its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from pellicle.arrays import Array
from tests.adhesive_paths import solved
from tests.physics.tables_of_runs import heights

# A rough punch has few cells in its zone of attraction.
pytestmark = pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")

POINTS = 20
PATH = [-0.06, 0.0, 0.02, 0.05, 0.1, 0.15, 0.1, 0.05, 0.02, 0.0, -0.06]


def _rough() -> Array:
    x = (np.arange(POINTS) + 0.5) / POINTS - 0.5
    rough = np.random.default_rng(0).normal(size=(POINTS, POINTS))
    heights = 0.02 * rough - x[:, None] ** 2 - 1.3 * x**2
    lowered: Array = heights - heights.max()
    return lowered


def _one_by_one(
    heights: Array, work: float, reach: float, path: Sequence[float]
) -> tuple[list[float], list[int]]:
    """Return force and closed cells on springs of stiffness 1 under a linear law, of slope > 1.

    A gap to the undeformed surface of less than ``reach`` closes; a closed one opens where the
    spring pulls by more than the strength.
    """
    strength = 2 * work / reach
    closed = np.zeros(heights.shape, dtype=bool)
    forces, cells = [], []
    for depth in path:
        stretch = -depth - heights
        closed = (stretch < reach) | (closed & (stretch < strength))
        forces.append(float(-stretch[closed].sum()) / heights.size)
        cells.append(int(closed.sum()))
    return forces, cells


@pytest.mark.parametrize(("work", "reach"), [(1e-3, 0.03), (1e-3, 0.04)])
@pytest.mark.parametrize("turn", [np.s_[:, :], np.s_[::-1, :]])
@pytest.mark.parametrize(
    "kernel",
    [
        {"type": "winkler", "foundation": 1.0},
        # p = M u/h with M = 1.225 E*, on cells five times as wide as the layer is thick.
        {
            "type": "bonded_layer", "reduced_modulus": 0.01 / 1.225, "poissons_ratio": 0.3,
            "thickness": 0.01,
        },
    ],
    ids=["springs", "layer"],
)  # fmt: skip
def test_springs_close_and_open_one_by_one(
    kernel: dict[str, Any], turn: tuple[slice, slice], work: float, reach: float
) -> None:
    """Cells jump in and off where their own spring does, there and back, in mirror images too."""
    rough = _rough()
    law = {"type": "linear", "work_of_adhesion": work, "range": reach}
    steps = solved(
        POINTS, 0.0, PATH, size=1.0, kernel=kernel, indenter=heights(rough[turn]), interaction=law
    )
    forces, cells = _one_by_one(rough, work, reach, PATH)
    if kernel["type"] == "winkler":
        assert steps["contact"].values.sum((1, 2)).tolist() == cells
        np.testing.assert_allclose(steps["force"], forces, atol=1e-7 * np.abs(forces).max())
    else:
        # Cells of the layer feel their neighbours a little.
        assert steps["contact"].values.sum((1, 2)) == pytest.approx(cells, abs=3)
