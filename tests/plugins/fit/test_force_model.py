"""Any force model can be fitted: a stranger's, with parameters that the framework does not know."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pellicle_fit.models.force_model import ForceModel, ModelForce
from pellicle_fit.parameters import CONTACT_POINT, OFFSET, SLOPE, Parameter, Values
from pellicle_fit.statistics.chi_squared import best_minimum
from pellicle_fit.statistics.initial_guess import initial_guesses
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.pooled_likelihood import Pool
from pellicle_fit.statistics.profile import confidence_interval

Array = NDArray[np.float64]
STIFFNESS = Parameter("stiffness", "N/m^1.5", logarithmic=True, shared=True)
SPRING = Parameter("spring", "N/m", minimum=0.0)


class Sprung:
    """Hertz's force and that of a spring beside it."""

    parameters = (STIFFNESS, SPRING)
    depth_limit = np.inf
    accuracy = 1e-9
    coarse = None
    on_base = False

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives."""
        inside = np.maximum(depth, 0.0)
        stiffness, touching = values[STIFFNESS], depth > 0
        return ModelForce(
            stiffness * inside**1.5 + values[SPRING] * inside,
            1.5 * stiffness * inside**0.5 + values[SPRING] * touching,
            {STIFFNESS: inside**1.5, SPRING: inside},
        )

    def guesses(self, span: float) -> Iterator[Values]:
        """Yield a unit stiffness without a spring and with two."""
        for share in (0.0, 0.1, 1.0):
            yield {STIFFNESS: 1.0, SPRING: share * span**0.5}

    def scaled(self, values: Values, factor: float) -> Values:
        """Return both times a factor."""
        return {parameter: factor * value for parameter, value in values.items()}

    def description(self) -> dict[str, Any]:
        """Return the name."""
        return {"indenter": {"type": "sprung"}}


def likelihood(spring: float, seed: int) -> Likelihood:
    """Return the likelihood of a curve of stiffness 3 (in units of the test)."""
    model: ForceModel = Sprung()
    position = np.linspace(-0.5, 1.0, 200)
    truth = {STIFFNESS: 3.0, SPRING: spring}
    noise = 0.02 * np.random.default_rng(seed).standard_normal(position.size)
    force = model.force(position - 0.2, truth).force + noise
    return Likelihood(position, force, model, 0.02, (CONTACT_POINT, STIFFNESS, SPRING))


def test_own_parameters() -> None:
    """Guesses, minimum, bounds and intervals are those of the model's own parameters."""
    curve = likelihood(1.0, seed=1)
    best = best_minimum(curve, initial_guesses(curve, {OFFSET: 0.0, SLOPE: 0.0}))
    assert STIFFNESS.value(best.parameters[STIFFNESS]) == pytest.approx(3.0, rel=0.1)
    bound = curve.deviations(best.parameters)[SPRING]
    assert best.parameters[SPRING] == pytest.approx(1.0, abs=4 * bound)
    low, high = confidence_interval(curve, best, SPRING, 3.84)
    assert low is not None
    assert high is not None
    assert high - low == pytest.approx(2 * 1.96 * bound, rel=0.1)


def test_open_at_the_minimum() -> None:
    """Without a spring the interval is open below, as that of a tension is."""
    curve = likelihood(0.0, seed=2)
    best = best_minimum(curve, initial_guesses(curve, {OFFSET: 0.0, SLOPE: 0.0}))
    low, high = confidence_interval(curve, best, SPRING, 3.84)
    assert low is None
    assert high is not None


def test_shared_as_the_parameters_say() -> None:
    """A pool shares the stiffness; springs are of each curve."""
    pool = Pool.of([likelihood(0.5, seed=3), likelihood(2.0, seed=4)])
    assert pool.shared == [STIFFNESS]
    start = {CONTACT_POINT: 0.2, STIFFNESS: 1.0, SPRING: 0.2, OFFSET: 0.0, SLOPE: 0.0}
    best = pool.minimise(pool.joined([start, start])).parameters
    assert best[SPRING] == pytest.approx(0.5, abs=0.3)
    assert best[SPRING.of_curve(1)] == pytest.approx(2.0, abs=0.3)
