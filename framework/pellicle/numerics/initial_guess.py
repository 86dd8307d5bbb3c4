"""Pressures to start an iteration from, where there is no earlier step."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array

from .operators import Operator
from .problem import Problem


def first_guess(problem: Problem) -> Array:
    """Return a pressure [Pa] wherever there can be contact, with the force if one is prescribed."""
    if problem.prescribed == "force":
        return with_force(problem, np.isfinite(problem.profile).astype(np.float64))
    return overlap_pressure(problem.operator, np.maximum(problem.profile + problem.value, 0.0))


def overlap_pressure(operator: Operator, overlap: Array) -> Array:
    """Return the multiple of an overlap [m] whose displacement is nearest to it in energy [Pa].

    The factor c minimises ½⟨c o, A c o⟩ − ⟨c o, o⟩: c = ⟨o, o⟩/⟨o, A o⟩.
    """
    return overlap * (dot(overlap, overlap) / dot(overlap, operator(overlap)))


def with_force(problem: Problem, pressure: Array) -> Array:
    """Return the multiple of a pressure that has the prescribed force, if one is prescribed."""
    if problem.prescribed == "depth":
        return pressure
    return pressure * (problem.value / (float(pressure.sum()) * problem.grid.cell_area))


def dot(one: NDArray[Any], other: NDArray[Any]) -> float:
    """Return Σ one · other over two fields.

    BLAS is avoided: its threads spin while they wait, and take a core from the transforms.
    """
    return float(np.einsum("i,i->", one.reshape(-1), other.reshape(-1)))
