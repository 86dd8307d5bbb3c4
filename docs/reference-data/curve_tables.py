"""Make the tables behind the force curves of indenters of revolution.

``python docs/reference-data/curve_tables.py`` replaces ``punches.npz``, which
``pellicle_axisymmetric.reciprocity`` describes, in half a minute, and ``layer_curves.npz``, which
``pellicle_axisymmetric.layer_curves`` describes, in about ten.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from layer_equation import HalfSpace, Moments, half_space, moments
from numpy.polynomial import chebyshev
from numpy.polynomial.legendre import legval

from pellicle.arrays import Array
from pellicle_axisymmetric import layer_curves, reciprocity
from pellicle_axisymmetric.equation import influence
from pellicle_axisymmetric.layer_curves import Shape
from pellicle_axisymmetric.panels import gauss, graded_panels
from pellicle_axisymmetric.product_integration import collocation, kernel_substitution

SHAPES: tuple[Shape, ...] = ("smooth", "pointed", "punch")
_ORDER, _FINEST = 12, 1e-3
"""Gauss points per panel, and size of the finest panel over that of the edge layer."""
_MODES = 24
"""Products of the decomposition; what is left out is below 1e-11 of the largest."""
_STEP = 2.0**-24
"""To which changes by a layer are rounded: digits of small ones would be most of the file."""


def punch(ratio: float) -> tuple[float, Array]:
    """Return log(k/2E*a) and φ sin η / k at the nodes η of the table, at s/a = ratio > 0."""
    panels = graded_panels(_ORDER, _FINEST * np.sqrt(min(1.0, ratio)), 1.0)
    matrix = collocation(panels, influence(ratio, 0), kernel_substitution(ratio), 1)
    values = np.linalg.solve(matrix, np.ones(len(matrix))).reshape(len(panels), _ORDER)
    _, unit, to_legendre = gauss(_ORDER)
    angles, found, integral = reciprocity.ANGLES, np.empty(reciprocity.ANGLES.size), 0.0
    for panel, value in zip(panels, values, strict=True):
        low, high = float(panel.end.eta), float(panel.start.eta)
        integral += panel.length / 2 * float(unit @ value)
        inside = (angles >= low) & (angles <= high)
        local = 1 - 2 * (angles[inside] - low) / (high - low)
        found[inside] = legval(local, to_legendre @ value)
    return float(np.log(np.pi * integral)), found / (2 * np.pi * integral)


def punches() -> dict[str, Any]:
    """Return log(k/2E*a) beside the shares of the modes at each s/a, and the modes over η."""
    # Without tension φ = 1/π.
    solved = [(0.0, np.sin(reciprocity.ANGLES) / (2 * np.pi))]
    solved += [punch(ratio) for ratio in reciprocity.LENGTHS[1:].tolist()]
    stiffness, shapes = (np.array(part) for part in zip(*solved, strict=True))
    left, sizes, right = np.linalg.svd(shapes, full_matrices=False)
    shares = (left * sizes)[:, :_MODES]
    return {"shares": np.column_stack([stiffness, shares]), "modes": right[:_MODES].T}


def profiles(equation: HalfSpace) -> Array:
    """Return the profiles of a shape at the nodes of the equation, one in each column."""
    t = equation.nodes.t
    smooth = equation.shape == "smooth"
    return layer_curves.odd_chebyshev(t) if smooth else np.ones((t.size, 1))


def row(shape: Shape, values: Moments) -> Array:
    """Return log(P/E*a²) of the first profile, P of the others over it, and δ/a of all."""
    force = np.append(np.log(values.force[:1]), values.force[1:] / values.force[0])
    return force if shape == "punch" else np.concatenate([force, values.depth])


def on_half_space(shape: Shape, length: float) -> Array:
    """Return the row of a contact on a half-space at s/a."""
    equation = half_space(shape, length)
    return row(shape, moments(equation, profiles(equation), 0.0, 0.0))


def change_by_layer(shape: Shape, length: float, confinement: float) -> Array:
    """Return Chebyshev coefficients over ν of the change that a layer makes at s/h and a/h."""
    nodes = chebyshev.chebpts1(layer_curves.RATIO_NODES)
    equation = half_space(shape, length / confinement)
    slopes = profiles(equation)
    without = row(shape, moments(equation, slopes, 0.0, 0.0))
    change = [
        row(shape, moments(equation, slopes, confinement, ratio)) - without
        for ratio in layer_curves.poissons_ratio_at(nodes).tolist()
    ]
    coefficients = chebyshev.chebfit(nodes, np.array(change), layer_curves.RATIO_NODES - 1)
    return np.asarray(coefficients, dtype=np.float64)


def main() -> None:
    """Solve all nodes and write both files."""
    np.savez_compressed(reciprocity.FILE, **punches())
    tables: dict[str, Any] = {}
    for shape in SHAPES:
        rows = [on_half_space(shape, length) for length in layer_curves.HALF_SPACE_LENGTHS.tolist()]
        tables[f"{shape}_half_space"] = np.array(rows)
    for shape in SHAPES:
        changes = [
            [change_by_layer(shape, s, a) for a in layer_curves.CONFINEMENTS.tolist()]
            for s in layer_curves.LENGTHS.tolist()
        ]
        rounded = np.round(np.array(changes) / _STEP) * _STEP
        # The axes are ν, s/h, a/h and the columns of a row.
        tables[f"{shape}_layer"] = np.moveaxis(rounded.astype(np.float32), 2, 0)
    np.savez_compressed(layer_curves.FILE, **tables)


if __name__ == "__main__":
    main()
