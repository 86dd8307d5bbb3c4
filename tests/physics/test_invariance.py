"""What must not change when the problem is turned, mirrored, scaled or split."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from tests.physics.tables import heights, step, steps, tensed

TOLERANCE = 1e-9


def _step(run: dict[str, Any], solver: str) -> xr.Dataset:
    return step(solver, TOLERANCE, **run)


def _quadric(
    radius_x: float,
    radius_y: float,
    boundary: str = "free",
    length: float = 1.0,
    modulus: float = 1.0,
) -> dict[str, Any]:
    """Return the run of a quadric, with lengths and moduli in given units."""
    radii = {"radius_x": radius_x * length, "radius_y": radius_y * length}
    return {
        "grid": {"points": 48, "size": 0.4 * length, "boundary": boundary},
        "kernel": tensed(modulus, 0.02 * modulus * length),
        "indenter": {"type": "quadric", **radii},
        "loading": {"force": 2e-4 * modulus * length**2},
    }


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_a_quadric_turned_by_90_degrees(boundary: str, solver: str) -> None:
    """Swapping its radii transposes the pressure and leaves force, depth and area alone."""
    one = _step(_quadric(1.0, 2.0, boundary), solver)
    other = _step(_quadric(2.0, 1.0, boundary), solver)
    assert float(one["depth"]) == pytest.approx(float(other["depth"]), rel=1e-8)
    assert float(one["contact_area"]) == float(other["contact_area"])
    highest = one["pressure"].values.max()
    np.testing.assert_allclose(
        one["pressure"].values, other["pressure"].values.T, atol=1e-6 * highest
    )


def test_mirror_images_have_mirrored_pressures(solver: str) -> None:
    """A rough punch and its mirror images have the same force and mirrored pressures."""
    grid = {"points": [40, 32], "size": [1.0, 0.8]}
    fine = pl.Grid(**grid)
    rough = pl.indenter("self_affine", rms_height=0.01, hurst=0.8, cutoff_wavelength=0.1, seed=3)
    profile = rough.profile(*fine.coordinates())
    pressures = []
    for turn in (np.s_[:, :], np.s_[::-1, :], np.s_[:, ::-1]):
        tables = {"grid": grid, "kernel": tensed(1.0, 0.01), "loading": {"depth": 0.02}}
        mirrored = _step({**tables, "indenter": heights(profile[turn])}, solver)
        pressures.append(mirrored["pressure"].values[turn])
    for pressure in pressures[1:]:
        np.testing.assert_allclose(pressure, pressures[0], atol=1e-6 * pressures[0].max())


def test_lengths_and_moduli_can_be_scaled(solver: str) -> None:
    """Lengths × 1e-6 and moduli × 1e4 leave the dimensionless result to the solver tolerance."""
    length, modulus = 1e-6, 1e4
    one = _step(_quadric(1.0, 2.0), solver)
    scaled = _step(_quadric(1.0, 2.0, length=length, modulus=modulus), solver)
    assert float(scaled["depth"]) / length == pytest.approx(float(one["depth"]), rel=1e-8)
    assert float(scaled["contact_area"]) / length**2 == pytest.approx(float(one["contact_area"]))
    np.testing.assert_allclose(
        scaled["pressure"].values / modulus,
        one["pressure"].values,
        atol=1e-6 * one["pressure"].values.max(),
    )


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_the_operator_is_linear_symmetric_and_positive(boundary: str) -> None:
    """A(αp + q) = αAp + Aq, ⟨Ap, q⟩ = ⟨p, Aq⟩ and ⟨Ap, p⟩ > 0 to round-off."""
    grid = pl.Grid(points=[15, 22], size=[1.0, 2.0], boundary=boundary)
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=0.1)
    p, q = np.random.default_rng(1).normal(size=(2, *grid.shape))
    ap, aq, both = (pl.displacement(v, kernel=kernel, grid=grid) for v in (p, q, 3 * p + q))
    np.testing.assert_allclose(both, 3 * ap + aq, atol=1e-14)
    assert np.vdot(ap, q) == pytest.approx(np.vdot(p, aq), rel=1e-12)
    assert np.vdot(ap, p) > 0


def test_an_isolated_contact_does_not_see_its_domain(solver: str) -> None:
    """On a free boundary a larger domain with the same cells changes nothing."""
    small, large = _quadric(1.0, 1.0), _quadric(1.0, 1.0)
    large["grid"] = {"points": 64, "size": 0.4 * 64 / 48}
    one, other = _step(small, solver), _step(large, solver)
    assert float(one["depth"]) == pytest.approx(float(other["depth"]), rel=1e-8)
    np.testing.assert_allclose(
        one["pressure"].values,
        other["pressure"].values[8:-8, 8:-8],
        atol=1e-6 * one["pressure"].values.max(),
    )


def test_a_wide_periodic_cell_comes_near_the_free_boundary() -> None:
    """The stiffness between two loads is that of an isolated contact once the images are far."""
    stiffness = {}
    for boundary, width in (("free", 1), ("periodic", 1), ("periodic", 4)):
        run = _quadric(1.0, 1.0, boundary)
        run["grid"] = {"points": 32 * width, "size": 0.4 * width, "boundary": boundary}
        run["loading"] = {"force": [2e-4, 2.4e-4]}
        depth = steps(**run)["depth"].values
        stiffness[boundary, width] = 4e-5 / (depth[1] - depth[0])
    free = stiffness["free", 1]
    near, far = stiffness["periodic", 1] / free - 1, stiffness["periodic", 4] / free - 1
    assert abs(far) < 0.35 * abs(near)
