"""Solve the axisymmetric equation at the nodes of the master curves and write them to a file.

``python -m pellicle_plugins.indenters.master_curve_nodes`` replaces ``master_curves.json``, which
``master_curves`` describes and interpolates.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.polynomial import chebyshev
from scipy.optimize import newton

from pellicle_plugins.axisymmetric.abel_transform import HasAbelTransform
from pellicle_plugins.axisymmetric.equation import solve
from pellicle_plugins.axisymmetric.indentation import indent
from pellicle_plugins.axisymmetric.master_curves import FILE, SCALE, one_variable
from pellicle_plugins.axisymmetric.tensed_punch import punch
from pellicle_plugins.indenters.cone import Cone
from pellicle_plugins.indenters.paraboloid import Paraboloid
from pellicle_plugins.indenters.sphere import Sphere

_LENGTHS = SCALE * np.expm1(np.arange(0.0, 23.1, 0.15))
"""s over the contact radius."""
_SPHERE_LENGTHS = SCALE * np.expm1(np.arange(0.0, 16.3, 0.4))
"""s / √(δR)."""
_SPHERE_DEPTHS = (chebyshev.chebpts1(9) + 1) / 2
"""δ / R."""


def _scaled(
    indenter: HasAbelTransform, exponent: float, classical: float
) -> dict[str, list[float]]:
    """Return x = s/δ^(1/exponent) and log(P/P₀), P₀ = classical · δ^(1 + 1/exponent)."""
    xs, logs = [0.0], [0.0]
    for length in _LENGTHS[1:]:
        contact = indent(indenter, 1.0, length / 2, contact_radius=1.0)
        xs.append(length / contact.depth ** (1 / exponent))
        logs.append(np.log(contact.force / (classical * contact.depth ** (1 + 1 / exponent))))
    return {"x": xs, "log_ratio": [float(value) for value in logs]}


def _flat_punch() -> dict[str, list[float]]:
    forces = [punch(1.0, 1.0, length / 2, depth=1.0).force for length in _LENGTHS]
    return {"x": list(_LENGTHS), "log_ratio": [float(np.log(force / 2)) for force in forces]}


def _sphere(paraboloid: dict[str, list[float]]) -> dict[str, list[float] | list[list[float]]]:
    """Return Chebyshev coefficients in δ/R of log(P sphere / P paraboloid) / (δ/R)."""
    correction = one_variable(paraboloid)
    sphere = Sphere(radius=1.0)
    values = np.empty((_SPHERE_LENGTHS.size, _SPHERE_DEPTHS.size))
    for j, depth in enumerate(_SPHERE_DEPTHS):
        log_a = np.log(indent(sphere, 1.0, 0.0, depth=depth).contact_radius)
        for i, x in enumerate(_SPHERE_LENGTHS):
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
    return {"x": list(_SPHERE_LENGTHS), "coefficients": coefficients.tolist()}


def main() -> None:
    """Solve all nodes and write the file."""
    paraboloid = _scaled(Paraboloid(radius=1.0), 2, 4 / 3)
    curves = {
        "paraboloid": paraboloid,
        "cone": _scaled(Cone(half_angle=np.pi / 4), 1, 2 / np.pi),
        "flat_punch": _flat_punch(),
        "sphere": _sphere(paraboloid),
    }
    Path(str(FILE)).write_text(json.dumps(curves, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
