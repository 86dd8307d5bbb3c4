"""Cells too wide for a kernel, and surfaces that are no period, are said to be."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.runs.compose import warn_of_period
from pellicle.surface import operator_of
from pellicle.surface.influence import error_of_cells, warn_of_cells

THICK = 10e-6


def layer(poissons_ratio: float = 0.5, type_: str = "bonded_layer") -> Any:
    """Return a layer of the thickness `THICK`."""
    fields = {"youngs_modulus": "9 kPa", "poissons_ratio": poissons_ratio, "thickness": THICK}
    return pl.kernel(type_, **fields)


def skin(length: float, bending: float = 0.0) -> Any:
    """Return a skin on a half-space, by 2τ₀/E* and (2B/E*)^⅓ [m]."""
    return pl.kernel(
        "bending_skin", reduced_modulus=1e4, tension=5e3 * length, bending=5e3 * bending**3
    )


@pytest.mark.parametrize("ratio", [0.3, 0.6, 1.0, 3.0])
@pytest.mark.parametrize("poissons_ratio", [0.5, 0.4])
def test_error_is_that_of_the_cells(ratio: float, poissons_ratio: float) -> None:
    """It is how a long wave of cells sinks under the operator, over what the kernel says."""
    kernel, n = layer(poissons_ratio), 129
    grid = pl.Grid(points=n, size=n * THICK / ratio, boundary="free")
    pressure = np.zeros(grid.shape)
    pressure[n // 2, n // 2] = 1.0
    # Far from the edges the line response of one cell, summed up with the wave.
    response = operator_of(kernel, grid)(pressure).sum(axis=1)
    q = 2 * np.pi / (16 * grid.spacing[0])
    total = (response * np.cos(q * grid.coordinates()[0][:, 0])).sum()
    expected = total / kernel.compliance(np.array([q]))[0] - 1
    error = error_of_cells(kernel.compliance, grid.spacing[0])
    assert error == pytest.approx(expected, abs=2e-4)


def test_force_is_as_wrong_as_is_said() -> None:
    """Cells twice as wide as a film is thick: its force against that of cells a fifth as wide."""
    radius, width = 1e-3, 12 * THICK

    def force(points: int) -> float:
        run = {
            "grid": {"points": points, "size": 3.2 * width},
            "kernel": layer(),
            "indenter": {"type": "paraboloid", "radius": radius},
            "loading": {"depth": width**2 / (4 * radius)},
            "solver": {"type": "active_set", "tolerance": 1e-6},
        }
        return float(pl.run(run, progress=False).dataset["force"][0])

    with pytest.warns(UserWarning, match=r"grid\.points: cells of .* by 12% more .* use about"):
        coarse = force(19)
    error = error_of_cells(layer().compliance, 3.2 * width / 19)
    assert coarse / force(96) * (1 + error) == pytest.approx(1, abs=0.03)


@pytest.mark.parametrize("ratio", [0.12, 0.2, 0.3, 0.5, 0.8])
def test_films_thinner_than_a_cell_are_warned_of(ratio: float) -> None:
    """The number of points that is recommended is enough, and four fifths of it are not."""
    spacing = THICK / ratio
    grid = pl.Grid(points=40, size=40 * spacing, boundary="free")
    with pytest.warns(UserWarning, match=r"use about \d+ × \d+ points$") as result:
        pl.displacement(np.ones(grid.shape), kernel=layer(), grid=grid)
    recommended = int(str(result[0].message).split(" × ")[-1].split()[0])
    finer = 40 * spacing / recommended
    assert abs(error_of_cells(layer().compliance, finer)) < 0.03
    assert abs(error_of_cells(layer().compliance, finer / 0.8)) > 0.03


@pytest.mark.parametrize("ratio", [1e-3, 0.03, 0.1, 0.3, 1.0, 3.0, 30.0, 1e3])
@pytest.mark.parametrize(
    "make",
    {
        "tension": skin,
        "bending": lambda length: skin(0.0, length),
        "both": lambda length: skin(length, length),
        "springs": lambda _: pl.kernel("winkler", foundation="1 GPa/m"),
        "slips": lambda length: layer(0.5, "frictionless_layer").model_copy(
            update={"thickness": length}
        ),
        "compressible": lambda length: layer(0.4).model_copy(update={"thickness": length}),
    }.values(),
)
def test_no_other_length_under_a_cell_is_warned_of(make: Any, ratio: float) -> None:
    """A skin that the cells do not resolve is the half-space, a compressible layer is springs."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_cells(make(ratio * 1e-5).compliance, pl.Grid(points=16, size=16e-5))


def test_periodic_boundaries_sample_the_kernel_itself() -> None:
    """No warning: each wave has the compliance that the kernel says."""
    grid = pl.Grid(points=16, size=16 * 3 * THICK, boundary="periodic")
    wave = np.cos(2 * np.pi * np.arange(16) / 16)[:, None] + np.zeros((16, 16))
    q = 2 * np.pi / grid.size[0]
    result = pl.displacement(wave, kernel=layer(), grid=grid)
    np.testing.assert_allclose(result, layer().compliance(np.array([q]))[0] * wave, atol=1e-18)


def test_kernel_that_overflows_at_short_waves_is_not_judged() -> None:
    """A closed form needs its symbol at the waves of the grid only."""
    error = error_of_cells(lambda q: np.sinh(q * 1e-5) / np.cosh(q * 1e-5), 1e-6)
    assert np.isnan(error)
    warn_of_cells(lambda q: np.full_like(q, np.nan), pl.Grid(points=16, size=1e-3))


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
