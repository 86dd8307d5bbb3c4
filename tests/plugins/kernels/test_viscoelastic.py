"""Solids that relax: their branches, what a skin on them makes of them, and what is refused."""

from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components import Branch
from pellicle.contact.time_step import History, TimeStep
from pellicle.surface import mean_compliance, operator_of
from pellicle.surface.from_kernel import closed_form_of
from pellicle_plugins.kernels.power_law import power_law_series

HALF_SPACE = {"type": "half_space", "reduced_modulus": "10 kPa"}
LAYER = {"type": "bonded_layer", "youngs_modulus": 9e3, "poissons_ratio": 0.3, "thickness": 1e-4}
RELAXATION = [{"fraction": 0.5, "time": "1 s"}, {"fraction": 0.3, "time": "1 min"}]
Q = np.geomspace(1.0, 1e9, 30)


def viscoelastic(**fields: Any) -> Any:
    """Return a solid that relaxes."""
    law = {} if "power_law" in fields else {"relaxation": RELAXATION}
    return pl.kernel("viscoelastic", **{"solid": HALF_SPACE, **law, **fields})


def modulus(branches: tuple[Branch, ...], t: Array) -> Array:
    """Return E(t) over E(0)."""
    return np.asarray(1 - sum(b.share * -np.expm1(-t / b.time_at(None)) for b in branches))


def test_solid_is_the_instantaneous_response() -> None:
    """Compliances are those of the solid, the branches those that are given, times in seconds."""
    for table in (HALF_SPACE, LAYER):
        kernel = viscoelastic(solid=table)
        solid = kernel.solid
        np.testing.assert_array_equal(kernel.compliance(Q), solid.compliance(Q))
        assert mean_compliance(kernel) == mean_compliance(solid)
    assert viscoelastic().branches() == (Branch(0.5, 1.0), Branch(0.3, 60.0))
    assert viscoelastic().without_skin() == viscoelastic()


def test_scaled_half_space_keeps_its_closed_form() -> None:
    """On a free grid a solid γ times as stiff is the half-space of that modulus, to rounding."""
    scaled = viscoelastic().scaled(0.3)
    assert closed_form_of(scaled)
    grid = pl.Grid(points=16, size="1 mm", boundary="free")
    pressure = np.random.default_rng(0).random(grid.shape)
    expected = pl.displacement(
        pressure, kernel=pl.kernel("half_space", reduced_modulus=3e3), grid=grid
    )
    np.testing.assert_allclose(
        pl.displacement(pressure, kernel=scaled, grid=grid), expected, rtol=1e-13
    )


def test_scaled_layer_has_no_closed_form() -> None:
    """A kernel without a Green's function in closed form does not get one by being scaled."""
    solid = viscoelastic(solid=LAYER)
    scaled = solid.scaled(0.3)
    assert not closed_form_of(scaled)
    np.testing.assert_allclose(0.3 * scaled.compliance(Q), solid.compliance(Q), rtol=1e-13)


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e6])
@pytest.mark.parametrize("exponent", [0.1, 0.2, 0.3, 0.5, 0.99])
def test_power_law_is_the_solid_at_its_time(exponent: float, scale: float) -> None:
    """Within the span E(t) is that of the solid times (t/t₀)^(−α), to the error that is stated."""
    law = {"exponent": exponent, "time": scale, "shortest": 1e-4 * scale, "longest": 1e2 * scale}
    kernel = viscoelastic(power_law=law)
    t = scale * np.geomspace(1e-4, 1e2, 1999)
    instantaneous = kernel.solid.compliance(Q[:1]) / kernel.compliance(Q[:1])
    error = instantaneous * modulus(kernel.branches(), t) / (t / scale) ** -exponent - 1
    stated = kernel.power_law.series.error
    assert 0.9 * stated < np.abs(error).max() < 1.01 * stated
    assert stated < 3e-3
    np.testing.assert_allclose(kernel.scaled(0.5).compliance(Q), 2 * kernel.compliance(Q), 1e-13)


@pytest.mark.parametrize(
    ("exponent", "bound"), [(0.1, 6e-5), (0.2, 1.5e-4), (0.5, 6e-4), (0.99, 3e-3)]
)
def test_error_of_a_power_law_hardly_depends_on_its_span(exponent: float, bound: float) -> None:
    """Over 1 to 9 decades it is as the docstring states, with two branches per decade."""
    for decades in (1, 3, 6, 9):
        series = power_law_series(exponent, 10.0**decades)
        assert series.error < bound
        assert len(series.weights) <= 2 * decades + 3
        assert min(series.weights) > 0
        assert series.constant >= 0


def test_power_law_spans_six_decades_unless_given() -> None:
    """The span reaches a thousand times each way, and each end may be given alone."""
    law = viscoelastic(power_law={"exponent": 0.2, "time": "2 s"}).power_law
    assert law.span == pytest.approx((2e-3, 2e3))
    law = viscoelastic(power_law={"exponent": 0.2, "time": "2 s", "longest": "1 h"}).power_law
    assert law.span == pytest.approx((2e-3, 3600.0))


def coated(**fields: Any) -> Any:
    """Return a tensed skin on a solid that relaxes."""
    return pl.kernel("coated", tension="50 mN/m", substrate=viscoelastic(**fields))


@pytest.mark.parametrize("table", [HALF_SPACE, LAYER])
def test_skin_on_a_solid_that_relaxes_is_elastic(table: dict[str, Any]) -> None:
    """The branches are those of the substrate, and scaling it leaves the tension as it is."""
    kernel = coated(solid=table)
    assert kernel.branches() == viscoelastic().branches()
    assert kernel.without_skin() == kernel.substrate
    stiffness = 0.05 * Q**2 + 0.3 / kernel.substrate.compliance(Q)
    np.testing.assert_allclose(1 / kernel.scaled(0.3).compliance(Q), stiffness, rtol=1e-12)
    twice: Any = pl.kernel("coated", tension="20 mN/m", substrate=kernel)
    assert twice.without_skin() == kernel.substrate
    np.testing.assert_allclose(
        1 / twice.scaled(0.3).compliance(Q), stiffness + 0.02 * Q**2, rtol=1e-12
    )
    elastic: Any = pl.kernel("coated", tension="50 mN/m", substrate=table)
    assert elastic.branches() == ()


def test_full_contact_under_a_tensed_skin_is_exact_in_time() -> None:
    """A sine pressed in at constant speed: p = (q/2) E∗du/dt + τ₀ q² u, through the operators."""
    kernel, grid = coated(), pl.Grid(points=[16, 8], size="0.1 mm", boundary="periodic")
    x, y = grid.coordinates()
    wave = np.cos(2 * np.pi * x / grid.size[0]) + 0 * y
    q = 2 * np.pi / grid.size[0]
    branches, speed = kernel.branches(), 1e-7
    memory, before = History.at_rest(branches, grid.shape), 0.0
    for t in (0.0, 0.3, 0.4, 2.0, 90.0):
        step = TimeStep.of(branches, t - before)
        scaled = kernel.scaled(float(step.stiffness))
        solid = kernel.without_skin().compliance(np.array([q])).item()
        left = -operator_of(scaled, grid)(memory.residual(step)) / solid
        # One wave, so that the pressure follows from its compliance.
        stiffness = 1 / scaled.compliance(np.array([q])).item()
        pressure = (speed * t * wave - left) * stiffness
        memory, before = memory.after(step, pressure / stiffness + left), t
        integral = 0.2 * t + sum(g * tau * -np.expm1(-t / tau) for g, tau in branches)
        expected = speed * (5e3 * q * integral + 0.05 * q**2 * t) * wave
        np.testing.assert_allclose(pressure, expected, rtol=0, atol=1e-12 * speed * 1e9)


@pytest.mark.parametrize("fractions", [(0.7, 0.3), (0.1,) * 10])
def test_liquid_is_allowed(fractions: tuple[float, ...]) -> None:
    """Fractions that sum to 1 in decimals are a liquid."""
    kernel = viscoelastic(relaxation=[{"fraction": f, "time": 1} for f in fractions])
    assert TimeStep.of(kernel.branches(), 1e9).stiffness == pytest.approx(1e-9)
