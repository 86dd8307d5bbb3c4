"""The radius of a contact of cells, as its stiffness measures it."""

from math import pi
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle_axisymmetric.tensed_punch import punch
from pellicle_plugins.validation.adhesive_path import excess_radius

POINTS, SIZE = 64, 4.0
SPACING = SIZE / POINTS


@pytest.mark.parametrize("tension", [0.0, pytest.param(0.5, marks=pytest.mark.slow)])
def test_cells_are_as_stiff_as_a_smaller_punch(tension: float) -> None:
    """The stiffness of punches of cells, over five radii, is that of the corrected radius."""
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=tension)
    excess = []
    for radius in np.linspace(0.8, 1.2, 5):
        run: dict[str, Any] = {
            "grid": {"points": POINTS, "size": SIZE},
            "kernel": kernel,
            "indenter": {"type": "flat_punch", "radius": radius},
            "loading": {"depth": 1.0},
        }
        step = pl.run(run, progress=False).dataset.isel(step=0)
        # Under tension some cells beside the rim carry no pressure.
        counted = SPACING * np.sqrt(np.count_nonzero(np.hypot(step["x"], step["y"]) <= radius) / pi)
        force, wider = (punch(counted + h, 1.0, tension, depth=1.0).force for h in (0.0, 1e-3))
        excess.append((force - float(step["force"])) / (wider - force) * 1e-3)
    assert np.mean(excess) == pytest.approx(excess_radius(kernel, SPACING), abs=0.03 * SPACING)


def test_springs_count_their_cells() -> None:
    """Separate springs are as stiff as the area of the cells."""
    assert excess_radius(pl.kernel("winkler", foundation=1.0), SPACING) == 0
