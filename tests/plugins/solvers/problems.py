"""Problems for solvers, and what a solver makes of one."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pellicle import Grid, Kernel, Problem, Solver, State, Stop
from pellicle.arrays import Array
from pellicle.contact.equilibrium import Equilibrium, measure
from pellicle.contact.problem import Depth, Force
from pellicle.surface import operator_of
from pellicle_plugins.indenters.self_affine import SelfAffine
from pellicle_plugins.kernels.half_spaces import TensedMembrane

Boundary = Literal["free", "periodic"]
Prescribed = Literal["depth", "force"]
Shape = Callable[[Array, Array], Array]

BOUNDARIES: list[Boundary] = ["free", "periodic"]


def make(
    points: tuple[int, int] | int,
    boundary: Boundary,
    kernel: Kernel,
    shape: Shape | Array | float,
    prescribed: Prescribed,
    value: float,
    size: tuple[float, float] | float = (1.0, 1.0),
) -> Problem:
    """Return a problem; its profile is ``shape``, or ``shape`` at the cell centres."""
    grid = Grid(points=points, size=size, boundary=boundary)
    heights = shape(*grid.coordinates()) if callable(shape) else shape
    profile = np.array(np.broadcast_to(heights, grid.shape))
    control = Depth(value) if prescribed == "depth" else Force(value)
    return Problem(grid, operator_of(kernel, grid), profile, control)


@dataclass(frozen=True)
class Solved:
    """What a solver found, and what it took."""

    equilibrium: Equilibrium
    pressure: Array
    applications: int
    stop: Stop

    @property
    def residual(self) -> float:
        """The largest of the fresh residuals."""
        equilibrium = self.equilibrium
        return max(
            equilibrium.residual_contact,
            equilibrium.residual_penetration,
            equilibrium.residual_complementarity,
            equilibrium.residual_load,
        )


def solve(problem: Problem, solver: Solver, start: State | Array | None = None) -> Solved:
    """Return what a solver finds from a state or a pressure, measured afresh."""
    before = problem.operator.applications
    state = State(start, start, 0.0) if isinstance(start, np.ndarray) else start
    solution = solver.solve(problem, state, lambda iteration, excess: None)
    applications = problem.operator.applications - before
    pressure = solution.pressure
    assert pressure.min() >= 0
    return Solved(measure(problem, pressure), pressure, applications, solution.stop)


def skin(s: float) -> TensedMembrane:
    """Return a half-space of modulus 1 and elastocapillary length ``s``."""
    return TensedMembrane(reduced_modulus=1.0, tension=s / 2)


def paraboloid(x: Array, y: Array) -> Array:
    """Return a paraboloid of radius 1."""
    return -(x**2 + y**2) / 2


def rough(cutoff: float, seed: int = 1) -> Shape:
    """Return a self-affine surface of rms height 0.01."""
    return SelfAffine(rms_height=0.01, hurst=0.8, cutoff_wavelength=cutoff, seed=seed).profile
