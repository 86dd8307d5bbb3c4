"""Make the tables of force curves that the built-in indenters of revolution interpolate.

``python docs/reference-data/curve_tables.py`` replaces ``master_curves.json``, which
``axisymmetric.master_curves`` describes, and ``layer_curves.npz``, which
``axisymmetric.layer_curves`` describes, in about ten minutes.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from layer_equation import HalfSpace, Moments, half_space, moments
from numpy.polynomial import chebyshev
from scipy.optimize import newton

from pellicle.arrays import Array
from pellicle_plugins.axisymmetric import layer_curves, master_curves
from pellicle_plugins.axisymmetric.equation import HasAbelTransform, solve
from pellicle_plugins.axisymmetric.indentation import indent
from pellicle_plugins.axisymmetric.layer_curves import Shape
from pellicle_plugins.axisymmetric.tensed_punch import punch
from pellicle_plugins.indenters.of_revolution import Cone, Paraboloid, Sphere

SHAPES: tuple[Shape, ...] = ("smooth", "pointed", "punch")
LENGTHS = master_curves.SCALE * np.expm1(np.arange(0.0, 23.1, 0.15))
"""s over the contact radius."""
SPHERE_LENGTHS = master_curves.SCALE * np.expm1(np.arange(0.0, 16.3, 0.4))
"""s / √(δR)."""
SPHERE_DEPTHS = (chebyshev.chebpts1(9) + 1) / 2
"""δ / R."""


def scaled(indenter: HasAbelTransform, exponent: float, classical: float) -> dict[str, list[float]]:
    """Return x = s/δ^(1/exponent) and log(P/P₀), P₀ = classical · δ^(1 + 1/exponent)."""
    xs, logs = [0.0], [0.0]
    for length in LENGTHS[1:]:
        contact = indent(indenter, 1.0, length / 2, contact_radius=1.0)
        xs.append(length / contact.depth ** (1 / exponent))
        logs.append(np.log(contact.force / (classical * contact.depth ** (1 + 1 / exponent))))
    return {"x": xs, "log_ratio": [float(value) for value in logs]}


def flat_punch(lengths: Array) -> dict[str, list[float]]:
    """Return x = s/a and log(P/P₀)."""
    forces = [punch(1.0, 1.0, length / 2, depth=1.0).force for length in lengths]
    return {"x": list(lengths), "log_ratio": [float(np.log(force / 2)) for force in forces]}


def sphere(paraboloid: dict[str, list[float]]) -> dict[str, list[float] | list[list[float]]]:
    """Return Chebyshev coefficients in δ/R of log(P sphere / P paraboloid) / (δ/R)."""
    correction = master_curves.one_variable(paraboloid)
    sphere = Sphere(radius=1.0)
    values = np.empty((SPHERE_LENGTHS.size, SPHERE_DEPTHS.size))
    for j, depth in enumerate(SPHERE_DEPTHS):
        log_a = np.log(indent(sphere, 1.0, 0.0, depth=depth).contact_radius)
        for i, x in enumerate(SPHERE_LENGTHS):
            length = x * np.sqrt(depth)

            def excess(log_a: float, length: float = length, depth: float = depth) -> float:
                a = float(np.exp(log_a))
                return float(np.log(solve(sphere, a, length / a, 0).moments()[1] * a / depth))

            log_a = newton(excess, log_a, x1=log_a - 1e-3, tol=1e-12)
            a = float(np.exp(log_a))
            contact = indent(sphere, 1.0, length / 2, contact_radius=a)
            flat = 4 / 3 * contact.depth**1.5 * np.exp(correction(np.array([x]))[0][0])
            values[i, j] = np.log(contact.force / flat) / contact.depth
    coefficients = chebyshev.chebfit(chebyshev.chebpts1(9), values.T, 8).T
    return {"x": list(SPHERE_LENGTHS), "coefficients": coefficients.tolist()}


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
    paraboloid = scaled(Paraboloid(radius=1.0), 2, 4 / 3)
    curves = {
        "paraboloid": paraboloid,
        "cone": scaled(Cone(half_angle=np.pi / 4), 1, 2 / np.pi),
        "flat_punch": flat_punch(LENGTHS),
        "sphere": sphere(paraboloid),
    }
    text = json.dumps(curves, indent=1) + "\n"
    Path(str(master_curves.FILE)).write_text(text, encoding="utf-8")
    tables: dict[str, Any] = {}
    for shape in SHAPES:
        rows = [on_half_space(shape, length) for length in layer_curves.HALF_SPACE_LENGTHS.tolist()]
        tables[f"{shape}_half_space"] = np.array(rows)
    for shape in SHAPES:
        changes = [
            [change_by_layer(shape, s, a) for a in layer_curves.CONFINEMENTS.tolist()]
            for s in layer_curves.LENGTHS.tolist()
        ]
        # The axes are ν, s/h, a/h and the columns of a row.
        tables[f"{shape}_layer"] = np.moveaxis(np.array(changes, dtype=np.float32), 2, 0)
    np.savez_compressed(Path(str(layer_curves.FILE)), **tables)


if __name__ == "__main__":
    main()
