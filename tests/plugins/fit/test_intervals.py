"""Intervals of the profile likelihood, on models whose intervals are known in closed form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
import pytest

from pellicle.arrays import Array
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, OFFSET, Coordinates, Parameter
from pellicle_fit.statistics.chi_squared import ChiSquared, Minimum, Range
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.profile import (
    ImprovedMinimum,
    chi_squared_threshold,
    confidence_interval,
)

pytestmark = pytest.mark.usefixtures("no_rivals")

Value = TypeVar("Value")
BEST = {CONTACT_POINT: 2.0, OFFSET: -1.0, MODULUS: 3.0}


@dataclass(frozen=True)
class Linear(ChiSquared):
    """Residuals J (x − x₀), so that χ² is a quadric about x₀."""

    design: Array
    free: tuple[Parameter, ...] = (CONTACT_POINT, OFFSET, MODULUS)
    limit: float = 1e3

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters of the model."""
        return tuple(BEST)

    @cached_property
    def ranges(self) -> Mapping[Parameter, Range]:
        """Wide limits, or ``limit``."""
        return dict.fromkeys(BEST, Range(1.0, -self.limit, self.limit))

    members: tuple[Likelihood, ...] = ()
    """No curve: there is only a quadric."""

    def with_members(self, members: Sequence[Likelihood]) -> Linear:
        """Return the same quadric."""
        return self

    def curves(self, parameters: Coordinates) -> list[tuple[Likelihood, Coordinates]]:
        """Return no curve."""
        return []

    def joined(self, parts: Sequence[Mapping[Parameter, Value]]) -> dict[Parameter, Value]:
        """Return nothing, since no curve has anything."""
        return {}

    def linearised(self, parameters: Coordinates) -> tuple[Array, Array]:
        """Return residuals and the design matrix."""
        change = np.array([parameters[p] - BEST[p] for p in self.parameters])
        return self.design @ change, self.design

    @property
    def accuracy(self) -> float:
        """The model is exact."""
        return 0.0


def correlated(seed: int = 1) -> Array:
    """Return a design matrix whose columns are far from orthogonal."""
    random = np.random.default_rng(seed)
    return np.asarray(random.standard_normal((40, 3)) @ [[1, 0.9, 0], [0, 0.3, 0.8], [0, 0, 2]])


@pytest.mark.parametrize("parameter", BEST)
@pytest.mark.parametrize("threshold", [1.0, 3.84])
def test_of_a_linear_model_the_interval_is_symmetric(
    parameter: Parameter, threshold: float
) -> None:
    """It reaches √threshold standard deviations to both sides, others refitted: (JᵀJ)⁻¹ has them.

    With the others fixed the deviations would be less than half as large.
    """
    design = correlated()
    column = list(BEST).index(parameter)
    deviation = np.sqrt(np.linalg.inv(design.T @ design)[column, column])
    ends = confidence_interval(Linear(design), Minimum(BEST, 0.0), parameter, threshold)
    reach = np.sqrt(threshold) * deviation
    assert ends == pytest.approx(
        (BEST[parameter] - reach, BEST[parameter] + reach), abs=4e-3 * reach
    )


def test_an_end_beyond_the_limit_is_open() -> None:
    """What is not reached within the limits of a parameter is None, on the side where it is so."""
    design = correlated()
    deviation = np.sqrt(np.linalg.inv(design.T @ design)[0, 0])
    narrow = Linear(design, limit=2.0 + deviation)
    low, high = confidence_interval(narrow, Minimum(BEST, 0.0), CONTACT_POINT, 3.84)
    assert low == pytest.approx(2.0 - np.sqrt(3.84) * deviation, rel=4e-3)
    assert high is None


def test_a_start_beside_the_minimum_is_told() -> None:
    """A profile that falls below the minimum that it starts from gives the better one."""
    linear = Linear(correlated())
    beside = BEST | {OFFSET: -0.5}
    start = Minimum(beside, linear.chi_squared(beside))
    with pytest.raises(ImprovedMinimum) as improved:
        confidence_interval(linear, start, CONTACT_POINT, 3.84)
    assert improved.value.minimum.chi_squared < start.chi_squared


@pytest.mark.parametrize(
    ("freedom", "quantile"), [(1, 12.7062047), (10, 2.2281389), (np.inf, 1.9599640)]
)
def test_threshold_is_the_square_of_student_s_quantile(freedom: float, quantile: float) -> None:
    """Two-sided 95 % quantiles of any table of the t distribution."""
    assert chi_squared_threshold(freedom) == pytest.approx(quantile**2, rel=1e-7)
