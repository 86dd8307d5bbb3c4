"""Print the table behind the force curves of pyramids, ``pellicle_plugins.indenters.pyramid``.

``python docs/reference-data/pyramid_curves.py`` presses pyramids of slope 1 by a depth of 1, in
grids that their contacts fill, and takes two minutes.  Under a tension forces converge in
proportion to the edge of a cell, to which those of two grids are extrapolated.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

import pellicle as pl
from pellicle_axisymmetric import cone
from pellicle_plugins.indenters.pyramid import LENGTHS

POINTS = 128, 256, 512
_COARSE, _CELLS, _ROOM = 64, 0.8, 1.08
"""Points of the grid by which a contact is measured, how much of it is filled, and of the next."""


def pressed(sides: int, length: float, points: int, size: float) -> Any:
    """Return the contact of a pyramid of slope 1 at a depth of 1 and s = ``length``."""
    run: dict[str, Any] = {
        "grid": {"points": points, "size": size},
        "kernel": {"type": "tensed_membrane", "reduced_modulus": 1.0, "tension": length / 2},
        "indenter": {"type": "pyramid", "half_angle": pi / 4, "sides": sides},
        "loading": {"depth": 1.0},
    }
    return pl.run(run).dataset


def fitting_size(sides: int, length: float) -> float:
    """Return the edge of a grid that a contact fills."""
    size = 4.2
    while True:
        contact = pressed(sides, length, _COARSE, size)["contact"].values[-1]
        reach = np.abs(np.argwhere(contact) - (_COARSE - 1) / 2).max() + 1
        filled = 2 * reach / _COARSE
        if filled > _CELLS:
            return size
        size *= _ROOM * filled


def ratio(sides: int, length: float) -> tuple[float, float]:
    """Return the logarithm of the force over that of the cone of the same slope, and its error."""
    size = fitting_size(sides, length)
    forces = [float(pressed(sides, length, n, size)["force"][-1]) for n in POINTS]
    coarse, fine = (2 * fine - coarse for coarse, fine in pairwise(forces))
    return float(np.log(fine / cone(pi / 4, np.ones(1), length).force[0])), abs(1 - coarse / fine)


def main() -> None:
    """Print the values at the nodes of each pyramid."""
    for sides in (3, 4):
        found = [ratio(sides, length) for length in LENGTHS.tolist()]
        values, errors = zip(*found, strict=True)
        print(f"{sides} sides: the grids differ by {max(errors):.1g}")
        print(*(f"{value:.5f}" for value in values), sep=", ")


if __name__ == "__main__":
    main()
