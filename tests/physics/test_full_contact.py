"""Full contact on a periodic grid, where the Fourier symbol is the whole answer."""

from __future__ import annotations

import numpy as np
import pytest

import pellicle as pl
from tests.physics.tables_of_runs import heights, tensed
from tests.physics.tables_of_runs import step as solved


@pytest.mark.parametrize("tension", [0.0, 0.05, 3.0])
@pytest.mark.parametrize("waves", [(1, 0), (0, 3), (2, 1)])
def test_the_pressure_amplitude_of_a_sine_is_exact(
    tension: float, waves: tuple[int, int], solver: str
) -> None:
    """In full contact it is (E*/2)(q + s q²)Δ, s = 2τ₀/E*, to 1e-10."""
    modulus, amplitude, shape = 2.0, 1e-3, (24, 20)
    size = (1.0, 0.7)
    grid = pl.Grid(points=shape, size=size, boundary="periodic")
    x, y = grid.coordinates()
    qx, qy = (2 * np.pi * m / length for m, length in zip(waves, size, strict=True))
    wave = np.cos(qx * x + qy * y)
    q = np.hypot(qx, qy)
    expected = modulus / 2 * (q + 2 * tension / modulus * q**2) * amplitude
    step = solved(
        solver,
        1e-12,
        grid=grid,
        kernel=tensed(modulus, tension),
        indenter=heights(amplitude * wave),
        loading={"mean_pressure": 1.5 * expected},
    )
    assert float(step["contact_fraction"]) == 1.0
    assert 2 * np.mean(step["pressure"].values * wave) == pytest.approx(expected, rel=1e-10)
    assert float(step["mean_pressure"]) == pytest.approx(1.5 * expected, rel=1e-12)
