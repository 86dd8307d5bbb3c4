"""A solution has the same bits on any number of threads."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.fft

import pellicle as pl
from pellicle.numerics.operators import make_operator
from pellicle.numerics.problem import Depth, Force, Problem
from pellicle_plugins.solvers.multilevel_extension import Extension


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_solutions_have_the_same_bits(boundary: str) -> None:
    """Grids large enough that threads share every pass; 600 points end in a shorter block."""
    grid = pl.Grid(points=600 if boundary == "periodic" else 512, size=1.0, boundary=boundary)
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=0.01)
    rough = pl.indenter("self_affine", rms_height=0.01, hurst=0.8, cutoff_wavelength=0.05, seed=1)
    profile = rough.profile(*grid.coordinates())
    control = Force(0.02) if boundary == "periodic" else Depth(0.02)
    problem = Problem(grid, make_operator(kernel, grid), profile, control)
    solver = pl.solver("active_set", tolerance=1e-6)
    pressures = []
    for threads in (1, 2, 3):
        with scipy.fft.set_workers(threads):
            pressures.append(solver.solve(problem, None, lambda *_: None).pressure)
    assert 0.001 < (pressures[0] > 0).mean() < 0.9
    np.testing.assert_array_equal(pressures[1], pressures[0])
    np.testing.assert_array_equal(pressures[2], pressures[0])


@pytest.mark.slow
@pytest.mark.parametrize("orders", [[1.0] * 5, [4.0, 4.0, 3.0, 2.0, 1.0]])
def test_extensions_have_the_same_bits(orders: list[float]) -> None:
    """E and its transpose, with and without the sweeps of skins that bend."""
    generator = np.random.default_rng(0)
    known = generator.random((768, 544)) < 0.2
    extension = Extension(known, orders, stretch=(1.2, 0.8))
    values = np.where(known, generator.normal(size=known.shape), 0).astype(np.float32)
    force = generator.normal(size=known.shape).astype(np.float32)
    results = []
    for threads in (1, 2, 3):
        with scipy.fft.set_workers(threads):
            applied = extension.apply(values.copy())
            transposed = extension.apply_transpose(force.copy())
        results.append(np.stack([applied, np.where(known, transposed, 0)]))
    # The transpose is exact: ⟨E v, f⟩ = ⟨v, Eᵀ f⟩.
    applied, transposed = results[0].astype(np.float64)
    scale = np.linalg.norm(applied) * np.linalg.norm(force)
    assert abs((applied * force).sum() - (values * transposed).sum()) < 1e-6 * scale
    np.testing.assert_array_equal(results[1], results[0])
    np.testing.assert_array_equal(results[2], results[0])
