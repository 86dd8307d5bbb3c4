"""Noise whose power falls as f^(−2d), and curves that begin in contact, without a baseline."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pellicle as pl
from pellicle_fit.estimation.long_memory import differenced, exponent_of
from pellicle_fit.estimation.noise import Flaw
from pellicle_fit.selection.verdict import Verdict


def test_differences_of_order_one_and_their_composition() -> None:
    """(1 − B)^1 takes differences of neighbours, and two powers follow each other."""
    values = np.random.default_rng(1).standard_normal((50, 2))
    assert differenced(values, 1.0)[1:] == pytest.approx(np.diff(values, axis=0))
    assert differenced(values, 0.0) == pytest.approx(values)
    twice = differenced(differenced(values, 0.3), 0.7)
    assert twice == pytest.approx(differenced(values, 1.0))


@pytest.mark.parametrize("exponent", [0.2, 0.5, 0.8])
def test_exponent_of_fractional_noise(exponent: float) -> None:
    """The exponent of noise is recovered; its standard error is 0.78 / √n, here 0.008."""
    random = np.random.default_rng(2)
    noise = differenced(random.standard_normal((10_000, 1)), -exponent)[:, 0]
    assert exponent_of(noise) == pytest.approx(exponent, abs=0.03)


@pytest.mark.parametrize("size", [1e-12, 1.0, 1e6])
def test_other_noise_has_no_exponent(size: float) -> None:
    """Independent noise, a moving average, hum, few rows and no noise at all have none."""
    random = np.random.default_rng(3)
    white = size * random.standard_normal(300)
    assert exponent_of(white) == 0
    assert exponent_of(np.convolve(white, np.ones(15), "valid")) == 0
    assert exponent_of(white + 2 * size * np.sin(np.arange(300) / 3)) == 0
    assert exponent_of(white[:50].cumsum()) == 0
    assert exponent_of(np.zeros(300)) == 0


def test_a_bent_baseline_is_not_the_noise_of_the_contact() -> None:
    """A wandering baseline, and steps in contact: differences left a modulus 170 times too high."""
    random = np.random.default_rng(0)
    depth, radius, modulus = np.linspace(-0.4e-6, 0.4e-6, 400), 5e-6, 6e3
    top = 4 / 3 * modulus * np.sqrt(radius) * 0.4e-6**1.5
    share = np.maximum(depth / 0.4e-6, 0.0)
    steps = 0.15 * share * np.sign(np.sin(120 * depth / 0.4e-6))
    wander = 1e-3 * random.standard_normal(400).cumsum()
    fit = pl.fit(
        depth,
        top * (share**1.5 + steps + wander),
        indenter="paraboloid",
        radius=radius,
        baseline="offset",
        model=(),
        rivals=(),
    )
    assert fit.reduced_modulus.value == pytest.approx(modulus, rel=0.1)
    assert Flaw.MISFIT in fit.answer.judgements[0].flaws


MODULUS, RADIUS, DEEPEST, TOUCH = 2e3, 5e-6, 1e-6, 3e-6
SPRING = 0.02


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    share=st.floats(0.2, 0.85),
    segment=st.sampled_from(["approach", "retract", "both"]),
    cantilever=st.booleans(),
    seed=st.integers(0, 99),
)
def test_a_curve_that_begins_in_contact(
    share: float, segment: str, cantilever: bool, seed: int
) -> None:
    """From 0.2 to 0.85 of the depth on, E* is held, and there is no sign of a tension."""
    depth = np.linspace(share, 1.0, 400) * DEEPEST
    if segment != "approach":
        depth = np.append(depth, depth[::-1]) if segment == "both" else depth[::-1]
    force = 4 / 3 * MODULUS * np.sqrt(RADIUS) * depth**1.5
    noise = 0.003 * force.max() * np.random.default_rng(seed).standard_normal(depth.size)
    told, place = force + noise, depth + TOUCH
    options: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS, "segment": segment}
    if cantilever:
        options["spring_constant"] = SPRING
        place = place - noise / SPRING
    time = np.arange(depth.size) / depth.size
    fit = pl.fit(place, told, time=time, rivals=[], **options)
    # An interval has 95 %.
    low, high = fit.reduced_modulus.low, fit.reduced_modulus.high
    assert low is not None
    assert high is not None
    assert low - (high - low) / 2 < MODULUS < high + (high - low) / 2
    assert fit.verdict is Verdict.NO_SIGN
