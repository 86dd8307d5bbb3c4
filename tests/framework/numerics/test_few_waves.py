"""Operators between a few waves against the operators of the functions themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle.surface import Operator, operator_of
from pellicle.surface.few_waves import FewWaves, Span, sampled_waves
from pellicle.surface.operators import weighted_sum

GRID = pl.Grid(points=(24, 20), size="1 mm", boundary="free")
KERNEL = pl.kernel("half_space", reduced_modulus="10 kPa")
LENGTHS = np.geomspace(1e-5, 1e-2, 25)


def drained(q: Array, length: float) -> Array:
    """Return a function that falls from 1 to ½ where q is 1/length."""
    return np.asarray(1 - 0.5 / (1 + (q * length) ** -2))


@dataclass(frozen=True)
class Drained:
    """The half-space times that function."""

    length: float
    is_isotropic = True

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return it of q."""
        return KERNEL.symbol(qx, qy) * drained(np.hypot(qx, qy), self.length)


@pytest.fixture(scope="module")
def span() -> Span:
    """Return the span of 25 functions over three decades of lengths."""
    q = sampled_waves(GRID)
    return Span(q, np.array([drained(q, length) for length in LENGTHS]))


def test_few_waves_tell_all_functions(span: Span) -> None:
    """Also one between those that were given, to the accuracy of the span."""
    assert 5 < len(span.waves) < 20
    assert span.error < 1e-5
    q, between = sampled_waves(GRID), 3.3e-4
    values = np.array([function(np.log(q)) for function in span.functions])
    found = drained(span.waves, between) @ values
    np.testing.assert_allclose(found, drained(q, between), atol=1e-5)


def test_one_function_needs_one_wave() -> None:
    """An elastic solid is its own span."""
    q = sampled_waves(GRID)
    assert len(Span(q, np.ones((3, q.size))).waves) == 1


def test_interpolated_operator_is_the_operator(span: Span) -> None:
    """On the grid and on a coarser one, to 1e-5 of the displacement."""
    few = FewWaves(KERNEL, span, operator_of(KERNEL, GRID))
    operator = few.interpolated(drained(span.waves, 2e-4))
    for grid in (GRID, GRID.coarsened()):
        pressure = np.random.default_rng(1).random(grid.shape)
        expected = operator_of(Drained(2e-4), grid)(pressure)
        found = (operator if grid == GRID else operator.on(grid))(pressure)
        np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_sum_over_waves_is_that_of_the_pressures(span: Span) -> None:
    """Three pressures, each with a function of its own, by one sum over the waves."""
    few = FewWaves(KERNEL, span, operator_of(KERNEL, GRID))
    pressures = np.random.default_rng(2).random((3, *GRID.shape))
    lengths = (1e-5, 1e-4, 1e-3)
    values = np.array([drained(span.waves, length) for length in lengths])
    expected = sum(
        operator_of(Drained(length), GRID)(pressure)
        for length, pressure in zip(lengths, pressures, strict=True)
    )
    found = few.displacement(np.tensordot(values.T, pressures, 1))
    np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_weighted_sum() -> None:
    """The weights may be negative; the sum on a coarser grid is the sum there."""
    operators: list[Operator] = [operator_of(Drained(length), GRID) for length in (1e-5, 1e-3)]
    total, grid = weighted_sum(operators, [2.0, -1.0]), GRID.coarsened()
    for summed, parts in (
        (total, operators),
        (total.on(grid), [operator.on(grid) for operator in operators]),
    ):
        pressure = np.random.default_rng(3).random(summed.grid.shape)
        expected = 2 * parts[0](pressure) - parts[1](pressure)
        np.testing.assert_allclose(summed(pressure), expected, rtol=1e-12)
    q = np.array([1e4])
    expected = 2 * operators[0].symbol(q, 0 * q) - operators[1].symbol(q, 0 * q)
    np.testing.assert_allclose(total.symbol(q, 0 * q), expected)
