"""A curve that begins in contact: its first touch lies before the first row."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import pellicle as pl
from pellicle_fit.selection.verdict import Verdict

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
