"""Auxiliary functions of tensed half-spaces against high-precision values and identities."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

from pellicle_axisymmetric.tension_kernel import auxiliary_g, primitive
from pellicle_plugins.kernels.struve import struve_minus_bessel, struve_minus_bessel_primitive

Function = Callable[[NDArray[np.float64]], NDArray[np.float64]]

DATA = Path(__file__).resolve().parents[2] / "data" / "struve.csv"


@pytest.fixture(scope="module")
def reference() -> NDArray[np.float64]:
    """Columns z, difference and primitive of the reference table."""
    lines = [line for line in DATA.read_text().splitlines() if not line.startswith("#")]
    return np.loadtxt(lines[1:], delimiter=",").T


def test_values_of_high_precision(reference: NDArray[np.float64]) -> None:
    """H0 - Y0 and its primitive are right to 5e-14 over 24 decades."""
    z, difference, primitive = reference
    np.testing.assert_allclose(struve_minus_bessel(z), difference, rtol=5e-14)
    np.testing.assert_allclose(struve_minus_bessel_primitive(z), primitive, rtol=5e-14)


def test_primitive_is_the_integral_of_t_times_the_difference() -> None:
    """Gauss integrals of t (H0 - Y0) between random limits equal differences of the primitive."""
    rng = np.random.default_rng(11)
    lower = 10.0 ** rng.uniform(-3, 3, 200)
    upper = lower * rng.uniform(1.2, 1.8, 200)
    x, weights = np.polynomial.legendre.leggauss(24)
    t = (upper + lower)[:, None] / 2 + (upper - lower)[:, None] / 2 * x
    integral = (t * struve_minus_bessel(t)) @ weights * (upper - lower) / 2
    rise = struve_minus_bessel_primitive(upper) - struve_minus_bessel_primitive(lower)
    np.testing.assert_allclose(rise, integral, rtol=1e-12)


def test_primitive_vanishes_at_zero() -> None:
    """The primitive starts from exactly zero."""
    assert struve_minus_bessel_primitive(np.zeros(3)).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("function", [struve_minus_bessel, struve_minus_bessel_primitive])
def test_regimes_meet_without_a_jump(function: Function) -> None:
    """Neighbouring doubles on both sides of the border give the same value to rounding."""
    below, above = function(np.array([np.nextafter(4.0, 0.0), 4.0]))
    assert abs(above / below - 1) < 3e-14


@pytest.mark.parametrize("function", [struve_minus_bessel, struve_minus_bessel_primitive])
def test_large_mixed_arrays_equal_piecewise_evaluation(function: Function) -> None:
    """A shuffled array of several blocks gives what short arrays of one regime give."""
    rng = np.random.default_rng(12)
    z = 10.0 ** rng.uniform(-2, 3, (31, 700))
    values = function(z)
    assert values.shape == z.shape
    picks = rng.integers(0, z.size, 40)
    single = [function(z.flat[k : k + 1])[0] for k in picks]
    np.testing.assert_allclose(values.flat[picks], single, rtol=1e-14)


@pytest.mark.parametrize("function", [struve_minus_bessel, struve_minus_bessel_primitive])
def test_shapes_are_kept(function: Function) -> None:
    """Empty, zero-dimensional and strided arguments keep their shape."""
    assert function(np.empty((0, 3))).shape == (0, 3)
    assert function(np.array(2.0)).shape == ()
    z = np.linspace(1, 9, 24).reshape(4, 6)
    np.testing.assert_allclose(function(z.T[::2]), function(z).T[::2], rtol=1e-14)


def test_extreme_arguments_raise_no_floating_point_signal() -> None:
    """From 1e-300 to 1e300 nothing overflows, divides by zero or is invalid."""
    z = 10.0 ** np.arange(-300.0, 301.0, 10.0)
    with np.errstate(all="raise", under="ignore"):
        difference = struve_minus_bessel(z)
        primitive = struve_minus_bessel_primitive(np.append(0.0, z))
    assert (difference > 0).all()
    assert (np.diff(difference) < 0).all()
    assert (np.diff(primitive[primitive > 0]) > 0).all()


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
