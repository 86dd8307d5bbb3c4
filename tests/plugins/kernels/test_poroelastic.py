"""The half-space that drains: symbol against Biot's equations in depth, series and fields."""

import math
from functools import partial
from typing import Any, Literal

import numpy as np
import pytest
from scipy.integrate import quad

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components import Branch, OfWave, have_equal_branches
from pellicle.components.rules import Case
from pellicle.components.rules.kernels import branches_have_shares_and_times
from pellicle.contact.time_step import permanent_share
from pellicle_plugins.kernels.poroelastic import Poroelastic, drained_part, draining_series

SURFACES = ["open", "sealed"]


def gel(**fields: Any) -> Any:
    """Return a solid with G = 3 Pa, ν = 0.3 and D = 0.5 m²/s."""
    given = {"shear_modulus": 3.0, "poissons_ratio": 0.3, "diffusivity": 0.5}
    return pl.kernel("poroelastic", **{**given, **fields})


def drained_share(surface: str, m_over_q: float) -> float:
    """Return the Laplace transform of ψ times s: q/(q + m), or q²/(m (q + m))."""
    return 1 / (1 + m_over_q) / (m_over_q if surface == "sealed" else 1)


def biot(q: float, m: float, poissons_ratio: float, surface: str) -> tuple[float, float]:
    """Return stiffness over G and ∫e dz of a wave q by collocation in depth, for s = D(m² − q²).

    Unknown are U, W and p of u_x = U sin qx, u_z = W cos qx and p cos qx, at Chebyshev points of
    three layers down to 30/q, with G = 1. W is 1 at the surface.
    """
    number, edges = 26, np.concatenate([[0.0], np.geomspace(2 / m, 30 / q, 5)])
    k, theta = np.arange(number), np.pi * np.arange(number) / (number - 1)
    x = np.cos(theta)[::-1]
    scale = np.where((k == 0) | (k == number - 1), 2.0, 1.0) * (-1.0) ** k
    apart = x[:, None] - x + np.eye(number)
    first = np.outer(scale, 1 / scale) / apart
    first -= np.diag(first.sum(axis=1))
    layers, one = len(edges) - 1, np.eye(number)
    lame = 1 / (1 - 2 * poissons_ratio)
    flow = (m**2 - q**2) * 2 * (1 - poissons_ratio) * lame
    size = 3 * number
    matrix, right = np.zeros((layers * size, layers * size)), np.zeros(layers * size)
    derivatives = []
    for layer in range(layers):
        d = first * 2 / (edges[layer + 1] - edges[layer])
        derivatives.append(d)
        laplace = d @ d - q**2 * one
        rows = [
            [laplace - lame * q**2 * one, -lame * q * d, q * one],
            [lame * q * d, laplace + lame * d @ d, -d],
            [flow * q * one, flow * d, -laplace],
        ]
        at = slice(layer * size, (layer + 1) * size)
        matrix[at, at] = np.block(rows)
        # The ends of each equation give way to the conditions there.
        for n in range(3):
            for end in (0, number - 1):
                matrix[layer * size + n * number + end] = 0

    def unit(layer: int, n: int, end: int, derivative: bool = False) -> Array:
        row = np.zeros(layers * size)
        at = layer * size + n * number
        row[at : at + number] = derivatives[layer][end] if derivative else one[end]
        return row

    last = number - 1
    surface_rows = [
        unit(0, 0, 0, True) - q * unit(0, 1, 0),
        unit(0, 1, 0),
        unit(0, 2, 0, surface == "sealed"),
    ]
    for n in range(3):
        matrix[n * number] = surface_rows[n]
        matrix[(layers - 1) * size + n * number + last] = unit(layers - 1, n, last)
    right[number] = 1.0
    for layer in range(layers - 1):
        for n in range(3):
            jump = unit(layer, n, last) - unit(layer + 1, n, 0)
            slope = unit(layer, n, last, True) - unit(layer + 1, n, 0, True)
            matrix[layer * size + n * number + last] = jump
            matrix[(layer + 1) * size + n * number] = slope
    scales = np.abs(matrix).max(axis=1)
    found = np.linalg.solve(matrix / scales[:, None], right / scales)
    u, w, p = found[:size].reshape(3, number)
    dilation = q * u + derivatives[0] @ w
    stress = 2 * (derivatives[0] @ w)[0] + 2 * poissons_ratio * lame * dilation[0] - p[0]
    total = 0.0
    for layer in range(layers):
        u, w, _ = found[layer * size : (layer + 1) * size].reshape(3, number)
        total += q * _integral(u, edges[layer : layer + 2]) + w[last] - w[0]
    return -float(stress), float(total)


def _integral(values: Array, edges: Array) -> float:
    """Return the integral by Clenshaw & Curtis of values at Chebyshev points, ascending."""
    n = values.size - 1
    coefficients = np.polynomial.chebyshev.chebfit(
        np.cos(np.pi * np.arange(n + 1) / n)[::-1], values, n
    )
    even = coefficients[::2]
    return float((even * 2 / (1 - np.arange(0, n + 1, 2) ** 2)).sum() * np.ptp(edges) / 2)


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize(("q", "m"), [(1.0, 1.1), (0.7, 2.0), (2.0, 20.0)])
@pytest.mark.parametrize("poissons_ratio", [0.0, 0.3])
def test_stiffness_is_that_of_biots_equations(
    q: float, m: float, poissons_ratio: float, surface: str
) -> None:
    """To 1e-8, and so is the liquid that has left, which is none below a sealed surface's wave."""
    eta = (1 - poissons_ratio) / (1 - 2 * poissons_ratio)
    stiffness, dilation = biot(q, m, poissons_ratio, surface)
    assert stiffness == pytest.approx(2 * q * (1 - drained_share(surface, m / q) / eta), rel=1e-8)
    left = q / (eta * m) * (q / m if surface == "sealed" else 1)
    assert -dilation == pytest.approx(left, rel=1e-7)


@pytest.mark.parametrize("surface", SURFACES)
def test_psi_is_the_transform_of_the_stiffness(surface: Any) -> None:
    """σ ∫ ψ(θ) e^(−σθ) dθ is the share of the stiffness that has drained, with m/q = √(1 + σ)."""
    psi: Any = partial(drained_part, surface)
    for sigma in (1e-3, 0.3, 2.0, 100.0):
        value, _ = quad(lambda y, s=sigma: psi(y**2 / s) * 2 * y * math.exp(-(y**2)), 0, 8)
        assert value == pytest.approx(drained_share(surface, math.sqrt(1 + sigma)), rel=1e-8)


@pytest.mark.parametrize(("surface", "error"), [("open", 5e-5), ("sealed", 3e-6)])
def test_series(surface: Any, error: float) -> None:
    """The errors that are told."""
    shares, rates = map(np.array, draining_series(surface))
    assert shares.sum() == pytest.approx(0.5, rel=1e-12)
    assert rates.min() > 1
    for span, most in (((1e-6, 1e3), error), ((1e-12, 1e-6), 3e-4)):
        theta = np.geomspace(*span, 2000)
        series = -np.expm1(-theta[:, None] * rates) @ shares
        assert np.abs(series - drained_part(surface, theta)).max() < most


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("poissons_ratio", [-0.5, 0.0, 0.3, 0.49])
def test_limits_are_undrained_and_drained(surface: str, poissons_ratio: float) -> None:
    """At once ν is ½ and E* = 4G, in the end E* = 2G/(1 − ν)."""
    kernel, q = gel(surface=surface, poissons_ratio=poissons_ratio), np.array([0.1, 7.0])
    np.testing.assert_allclose(kernel.compliance(q), 2 / (4 * 3.0 * q))
    drained = kernel.scaled(permanent_share(kernel.branches()))
    np.testing.assert_allclose(drained.compliance(q), 2 * (1 - poissons_ratio) / (2 * 3.0 * q))


def test_constants_in_other_words() -> None:
    """E = 2G(1 + ν), and D = 2Gηk/μ."""
    eta = 0.7 / 0.4
    other = gel(
        shear_modulus=None,
        youngs_modulus=3.0 * 2 * 1.3,
        diffusivity=None,
        permeability=0.5 * 1e-3 / (2 * 3.0 * eta),
        viscosity="1 mPa*s",
    )
    assert other.shear == pytest.approx(3.0)
    assert other.diffusion == pytest.approx(0.5)
    times = [b.time(np.array([2.0])) for b in gel().branches()]
    np.testing.assert_allclose([b.time(np.array([2.0])) for b in other.branches()], times)


def test_two_bodies_that_drain_alike() -> None:
    """The pair has the branches of both, and a pair of equals is a body half as stiff."""
    one = gel().model_dump(exclude_none=True)
    both = pl.kernel("pair", first=one, second=one)
    assert have_equal_branches(both.branches(), gel().branches())
    with pytest.raises(pl.ConfigError, match="relax differently"):
        pl.kernel("pair", first=one, second={**one, "diffusivity": 0.6})


@pytest.mark.parametrize("time", [lambda q: q[:1], lambda q: -q, lambda q: q + np.inf])
def test_the_kit_asks_for_the_times_of_waves(time: OfWave) -> None:
    """Each has to be positive and finite, and of the shape of q."""

    class Wrong(Poroelastic):
        type: Literal["wrong"] = "wrong"  # type: ignore[assignment]

        def branches(self) -> tuple[Branch, ...]:
            return (Branch(0.3, time),)

    kernel = Wrong(shear_modulus=1.0, poissons_ratio=0.0, diffusivity=1.0)
    case = Case(pl.Grid(points=8, size=1.0), kernel)
    assert "the time of a branch is" in branches_have_shares_and_times(kernel, case)
    assert not branches_have_shares_and_times(gel(), case)
