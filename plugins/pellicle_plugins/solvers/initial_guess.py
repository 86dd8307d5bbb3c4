"""Where an iteration starts that has nothing better to start from."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array
from pellicle.numerics.problem import Problem

from .products import dot


def first_guess(problem: Problem) -> Array:
    """Return a pressure [Pa] wherever there can be contact; see `with_force` for its size."""
    if problem.prescribed == "force":
        return np.isfinite(problem.profile).astype(np.float64)
    overlap = np.maximum(problem.profile + problem.value, 0.0)
    response = problem.operator(overlap)
    # The multiple of the overlap whose displacement comes nearest to it in energy.
    return overlap * (dot(overlap, overlap) / dot(overlap, response))


def with_force(problem: Problem, pressure: Array) -> Array:
    """Return the multiple of a pressure that makes the prescribed force, if one is prescribed."""
    if problem.prescribed == "depth":
        return pressure
    return pressure * (problem.value / (float(pressure.sum()) * problem.grid.cell_area))
