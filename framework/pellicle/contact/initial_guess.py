"""Initial pressures for a solver without an earlier step."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle.surface.operators import Operator

from .problem import Unilateral


def first_guess(problem: Unilateral) -> Array:
    """Return an initial pressure [Pa], with the prescribed force under force control.

    It is uniform on the indenter under force control, else `overlap_pressure` of indenter and
    undeformed surface.
    """
    if problem.prescribed == "force":
        return with_force(problem, np.isfinite(problem.profile).astype(np.float64))
    return overlap_pressure(problem.operator, np.maximum(problem.profile + problem.value, 0.0))


def overlap_pressure(operator: Operator, overlap: Array) -> Array:
    """Return the pressure ∝ overlap [m] whose displacement is nearest to it in energy [Pa].

    The factor c minimises ½⟨c o, A c o⟩ − ⟨c o, o⟩: c = ⟨o, o⟩/⟨o, A o⟩.
    """
    return overlap * (dot(overlap, overlap) / dot(overlap, operator(overlap)))


def with_force(problem: Unilateral, pressure: Array, out: Array | None = None) -> Array:
    """Return a pressure scaled to the prescribed force; unchanged under depth control.

    The scaled pressure is in ``out``, which may be ``pressure``, or in a new array.
    """
    if problem.prescribed == "depth":
        return pressure
    factor = problem.value / (float(pressure.sum()) * problem.grid.cell_area)
    return np.multiply(pressure, factor, out=out)


def dot(a: NDArray[Any], b: NDArray[Any]) -> float:
    """Return Σ a · b over two fields.

    BLAS is avoided because its threads spin while waiting, which takes cores from the transforms.
    """
    return float(np.einsum("i,i->", a.reshape(-1), b.reshape(-1)))
