"""Contact on glued layers, on both boundaries, against an integral equation and closed forms."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from tests.physics.punch_on_layers import punch_factor
from tests.plugins.kernels.elastic_stack import HalfSpace, Layer, stack_compliance
from tests.tables_of_runs import heights, paraboloid, step

YOUNGS, LENGTH = 1e4, 1e-3
GEL, STIFFER = Layer(YOUNGS, 0.5, LENGTH / 2), Layer(10 * YOUNGS, 0.3, LENGTH / 2)
STACKS: dict[str, tuple[list[Layer], HalfSpace | None]] = {
    "gel on a stiffer layer on a rigid base": ([GEL, Layer(20 * YOUNGS, 0.3, LENGTH / 2)], None),
    "gel on a stiffer layer on a half-space": (
        [GEL, Layer(20 * YOUNGS, 0.3, LENGTH / 2)],
        HalfSpace(3 * YOUNGS, 0.3),
    ),
    "stiffer layer on a gel on a rigid base": ([STIFFER, GEL], None),
    "stiffer layer on a soft one on a rigid base": (
        [STIFFER, Layer(YOUNGS, 0.45, LENGTH / 2)],
        None,
    ),
}


def kernel(layers: Sequence[Layer], substrate: HalfSpace | None = None) -> dict[str, Any]:
    """Return the table of layers from the surface down; the base is rigid if not given."""
    return {
        "type": "layered",
        "layers": [layer._asdict() for layer in layers],
        "substrate": "rigid" if substrate is None else substrate._asdict(),
    }


@pytest.mark.parametrize(
    ("poissons_ratio", "thickness", "expected"), [(0.3, 5.0, 1.206558), (0.5, 1.0, 3.618736)]
)
def test_the_reference_has_the_factors_of_bonded_layers(
    poissons_ratio: float, thickness: float, expected: float
) -> None:
    """κ of one layer on a rigid base is that of Hayes et al. (1972), recomputed to seven digits."""
    value = punch_factor([Layer(1.0, poissons_ratio, thickness)], None, 1.0)
    assert value == pytest.approx(expected, abs=5e-7)


def test_the_reference_on_a_half_space_is_a_half_space() -> None:
    """κ = 1 if layer and half-space are of the same solid."""
    layers = [Layer(1.0, 0.4, 0.3), Layer(1.0, 0.4, 0.2)]
    assert punch_factor(layers, HalfSpace(1.0, 0.4), 1.0) == pytest.approx(1, abs=1e-13)


@pytest.mark.parametrize("name", STACKS)
def test_flat_punch_on_two_layers(name: str) -> None:
    """κ in P = 2E* a δ κ, extrapolated over two grids, is that of the integral equation to 5e-4.

    The cells under a punch have an area that is not πa² by up to 1 %; P ~ aᵐ, with m from the
    integral equation, corrects for that. Measured: 1e-4.
    """
    layers, substrate = STACKS[name]
    depth, modulus = LENGTH / 100, layers[0].youngs_modulus / (1 - layers[0].poissons_ratio ** 2)
    expected = punch_factor(layers, substrate, LENGTH)
    wider = punch_factor(layers, substrate, 1.01 * LENGTH)
    power = 1 + np.log(wider / expected) / np.log(1.01)
    factors = []
    for points in (64, 128):
        pressed = step(
            grid={"points": points, "size": 2.3 * LENGTH},
            kernel=kernel(layers, substrate),
            indenter={"type": "flat_punch", "radius": LENGTH},
            loading={"depth": depth},
        )
        radius = float(pressed["contact_radius"])
        assert radius == pytest.approx(LENGTH, rel=0.01)
        force = float(pressed["force"]) * (LENGTH / radius) ** power
        factors.append(force / (2 * modulus * LENGTH * depth))
    assert abs(factors[1] / expected - 1) < 0.7 * abs(factors[0] / expected - 1) < 0.02
    assert 2 * factors[1] - factors[0] == pytest.approx(expected, rel=5e-4)


@pytest.mark.parametrize("name", STACKS)
def test_full_contact_of_a_sine(name: str, solver: str) -> None:
    """On a periodic boundary the amplitude of the pressure is that of the heights over G(q)."""
    layers, substrate = STACKS[name]
    points, waves, amplitude = 32, 2, LENGTH / 1000
    wave = amplitude * np.cos(2 * np.pi * waves * np.arange(points) / points)
    q = 2 * np.pi * waves / LENGTH
    expected = amplitude / stack_compliance(layers, substrate, q)
    pressed = step(
        solver,
        1e-10,
        grid={"points": [points, 1], "size": LENGTH, "boundary": "periodic"},
        kernel=kernel(layers, substrate),
        indenter=heights(wave[:, None]),
        loading={"mean_pressure": 2 * expected},
    )
    assert pressed["contact"].all()
    pressure = pressed["pressure"].values[:, 0]
    np.testing.assert_allclose(pressure / expected, 2 + wave / amplitude, atol=1e-7)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_the_number_of_applications_is_flat(boundary: str) -> None:
    """A bead on three layers takes at most 25 operator applications on 64² and on 256² cells."""
    layers = [
        Layer(100 * YOUNGS, 0.3, 0.01 * LENGTH),
        Layer(YOUNGS, 0.5, 0.1 * LENGTH),
        Layer(0.1 * YOUNGS, 0.45, 0.2 * LENGTH),
    ]
    for points in (64, 256):
        pressed = step(
            grid={"points": points, "size": LENGTH, "boundary": boundary},
            kernel=kernel(layers, HalfSpace(1e6 * YOUNGS, 0.2)),
            indenter=paraboloid(LENGTH),
            loading={"depth": 0.02 * LENGTH},
        )
        assert pressed["operator_applications"] <= 25
