"""A surface whose edges do not meet is not periodic, and the user is warned."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import pellicle as pl
from pellicle.runs.compose import warn_of_period

PERIODIC = pl.Grid(points=[24, 32], size=["0.6 mm", "0.8 mm"], boundary="periodic")
X, Y = PERIODIC.coordinates()


def test_a_tilted_surface_is_no_period() -> None:
    """The step is that of the tilt, along the axis that it is along."""
    with pytest.warns(UserWarning, match=r"along y: .* step of 775 µm .* 25 µm") as warning:
        warn_of_period(np.broadcast_to(Y, PERIODIC.shape), PERIODIC)
    assert len(warning) == 1


@pytest.mark.parametrize("seed", range(5))
def test_what_is_a_period_is_silent(seed: int) -> None:
    """Rough surfaces made periodic, waves, noise and single peaks on the seam have no seam."""
    rough = pl.indenter(
        "self_affine", rms_height=1e-6, hurst=0.8, cutoff_wavelength=1e-4, seed=seed
    )
    noise = np.random.default_rng(seed).standard_normal(PERIODIC.shape)
    wave = np.sin(2 * np.pi * (X / 6e-4 + Y / 8e-4) + seed)
    peak = np.exp(-(((np.abs(X) - 3e-4) ** 2 + (np.abs(Y) - 4e-4) ** 2) / 1e-9))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for heights in (rough.profile(X, Y), noise, wave, peak):
            warn_of_period(heights, PERIODIC)


def test_a_free_grid_has_no_seam() -> None:
    """There nothing goes on beyond the edge."""
    free = pl.Grid(points=PERIODIC.points, size=PERIODIC.size)
    warn_of_period(np.broadcast_to(Y, free.shape), free)
