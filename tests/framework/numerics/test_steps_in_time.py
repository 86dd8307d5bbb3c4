"""Steps in time of a solid that relaxes, of one wave and between a few, against closed forms."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components import Branch
from pellicle.contact.time_step import History, TimeStep
from pellicle.surface import Operator, operator_of
from pellicle.surface.few_waves import FewWaves, Span, sampled_waves
from pellicle.surface.operators import weighted_sum

STIFFNESS, SKIN = 3e7, 1e7  # [Pa/m] of one wave
SOLID = (Branch(0.4, 1.0), Branch(0.3, 0.05), Branch(0.1, 40.0))
LIQUID = (Branch(0.7, 1.0), Branch(0.3, 20.0))
SLS = (Branch(0.8, 2.0),)

Stepper = Callable[[Sequence[Branch], History, TimeStep, Array], tuple[Array, History]]


def press_bare(
    branches: Sequence[Branch], memory: History, step: TimeStep, displacement: Array
) -> tuple[Array, History]:
    """Return the pressure that makes a displacement, and the memory, without a skin."""
    left = memory.residual(step) / -step.stiffness
    pressure = STIFFNESS * step.stiffness * (displacement - left)
    return pressure, memory.after(step, displacement)


def press_skin(
    branches: Sequence[Branch], memory: History, step: TimeStep, displacement: Array
) -> tuple[Array, History]:
    """Return the pressure that makes a displacement, and the memory, under a skin."""
    stiffness = SKIN + step.stiffness * STIFFNESS
    left = -STIFFNESS * memory.residual(step) / stiffness
    pressure = stiffness * (displacement - left)
    return pressure, memory.after(step, displacement)


def path(stepper: Stepper, branches: Sequence[Branch], times: Array, displacement: Array) -> Array:
    """Return the pressure [Pa] at each time, the first of which is a jump."""
    memory, before, pressures = History.at_rest(branches, (1, 1)), times[0], []
    for t, u in zip(times, displacement, strict=True):
        step = TimeStep.of(branches, t - before)
        pressure, memory = stepper(branches, memory, step, np.full((1, 1), u))
        pressures.append(pressure.item())
        before = t
    return np.array(pressures)


def modulus(branches: Sequence[Branch], t: Array) -> Array:
    """Return E(t) over E(0)."""
    relaxed = sum((-b.share * np.expm1(-t / b.time_at(None)) for b in branches), np.zeros_like(t))
    return np.asarray(1 - relaxed)


def convolution(branches: Sequence[Branch], times: Array, displacement: Array) -> Array:
    """Return ∫ E(t − t′) du of a displacement that is linear between the times."""
    stress = displacement[0] * modulus(branches, times - times[0])
    for i in range(len(times) - 1):
        rise, duration = displacement[i + 1] - displacement[i], times[i + 1] - times[i]
        until = times[i + 1 :] - times[i + 1]
        mean = np.full_like(until, 1 - sum(g for g, _ in branches))
        for g, tau in branches:
            x = duration / tau
            mean += g * np.exp(-until / tau) * (-np.expm1(-x) / x if x else 1.0)
        stress[i + 1 :] += rise * mean
    return np.asarray(stress)


@pytest.mark.parametrize("branches", [SOLID, LIQUID, SLS, ()], ids=["solid", "liquid", "SLS", "0"])
@pytest.mark.parametrize(("stepper", "skin"), [(press_bare, 0.0), (press_skin, SKIN)])
def test_path_of_straight_lines_is_exact(
    branches: tuple[Branch, ...], stepper: Stepper, skin: float
) -> None:
    """Steps of 1e-6 to 1e3 s and jumps among them give the convolution to rounding."""
    rng = np.random.default_rng(4)
    durations = np.where(rng.random(40) < 0.2, 0.0, 10 ** rng.uniform(-6, 3, 40))
    times = np.cumsum(durations)
    displacement = rng.normal(size=40)
    expected = skin * displacement + STIFFNESS * convolution(branches, times, displacement)
    pressure = path(stepper, branches, times, displacement)
    np.testing.assert_allclose(pressure, expected, rtol=0, atol=1e-11 * STIFFNESS)


def creep(stepper: Stepper, skin: float, number: int) -> float:
    """Return the displacement at t = 5 s under 1 Pa from t = 0, by ``number`` equal steps."""
    memory, displacement = History.at_rest(SLS, (1, 1)), np.zeros((1, 1))
    for duration in [0.0] + [5.0 / number] * number:
        step = TimeStep.of(SLS, duration)
        stiffness = skin + step.stiffness * STIFFNESS
        history = memory.residual(step)
        left = -STIFFNESS * history / stiffness
        displacement = left + 1 / stiffness
        _, memory = stepper(SLS, memory, step, displacement)
    return displacement.item()


@pytest.mark.parametrize(("stepper", "skin"), [(press_bare, 0.0), (press_skin, SKIN)])
def test_creep_converges_at_second_order(stepper: Stepper, skin: float) -> None:
    """Under a force the displacement is no straight line: halved steps give a quarter of the error.

    A standard linear solid in parallel with a spring is one too: with the stiffness K at once and R
    relaxed, u = 1/R − (1/R − 1/K) e^(−(R/K)t/τ).
    """
    instantaneous, relaxed = skin + STIFFNESS, skin + 0.2 * STIFFNESS
    decay = math.exp(-relaxed / instantaneous * 5 / 2)
    exact = 1 / relaxed - (1 / relaxed - 1 / instantaneous) * decay
    errors = [abs(creep(stepper, skin, n) / exact - 1) for n in (5, 10, 20, 40)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[0] < 0.02
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


def test_step_in_parts_is_the_same_step() -> None:
    """A straight line in seven parts leaves the memory of the whole, of every cell its own."""
    rng = np.random.default_rng(5)
    start, end = rng.normal(size=(2, 4, 3))
    first = History.at_rest(SOLID, (4, 3)).after(TimeStep.of(SOLID, 0.0), start)
    whole = first.after(TimeStep.of(SOLID, 0.7), end)
    parts = first
    for i in range(1, 8):
        parts = parts.after(TimeStep.of(SOLID, 0.1), start + (end - start) * i / 7)
    np.testing.assert_allclose(parts.branches, whole.branches, rtol=0, atol=1e-14)
    assert whole.branches.shape == (3, 4, 3)


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e6])
def test_unit_of_time_does_not_matter(scale: float) -> None:
    """Times in other units give the same step, to rounding."""
    scaled = [Branch(b.share, float(b.time_at(None)) * scale) for b in SOLID]
    step, other = TimeStep.of(SOLID, 0.3), TimeStep.of(scaled, 0.3 * scale)
    np.testing.assert_allclose(other.decays, step.decays, rtol=1e-14)
    np.testing.assert_allclose(other.weights, step.weights, rtol=1e-14)
    assert other.stiffness == pytest.approx(step.stiffness, rel=1e-14)


@pytest.mark.parametrize("ratio", [0.0, 5e-324, 1e-300, 1e-12, 1e-8, 1e3, 1e10, 1e300, math.inf])
def test_steps_far_from_the_times(ratio: float) -> None:
    """As x = Δ/τ → 0, c = 1 − x/2, and 1 in a jump; as x → ∞, c = 1/x, and nothing lasts."""
    step = TimeStep.of((Branch(0.8, 1.0),), ratio)
    share, decay = (1 - ratio / 2, 1 - ratio) if ratio < 1 else (1 / ratio, 0.0)
    assert step.weights[0] == pytest.approx(0.8 * share, rel=1e-15)
    assert step.decays[0] == pytest.approx(decay, rel=1e-15, abs=0)
    relaxed = pytest.approx(0.2, abs=0.9 / ratio + 1e-15) if ratio > 1 else 0
    assert step.stiffness == (relaxed if ratio > 1 else pytest.approx(1.0, abs=1e-8))


def test_liquid_resists_a_long_step_by_its_viscosity() -> None:
    """γ Δ → Σ g τ if the shares sum to 1, in decimals that do not add up exactly, too."""
    branches = tuple(Branch(0.1, 1.0) for _ in range(10))
    assert TimeStep.of(branches, 1e9).stiffness == pytest.approx(1e-9, rel=1e-12)
    assert TimeStep.of(LIQUID, 1e9).stiffness == pytest.approx((0.7 + 6.0) / 1e9, rel=1e-7)


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
