"""Solve the equation of a bonded layer at the nodes of its curves and write them to a file.

``python -m pellicle_plugins.axisymmetric.layer_curve_nodes`` replaces ``layer_curves.npz``, which
``layer_curves`` describes and interpolates, in about ten minutes.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from pellicle.arrays import Array

from .layer_curves import (
    CONFINEMENTS,
    FILE,
    HALF_SPACE_LENGTHS,
    LENGTHS,
    PROFILES,
    RATIO_NODES,
    Shape,
    odd_chebyshev,
    poissons_ratio_at,
)
from .layer_equation import HalfSpace, Moments, half_space, moments

SHAPES: tuple[Shape, ...] = ("smooth", "pointed", "punch")


def slopes(equation: HalfSpace) -> Array:
    """Return the profiles of a shape at the nodes of the equation, one in each column."""
    t = equation.nodes.t
    return odd_chebyshev(t) if equation.shape == "smooth" else np.ones((t.size, 1))


def on_half_space(shape: Shape, values: Moments) -> Array:
    """Return log(P/E*a²) of the first profile, P of the others over it, and δ/a of all."""
    force = np.append(np.log(values.force[:1]), values.force[1:] / values.force[0])
    return force if shape == "punch" else np.concatenate([force, values.depth])


def _half_space(shape: Shape) -> Array:
    rows = []
    for ratio in HALF_SPACE_LENGTHS:
        equation = half_space(shape, float(ratio))
        rows.append(on_half_space(shape, moments(equation, slopes(equation), 0.0, 0.0)))
    return np.array(rows)


def _layer(shape: Shape) -> Array:
    """Return Chebyshev coefficients over ν of the change that a layer makes at each s/h, a/h."""
    nodes = poissons_ratio_at(chebyshev.chebpts1(RATIO_NODES)).tolist()
    columns = {"smooth": 2 * PROFILES, "pointed": 2, "punch": 1}[shape]
    change = np.empty((RATIO_NODES, LENGTHS.size, CONFINEMENTS.size, columns))
    for i, length in enumerate(LENGTHS.tolist()):
        for j, confinement in enumerate(CONFINEMENTS.tolist()):
            equation = half_space(shape, length / confinement)
            profiles = slopes(equation)
            without = on_half_space(shape, moments(equation, profiles, 0.0, 0.0))
            for n, ratio in enumerate(nodes):
                solved = moments(equation, profiles, confinement, ratio)
                change[n, i, j] = on_half_space(shape, solved) - without
    flat = change.reshape(RATIO_NODES, -1)
    coefficients = chebyshev.chebfit(chebyshev.chebpts1(RATIO_NODES), flat, RATIO_NODES - 1)
    return np.asarray(coefficients, dtype=np.float64).reshape(change.shape)


def main() -> None:
    """Solve all nodes and write the file."""
    tables: dict[str, Any] = {f"{shape}_half_space": _half_space(shape) for shape in SHAPES}
    tables |= {f"{shape}_layer": _layer(shape).astype(np.float32) for shape in SHAPES}
    np.savez_compressed(Path(str(FILE)), **tables)


if __name__ == "__main__":
    main()
