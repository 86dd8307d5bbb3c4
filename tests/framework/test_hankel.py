"""Kernels known by their symbol alone: against closed forms, direct quadrature and identities."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from pellicle import ConfigError, Grid, displacement
from pellicle.arrays import Array
from pellicle.surface import operator_of
from pellicle.surface.hankel import ACCURACY, KernelTable
from pellicle.surface.influence import cell_coefficients
from pellicle_plugins.kernels.half_spaces import TensedMembrane

Symbol = Callable[[Array], Array]

LENGTHS = [0.0, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6]


class SymbolOnly:
    """A kernel that gives its compliance and nothing else."""

    is_isotropic = True

    def __init__(self, compliance: Symbol) -> None:
        self.compliance = compliance

    def symbol(self, qx: Array, qy: Array) -> Array:
        return self.compliance(np.hypot(qx, qy))


def membrane(s: float) -> TensedMembrane:
    """E* = 1; s = 0 is the half-space."""
    return TensedMembrane(reduced_modulus=1.0, tension=s / 2)


def layer(h: float, nu: float) -> Symbol:
    """Layer bonded to a rigid base, E* = 1: 2/q times [a sinh t − t]/[a cosh t + …], t = 2qh."""

    def symbol(q: Array) -> Array:
        t = np.minimum(2 * q * h, 700)
        decay, a = np.exp(-t), 3 - 4 * nu
        # sinh t − t from its series where it cancels; all over eᵗ/2.
        u = np.minimum(t, 0.5)
        series = u**3 / 6 * (1 + u**2 / 20 * (1 + u**2 / 42 * (1 + u**2 / 72 * (1 + u**2 / 110))))
        direct = -np.expm1(-2 * t) - 2 * t * decay
        top = np.where(t < 0.5, 2 * decay * series, direct) - (a - 1) * np.expm1(-2 * t)
        bottom = a * (1 + decay**2) + (t**2 + 8 * nu * (2 * nu - 3) + 10) * decay
        return np.asarray(2 / q * top / bottom)

    return symbol


def coefficients(
    symbol: Symbol, shape: tuple[int, int], spacing: tuple[float, float] = (1.0, 1.0)
) -> Array:
    """Cell coefficients as the operator has them: its answer to a unit pressure on one cell."""
    size = (shape[0] * spacing[0], shape[1] * spacing[1])
    cell = np.zeros(shape)
    cell[0, 0] = 1.0
    return operator_of(SymbolOnly(symbol), Grid(points=shape, size=size))(cell)


def exact(s: float, shape: tuple[int, int], spacing: tuple[float, float] = (1.0, 1.0)) -> Array:
    """Cell coefficients of the membrane from its closed form."""
    kernel = membrane(s)
    return cell_coefficients(kernel.greens_function, kernel.radial_primitive, shape, spacing)


@pytest.mark.parametrize("s", LENGTHS)
def test_every_cell_of_a_large_grid_equals_the_closed_form(s: float) -> None:
    """At N = 1024 each coefficient of the membrane is met to 1e-9."""
    shape = (1024, 1024)
    np.testing.assert_allclose(
        coefficients(membrane(s).compliance, shape), exact(s, shape), rtol=1e-9
    )


@pytest.mark.parametrize("s", LENGTHS)
@pytest.mark.parametrize(
    ("shape", "spacing"),
    [
        ((1, 1), (1.0, 1.0)),
        ((1, 300), (1.0, 1.0)),
        ((300, 1), (2.0, 1.0)),
        ((37, 50), (1.0, 3.0)),
        ((64, 11), (0.1, 1.0)),
    ],
)
def test_rectangular_odd_and_narrow_grids(
    s: float, shape: tuple[int, int], spacing: tuple[float, float]
) -> None:
    """Each coefficient equals that of the closed form to 1e-8, whatever the grid."""
    result = coefficients(membrane(s).compliance, shape, spacing)
    np.testing.assert_allclose(result, exact(s, shape, spacing), rtol=1e-8)


@pytest.mark.parametrize("h", [0.3, 1.0, 7.0])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_layer_equals_direct_quadrature(h: float, nu: float) -> None:
    """Cells of a bonded layer, ν = ½ too, to 1e-9 of the loaded one: no far field is left."""
    result = coefficients(layer(h, nu), (40, 40))
    # G − 2/q dies out as e^(−2qh): a Fourier integral in polar co-ordinates, and Love's cells.
    half_space = exact(0.0, (40, 40))
    nodes, weights = np.polynomial.legendre.leggauss(400)
    q, angle = 20 / h * (nodes + 1) / 2, np.pi / 2 * (nodes[:, None] + 1) / 2
    qx, qy = q * np.cos(angle), q * np.sin(angle)
    cell = np.sinc(qx / (2 * np.pi)) * np.sinc(qy / (2 * np.pi))
    measure = weights[:, None] * weights * (20 / h / 2) * (np.pi / 4) / np.pi**2
    density = measure * (layer(h, nu)(q) - 2 / q) * q * cell
    for i, j in [(0, 0), (1, 0), (1, 1), (3, 2), (9, 0), (9, 9), (20, 5), (35, 33)]:
        if 20 / h * np.hypot(i, j) > 400:
            continue  # the rule does not resolve the waves
        direct = half_space[i, j] + (density * np.cos(qx * i) * np.cos(qy * j)).sum()
        assert result[i, j] == pytest.approx(direct, abs=1e-9 * result[0, 0])


@pytest.mark.parametrize("nu", [0.2, 0.5])
@pytest.mark.parametrize("h", [0.2, 1.0, 3.0])
def test_all_cells_of_a_layer_make_up_its_uniform_compression(h: float, nu: float) -> None:
    """Σ K over the plane is G(0) = h (1 − 2ν)/(1 − ν)² for E* = 1: none at all for ν = ½."""
    result = coefficients(layer(h, nu), (120, 120))
    total = 4 * result.sum() - 2 * result[0].sum() - 2 * result[:, 0].sum() + result[0, 0]
    uniform = h * (1 - 2 * nu) / (1 - nu) ** 2
    assert total == pytest.approx(uniform, abs=1e-8 * result[0, 0])


@pytest.mark.parametrize("power", [0.0, 0.3, 0.5, 1.0, 1.5, 1.8])
def test_power_laws_are_exact(power: float) -> None:
    """q⁻ⁿ is a power of r too: G(r) is r^(n−2) times its value at 1, P its integral."""
    kernel = KernelTable(lambda q: q**-power, 0.2, 3e3)
    r = np.geomspace(0.2, 3e3, 50)
    at_one = kernel.greens_function(np.ones(1))[0]
    np.testing.assert_allclose(kernel.greens_function(r), at_one * r ** (power - 2), rtol=1e-10)
    if power == 0:
        assert at_one == 0
        np.testing.assert_allclose(kernel.radial_primitive(r), 1 / (2 * np.pi), rtol=1e-14)
    else:
        np.testing.assert_allclose(
            kernel.radial_primitive(r), at_one * r**power / power, rtol=1e-10
        )


def test_winkler_foundation_yields_under_the_pressure_only() -> None:
    """A constant compliance gives u = c p in every cell, rectangular ones too."""
    grid = Grid(points=[30, 17], size=[3.0, 5.0])
    pressure = np.random.default_rng(0).random(grid.shape)
    u = displacement(pressure, kernel=SymbolOnly(lambda q: np.full_like(q, 7.0)), grid=grid)
    np.testing.assert_allclose(u, 7 * pressure, rtol=0, atol=1e-13)


SYMBOLS: dict[str, Symbol] = {
    "half-space": lambda q: 2 / q,
    "membrane": lambda q: 2 / (q + 3 * q**2),
    "graded": lambda q: q**-0.5,
    "strongly graded": lambda q: q**-0.07,
    "bending skin": lambda q: 1 / (q + 5 * q**4),
    "tension on springs": lambda q: 1 / (1 + q**2),
    "springs under a half-space": lambda q: 0.7 + 2 / q,
    "stretching skin": lambda q: 2 / q * (1 + 0.8 * q) / (1 + q),
    "interlayer": lambda q: 2 / q * (1 + q / (1 + q**2)),
    "layer": layer(0.6, 0.3),
    "incompressible layer": layer(0.6, 0.5),
    "tensed layer": lambda q: 1 / (1 / layer(0.6, 0.5)(q) + q**2),
}


@pytest.mark.parametrize("symbol", SYMBOLS.values(), ids=SYMBOLS)
def test_gaussian_pressure_in_both_spaces(symbol: Symbol) -> None:
    """∫ p dP in real space is ∫ G p̂ q dq/2π in Fourier space, for p = exp(−r²/2), to 1e-8."""
    kernel = KernelTable(symbol, 1e-4, 40.0)

    def in_fourier(q: float) -> float:
        return float(symbol(np.array([q]))[0] * q * np.exp(-(q**2) / 2))

    def in_real(log_r: float) -> float:
        r = np.exp(log_r)
        return float(kernel.radial_primitive(np.array([r]))[0] * r**2 * np.exp(-(r**2) / 2))

    expected = sum(
        quad(in_fourier, a, b, epsabs=0, epsrel=1e-11)[0] for a, b in [(0, 0.1), (0.1, 2), (2, 12)]
    )
    # By parts; below 1e-4 it is 1e-8 of P there.
    cuts = np.log([1e-4, 1e-2, 0.3, 2, 12])
    result = sum(quad(in_real, a, b, epsabs=0, epsrel=1e-11)[0] for a, b in pairwise(cuts))
    assert 2 * np.pi * result == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("symbol", SYMBOLS.values(), ids=SYMBOLS)
def test_green_function_is_the_derivative_of_its_primitive(symbol: Symbol) -> None:
    """P between two radii is ∫ G r dr, to 1e-9 of the largest |P|."""
    kernel = KernelTable(symbol, 0.1, 1e3)
    radii = np.geomspace(0.1, 1e3, 60)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    middle, half = (radii[1:] + radii[:-1]) / 2, np.diff(radii) / 2
    r = middle[:, None] + half[:, None] * nodes
    integral = half * ((kernel.greens_function(r) * r) @ weights)
    primitive = kernel.radial_primitive(radii)
    largest = np.maximum.accumulate(np.abs(primitive))[1:]
    assert (np.abs(np.diff(primitive) - integral) < 1e-9 * largest).all()


@pytest.mark.parametrize("length", [1e-9, 3e4])
@pytest.mark.parametrize("modulus", [1e-3, 1e11])
@pytest.mark.parametrize("name", ["membrane", "graded", "layer", "incompressible layer"])
def test_units_do_not_matter(name: str, length: float, modulus: float) -> None:
    """With lengths in any unit and moduli in any other, K scales as length over modulus."""
    symbol = SYMBOLS[name]
    unit = coefficients(symbol, (50, 40))
    scaled = coefficients(
        lambda q: symbol(q * length) * length / modulus, (50, 40), (length, length)
    )
    np.testing.assert_allclose(scaled * modulus / length, unit, rtol=1e-9, atol=1e-11 * unit[0, 0])


@pytest.mark.parametrize("s", [1e-3, 1.0, 1e3, 1e6, 1e8])
def test_the_estimated_error_is_not_less_than_the_error(s: float) -> None:
    """A table is at least as good as it says, up to rounding."""
    kernel, closed = KernelTable(membrane(s).compliance, 0.2, 70.0), membrane(s)
    r = np.geomspace(0.2, 70, 3000)
    for result, expected in [
        (kernel.greens_function(r), closed.greens_function(r)),
        (kernel.radial_primitive(r), closed.radial_primitive(r)),
    ]:
        assert np.abs(result / expected - 1).max() <= kernel.error + 1e-12
    assert kernel.error <= ACCURACY


REFUSED: dict[str, tuple[Symbol, str, list[str]]] = {
    "negative": (lambda q: -1 / q, "kernel", ["compliance(q) is -", "positive and finite"]),
    "zero": (lambda q: 0 * q, "kernel", ["compliance(q) is 0 m/Pa", "positive and finite"]),
    "nan": (lambda q: q * np.nan, "kernel", ["compliance(q) is nan", "check the parameters"]),
    "overflows": (
        lambda q: 2 / q * np.sinh(q) / np.cosh(q),
        "kernel",
        ["compliance(q) is nan m/Pa at q = 71", "rad/m"],
    ),
    "grows": (lambda q: 1 + q, "kernel", ["still grows at q = ", "as q^1"]),
    "oscillates": (
        lambda q: (2 + np.sin(q)) / q,
        "kernel",
        ["cannot be computed from compliance(q)", "estimated error", "smooth"],
    ),
    "noise": (
        lambda q: (1 + 1e-4 * np.sin(1e6 * np.log(q))) / (q + q**2),
        "kernel",
        ["cannot be computed from compliance(q)", "exact to rounding"],
    ),
    "logarithmic": (
        lambda q: q**-2.0,
        "grid.boundary",
        ["'free'", "not finite", "as q^-2", "'periodic'"],
    ),
    "hardly resolved": (layer(0.05, 0.5), "grid.points", ["at its centre", "use more points"]),
    "unresolved": (layer(1e-3, 0.5), "kernel", ["estimated error", "make the cells finer"]),
    "far from resolved": (layer(1e-6, 0.5), "kernel", ["still grows", "make the cells finer"]),
}


@pytest.mark.parametrize(("symbol", "field", "words"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_transformed_is_refused(
    symbol: Symbol, field: str, words: list[str]
) -> None:
    """No wrong number: the message says what is wrong, where, and what to do."""
    with pytest.raises(ConfigError) as caught:
        operator_of(SymbolOnly(symbol), Grid(points=64, size=64.0))
    ((where, message),) = caught.value.problems
    assert where == field
    for word in words:
        assert word in message


def test_a_finer_grid_gets_a_table_of_its_own() -> None:
    """A table is never used beyond its radii."""
    fine = Grid(points=64, size=1.0)
    pressure = np.random.default_rng(2).random(fine.shape)
    coarse = operator_of(SymbolOnly(membrane(1.0).compliance), Grid(points=8, size=1.0))
    result = coarse.on(fine)(pressure)
    closed = displacement(pressure, kernel=membrane(1.0), grid=fine)
    np.testing.assert_allclose(result, closed, rtol=1e-9)
