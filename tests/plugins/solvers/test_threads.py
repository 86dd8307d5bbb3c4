"""A solution has the same bits on any number of threads."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.fft

from pellicle_plugins.solvers.active_set import ActiveSet
from pellicle_plugins.solvers.multilevel_extension import Extension
from tests.plugins.solvers.problems import Boundary, Prescribed, make, rough, skin, solve


@pytest.mark.parametrize("boundary", ["periodic", pytest.param("free", marks=pytest.mark.slow)])
def test_solutions_have_the_same_bits(boundary: Boundary) -> None:
    """Grids large enough that threads share every pass; 600 points end in a shorter block."""
    prescribed: Prescribed = "force" if boundary == "periodic" else "depth"
    points = 600 if boundary == "periodic" else 512
    problem = make(points, boundary, skin(0.02), rough(0.05), prescribed, 0.02)
    pressures = []
    for threads in (1, 2, 3):
        with scipy.fft.set_workers(threads):
            pressures.append(solve(problem, ActiveSet(tolerance=1e-6)).pressure)
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
