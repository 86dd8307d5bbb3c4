"""Experiments on solids that relax, as users set them up: creep, relaxation, loops, plateaus."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pellicle as pl
from tests.physics.tables_of_runs import coated, half_space, paraboloid, relaxing, steps

MODULUS, SHARE, TIME = 1e4, 0.75, 2.0
JUMP = {"to": "1 um", "time": 0, "num": 1}


def punch(**loading: Any) -> Any:
    """Return the dataset of a flat punch on a half-space that relaxes."""
    return steps(
        tolerance=1e-10,
        grid={"points": 12, "size": "0.5 mm"},
        kernel=relaxing(half_space(MODULUS), SHARE, TIME),
        indenter={"type": "flat_punch", "radius": "0.2 mm"},
        loading=loading,
    )


@pytest.mark.parametrize("spring", [0.5, 20.0])
def test_cantilever_creeps_and_relaxes(spring: float) -> None:
    """A base that is held: F falls from F₀ to F∞ at the rate (k + K∞)/((k + K₀)τ), to 0.1 %."""
    jump, hold = {**JUMP, "to": "2 um"}, {"hold": "8 s", "num": 24}
    data = punch(base_displacement=[jump, hold], spring_constant=spring)
    at_once = float(data["force"][0] / data["depth"][0])
    relaxed = (1 - SHARE) * at_once
    first, last = (spring * 2e-6 * k / (spring + k) for k in (at_once, relaxed))
    rate = (spring + relaxed) / ((spring + at_once) * TIME)
    expected = last + (first - last) * np.exp(-rate * data["time"].values)
    np.testing.assert_allclose(data["force"], expected, rtol=1e-3)


def test_triangle_is_a_loop() -> None:
    """Pressed in and drawn back, F = K₀ ∫ E(t − t′)/E₀ dδ until the contact opens; then 0.

    The exact force falls through 0 between the last step in contact and the next.
    """
    number, speed = 10, 1e-6
    legs = [{"to": "1 um", "time": "1 s", "num": number}, {"to": 0, "time": "1 s", "num": number}]
    data = punch(depth=legs)
    t, force = data["time"].values, data["force"].values
    at_once = float(punch(depth="1 um", time=0)["force"].item()) / 1e-6

    def pressed(t: Any) -> Any:
        t = np.maximum(t, 0.0)
        return (1 - SHARE) * t - SHARE * TIME * np.expm1(-t / TIME)

    expected = at_once * speed * (pressed(t) - 2 * pressed(t - 1))
    open_ = expected < 0
    assert 0 < open_.sum() < number
    np.testing.assert_allclose(force, np.where(open_, 0.0, expected), rtol=1e-8)
    work = np.trapezoid(np.append(0.0, force), np.append(0.0, data["depth"].values))
    assert work > 0.1 * force.max() * 1e-6


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:step 1 and 3 more. converged; the contact area misses")
@pytest.mark.parametrize(("boundary", "size"), [("periodic", 4e-4), ("free", 4e-4)])
def test_plateau_is_tension_alone(boundary: str, size: float) -> None:
    """A liquid at a prescribed contact radius keeps F = 2πτ₀a²/R, at first order in the cell size.

    Only the curved surface in contact carries a pressure, 2τ₀/R, met to 1 % at the centre. On a
    periodic grid the mean pressure carries the period in addition: both are larger by
    1/(1 − πa²/L²). Area is counted in cells, so F misses by up to 0.8 Δ/a.
    """
    tension, radius, contact, points = 0.05, 1e-3, 8e-5, 64
    jump = {"to": contact, "time": 0, "num": 1}
    run = {
        "grid": {"points": points, "size": size, "boundary": boundary},
        "kernel": coated(relaxing(half_space(MODULUS), 1.0, 1.0), tension),
        "indenter": paraboloid(radius),
        "loading": {"contact_radius": [jump, {"hold": "100 s", "num": 3}]},
    }
    with pytest.warns(UserWarning, match="makes the solid a liquid"):
        result = pl.run(run, progress=False)
    assert result.converged
    last = result.dataset.isel(step=-1)
    area = last["contact_area"].item()
    period = 1 - area / size**2 if boundary == "periodic" else 1.0
    pressure = 2 * tension / radius / period
    centre = last["pressure"].values[points // 2, points // 2]
    assert centre == pytest.approx(pressure, rel=0.01)
    force = result.dataset["force"].values
    assert force[0] > 4 * pressure * area
    assert force[-1] == pytest.approx(force[-2], rel=0.01)
    assert force[-1] == pytest.approx(pressure * area, rel=0.8 * size / points / contact)
