"""The auxiliary functions of the tensed half-space."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from pellicle_axisymmetric.tension_kernel import auxiliary_g, primitive


@pytest.mark.parametrize("y", [1e-6, 0.3, 7.0, 49.0, 51.0, 1e4])
def test_matches_the_laplace_integrals(y: float) -> None:
    """The functions are g = ∫ t e^(−yt) / (1 + t²) and f = ∫ e^(−yt) / (1 + t²), over t ≥ 0."""

    # v = y t keeps both integrands of order one; ln v spreads their scales.
    def spread(power: int) -> float:
        def integrand(u: float) -> float:
            v = np.exp(u)
            return float((v / y) ** power * np.exp(-v) / (1 + (v / y) ** 2) * v / y)

        breaks = np.arange(-45.0, 6.1, 3.0)
        return math.fsum(
            quad(integrand, low, high, epsabs=0, epsrel=1e-12)[0] for low, high in pairwise(breaks)
        )

    argument = np.array([y])
    assert auxiliary_g(argument)[0] == pytest.approx(spread(1), rel=1e-10)
    assert np.pi / 2 - primitive(argument)[0] == pytest.approx(spread(0), rel=1e-10)


def test_small_argument_of_the_primitive() -> None:
    """∫₀^y g → y (1 − γ − ln y), with all digits kept."""
    y = np.array([1e-9])
    expected = y * (1 - np.euler_gamma - np.log(y))
    assert primitive(y) == pytest.approx(expected, rel=1e-8)


def test_both_are_continuous_where_the_series_take_over() -> None:
    """The two forms agree at the argument where they meet."""
    y = np.array([50 * (1 - 1e-15), 50.0])
    for function in (auxiliary_g, primitive):
        low, high = function(y)
        assert high == pytest.approx(low, rel=1e-12)
