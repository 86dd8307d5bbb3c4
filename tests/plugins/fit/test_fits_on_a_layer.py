"""Fits of curves on a layer that is bonded to a rigid base, of known or of free thickness."""

from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.selection.verdict import Verdict
from pellicle_fit.simulated import simulation
from tests.plugins.fit.conftest import ends_of, holds

TRUE_MODULUS, TRUE_TENSION, THICK, RATIO, RADIUS = 3e3, 2e-3, 4e-6, 0.5, 5e-6
BEAD: dict[str, Any] = {"indenter": "sphere", "radius": RADIUS, "poissons_ratio": RATIO}


def curve(
    *,
    seed: int = 1,
    thickness: float = THICK,
    tension: float = TRUE_TENSION,
    radius: float = RADIUS,
) -> tuple[Array, Array]:
    """Return position and force of a bead on a layer, with 0.3 % noise."""
    depth = np.linspace(-0.8e-6, 1.2e-6, 250)
    bead = pl.indenter("sphere", radius=radius)
    assert isinstance(bead, pl.HasLayerForceCurve)
    length = 2 * tension / TRUE_MODULUS
    force = TRUE_MODULUS * bead.layer_force_curve(depth, length, thickness, RATIO).force
    noise = np.random.default_rng(seed).standard_normal(depth.size)
    return depth + 7e-6, force + 0.003 * force.max() * noise


def fitted(data: tuple[Array, Array], **options: Any) -> pl.Fit:
    """Return a fit without rivals."""
    return pl.fit(*data, rivals=(), **{**BEAD, **options})


@pytest.fixture(autouse=True)
def no_study(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no fit run a study."""
    monkeypatch.setattr(simulation, "run_study", None)


@pytest.mark.slow
def test_of_known_and_of_free_thickness() -> None:
    """Modulus and tension are recovered; a free thickness too, which leaves less of the modulus."""
    known, free = fitted(curve(), thickness=f"{THICK * 1e6} um"), fitted(curve(), thickness="free")
    for fit in (known, free):
        assert holds(fit.reduced_modulus, TRUE_MODULUS)
        assert holds(fit.tension, TRUE_TENSION)
        assert holds(fit.estimates()["thickness"], THICK)
    assert known.estimates()["thickness"].held
    assert not free.estimates()["thickness"].held
    wide, narrow = (np.ptp(ends_of(fit.reduced_modulus)) for fit in (free, known))
    assert wide > 1.5 * narrow


@pytest.mark.slow
def test_a_half_space_has_no_upper_bound_of_thickness() -> None:
    """A curve of a half-space gives a least thickness and leaves the upper end open."""
    fit = fitted(curve(thickness=1.0, tension=0.0), thickness="free", fix={"tension": 0})
    thickness = fit.estimates()["thickness"]
    assert thickness.high is None
    assert thickness.low is not None
    assert thickness.low > THICK


@pytest.mark.slow
def test_several_curves_share_the_thickness() -> None:
    """A pool of beads of two radii determines the thickness better than either."""
    radii = [RADIUS, 3 * RADIUS]
    curves = {str(n): curve(seed=n, radius=radius) for n, radius in enumerate(radii)}
    fit = pl.fit_pooled(curves, **{**BEAD, "radius": radii}, thickness="free", rivals=())
    thickness = fit.estimates()["thickness"]
    assert holds(thickness, THICK)
    assert holds(fit.reduced_modulus, TRUE_MODULUS)
    single = fitted(curves["0"], thickness="free").estimates()["thickness"]
    assert single.high is None or np.ptp(ends_of(thickness)) < np.ptp(ends_of(single))


@pytest.mark.slow
def test_a_contact_far_wider_than_the_layer_is_not_described() -> None:
    """Beyond the table of force curves the fit says so, and gives no number that counts."""
    fit = fitted(curve(thickness=1.0), thickness=THICK / 8)
    assert fit.verdict is Verdict.UNDESCRIBED
    assert "deeper than the force of this contact is known" in fit.comparison


@pytest.mark.parametrize("thickness", [THICK, 6e-6])
def test_the_polynomial_in_common_use_is_no_tension(thickness: float) -> None:
    """A curve made by it, which is up to 6 % below the exact one, is told as what it is."""
    depth = np.linspace(-0.4e-6, 0.8e-6, 300)
    deep = np.maximum(depth, 0.0)
    share = np.sqrt(RADIUS * deep) / thickness
    terms = 1 + 1.133 * share + 1.283 * share**2 + 0.769 * share**3 + 0.0975 * share**4
    force = 4 / 3 * TRUE_MODULUS * np.sqrt(RADIUS) * deep**1.5 * terms
    noise = 0.002 * force.max() * np.random.default_rng(3).standard_normal(depth.size)
    options = {**BEAD, "indenter": "paraboloid", "thickness": thickness}
    found = pl.fit(depth, force + noise, rivals=["drag"], **options)
    assert found.verdict is Verdict.OTHER
    assert found.answer.selected.types == {"dimitriadis"}
    assert holds(found.reduced_modulus, TRUE_MODULUS)
    alone = pl.fit(depth, force + noise, rivals=[], **options)
    assert alone.tension_needed
    assert not holds(alone.reduced_modulus, TRUE_MODULUS)
