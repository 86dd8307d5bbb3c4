"""What a detector adds: a constant, noise of 1/f; and curves without a baseline."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pellicle as pl
from pellicle_fit.estimation.long_memory import differenced, exponent_of
from pellicle_fit.estimation.noise import Flaw
from pellicle_fit.selection.verdict import Verdict
from tests.plugins.fit.conftest import ends_of, holds

MODULUS, RADIUS, DEEPEST = 100e3, 5e-6, 50e-9
SPRING, SENSITIVITY = 0.16, 50e-9
KINDS = {
    "extension [nm],deflection [nm]": ("base", 1 / SPRING),
    "height [um],deflection [V]": ("height", 1 / SPRING / SENSITIVITY),
    "extension [m],force [nN]": ("base", 1.0),
    "position [nm],deflection [nm]": ("tip", 1 / SPRING),
    "position [m],force [N]": ("tip", 1.0),
    "depth [nm],force [N]": ("depth", 1.0),
    "depth [nm],deflection [nm]": ("depth", 1 / SPRING),
}
"""Headers of tables, the place in their first column, and the second one over the force."""


def _fit(header: str, constant: float, folder: Path, **options: Any) -> pl.Fit:
    """Return the fit of a table whose forces are off by a constant, over the largest."""
    depth = np.linspace(-0.7, 1.0, 120) * DEEPEST
    force = 4 / 3 * MODULUS * np.sqrt(RADIUS) * np.maximum(depth, 0) ** 1.5
    largest, noise = force.max(), np.random.default_rng(3).standard_normal(depth.size)
    base, told = depth + force / SPRING, force + largest * (0.003 * noise + constant)
    place, over_force = KINDS[header]
    places = {"base": base, "height": 3e-6 - base, "tip": base - told / SPRING, "depth": depth}
    units = {"nm": 1e-9, "um": 1e-6, "nN": 1e-9}
    one, other = (units.get(part.split("[")[1][:-1], 1.0) for part in header.split(","))
    columns = np.column_stack([places[place] / one, told * over_force / other])
    path = folder / "curve.csv"
    np.savetxt(path, columns, fmt="%.15g", delimiter=",", header=header, comments="")
    if "[V]" in header:
        options["sensitivity"] = SENSITIVITY
    of_tip: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS, "spring_constant": SPRING}
    return pl.fit(path, baseline="offset", **of_tip, **options)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(header=st.sampled_from([*KINDS]), constant=st.floats(-20.0, 20.0))
def test_it_is_the_offset(
    tmp_path_factory: pytest.TempPathFactory, header: str, constant: float
) -> None:
    """Modulus, contact point, their intervals and checks are those of a detector without it."""
    folder = tmp_path_factory.mktemp("offset")
    plain, moved = (_fit(header, one, folder, model=[], rivals=[]) for one in (0.0, constant))
    before, now = plain.estimates(), moved.estimates()
    assert holds(before["reduced_modulus"], MODULUS)
    largest = 4 / 3 * MODULUS * np.sqrt(RADIUS) * DEEPEST**1.5
    shift = now["offset"].value - before["offset"].value
    assert shift == pytest.approx(constant * largest, abs=1e-4 * largest)
    for name, size in (("reduced_modulus", MODULUS), ("contact_point", DEEPEST)):
        old, new = (np.array([e.value, *ends_of(e)]) for e in (before[name], now[name]))
        assert new == pytest.approx(old, abs=1e-4 * size)
    assert [one.flaws for one in moved.answer.judgements] == [
        one.flaws for one in plain.answer.judgements
    ]


@pytest.mark.slow
@pytest.mark.parametrize("constant", [-5.0, 20.0])
def test_it_is_no_explanation(tmp_path: Path, constant: float) -> None:
    """With all rivals, and one contact point or another that no row reaches, E* is held."""
    header = "extension [nm],deflection [nm]"
    fit = _fit(header, constant, tmp_path)
    assert fit.verdict is Verdict.NO_SIGN
    assert holds(fit.reduced_modulus, MODULUS)


def test_a_relaxing_solid_sees_the_way_without_it() -> None:
    """The path of a memory is that of the tip, whatever the detector reads without a load."""
    time = np.linspace(0.0, 1.0, 300)
    options: dict[str, Any] = {
        "indenter": "paraboloid",
        "radius": RADIUS,
        "spring_constant": SPRING,
    }
    depth = np.linspace(-0.7, 1.0, 300) * DEEPEST
    force = 4 / 3 * MODULUS * np.sqrt(RADIUS) * np.maximum(depth, 0) ** 1.5
    fits = [
        pl.fit(
            depth + (force - told) / SPRING,
            told,
            time=time,
            baseline="offset",
            model=["standard_linear"],
            rivals=[],
            fix={"relaxed_share": 0.3, "relaxation_time": 0.2},
            **options,
        )
        for told in (force, force + 10 * force.max())
    ]
    plain, moved = (fit.reduced_modulus.value for fit in fits)
    assert moved == pytest.approx(plain, rel=1e-4)


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


GEL, BEAD, DEEP, TOUCH = 2e3, 5e-6, 1e-6, 3e-6
SOFT = 0.02


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
    depth = np.linspace(share, 1.0, 400) * DEEP
    if segment != "approach":
        depth = np.append(depth, depth[::-1]) if segment == "both" else depth[::-1]
    force = 4 / 3 * GEL * np.sqrt(BEAD) * depth**1.5
    noise = 0.003 * force.max() * np.random.default_rng(seed).standard_normal(depth.size)
    told, place = force + noise, depth + TOUCH
    options: dict[str, Any] = {"indenter": "paraboloid", "radius": BEAD, "segment": segment}
    if cantilever:
        options["spring_constant"] = SOFT
        place = place - noise / SOFT
    time = np.arange(depth.size) / depth.size
    fit = pl.fit(place, told, time=time, rivals=[], **options)
    # An interval has 95 %.
    low, high = fit.reduced_modulus.low, fit.reduced_modulus.high
    assert low is not None
    assert high is not None
    assert low - (high - low) / 2 < GEL < high + (high - low) / 2
    assert fit.verdict is Verdict.NO_SIGN
