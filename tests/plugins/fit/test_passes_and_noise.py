"""Passes of a curve; what a detector adds; curves without a baseline."""

from collections.abc import Callable
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.estimation.long_memory import exponent_of, fractional_differences
from pellicle_fit.estimation.noise import Flaw
from pellicle_fit.files.choice import read
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.measurement import Measurement, Segment
from pellicle_fit.files.passes import passes
from pellicle_fit.selection.verdict import Verdict
from tests.plugins.fit import instruments
from tests.plugins.fit.conftest import ends_of, holds

SPRING, STEP = 0.05, 1e-8
"""Spring constant [N/m] of a cantilever, and how far its base moves from row to row [m]."""
ORDERS = "forwards", "backwards", "retract first"


def motion(rows: int, back: int, dwell: int = 0, jump: float = 0.0) -> Array:
    """Return positions [m] of an approach, a dwell and a retract that begins with a jump."""
    way = STEP * np.arange(rows)
    out = way[-1] + jump - STEP * np.arange(back + 1)
    return np.concatenate([way, np.full(dwell, way[-1]), out if jump else out[1:]])


def measured(
    base: Array, rows: int, dwell: int, noise: float = 0.0, is_seen: bool = True
) -> Measurement:
    """Return what is measured: noise [N] of the deflection is in the position of the tip too."""
    force = 6.0 * np.clip(base - base.max() / 2, 0.0, None) ** 1.5
    force *= np.interp(np.arange(base.size), [rows - 1, rows + dwell], [1.0, 0.98])
    force += noise * np.random.default_rng(0).standard_normal(base.size)
    time = np.asarray(5.0 + 1e-3 * np.arange(base.size), dtype=np.float64)
    return Measurement(
        base - force / SPRING, force, time=time, stiffness=SPRING if is_seen else None
    )


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    rows=st.integers(200, 900),
    share=st.floats(0.05, 1.0),
    jump=st.sampled_from([-0.1, -0.01, 0.0, 0.0, 0.01, 0.1]),
    rest=st.sampled_from([0.0, 0.1, 0.3]),
    order=st.sampled_from(ORDERS),
    seen=st.sampled_from(["cantilever", "cantilever with noise", "tip", "tip with noise"]),
)
def test_passes_are_those_that_were_made(
    rows: int, share: float, jump: float, rest: float, order: str, seen: str
) -> None:
    """A retract of any depth is found, across a step and a dwell, in any order that time mends."""
    is_seen, noise = seen.startswith("cantilever"), 2e-10 * ("noise" in seen)
    dwell = 0 if noise and not is_seen else round(rest * rows)
    base = motion(rows, back=round(share * rows), dwell=dwell, jump=jump * rows * STEP)
    curve, size = measured(base, rows, dwell, noise, is_seen), base.size
    stored = {
        "forwards": np.arange(size),
        "backwards": np.arange(size)[::-1],
        "retract first": np.roll(np.arange(size), -rows - dwell),
    }[order]
    assert curve.time is not None
    file = Measurement(
        curve.position[stored],
        curve.force[stored],
        time=curve.time[stored],
        stiffness=curve.stiffness,
    )
    made: dict[Segment, tuple[int, int]] = {
        "approach": (0, rows - 1),
        "retract": (rows + dwell, size - 1),
    }
    for segment, ends in made.items():
        one = clean(file, segment)
        assert one.time is not None
        rows_found = np.searchsorted(curve.time, one.time[[0, -1]])
        assert rows_found == pytest.approx(np.array(ends), abs=4)
        (note,) = [text for text in one.messages if "left out" in text]
        named = note.partition(" are the ")[0].removeprefix("rows ").split(" and ")
        spans = [range(int(a), int(b) + 1) for a, _, b in map(str.split, named)]
        assert {*chain(*spans)} == {*np.flatnonzero(np.isin(curve.time[stored], one.time)) + 1}
    both = clean(file, "both")
    assert both.unloading is not None
    assert both.unloading.sum() == pytest.approx(size - rows - dwell, abs=8 if noise else 4)


ONE_WAY: dict[str, Callable[[Array, np.random.Generator], Array]] = {
    "noise": lambda way, rng: way + 0.01 * rng.standard_normal(way.size),
    "hum": lambda way, rng: way + 0.01 * np.sin(0.2 * np.arange(way.size) + rng.uniform(0, 6)),
    "modulated": lambda way, rng: way + 0.06 * np.sin(80 * way + rng.uniform(0, 6)),
    "steps of the piezo": lambda way, rng: np.round(way * rng.uniform(40, 60)) / 50,
    "a row far off": lambda way, rng: way + 0.3 * (np.arange(way.size) == way.size // 2),
    "slow at both ends": lambda way, rng: (1 - np.cos(np.pi * way)) / 2,
}


@pytest.mark.parametrize("seen", ONE_WAY)
def test_a_motion_one_way_is_one_pass(seen: str) -> None:
    """Noise of a tip, modulations, steps and faulty rows make no pass."""
    rng = np.random.default_rng(1)
    for rows in rng.integers(200, 3000, 30):
        (one,) = passes(ONE_WAY[seen](np.linspace(0, 1, rows), rng))
        assert one.inward
        assert (one.first, one.last) == pytest.approx((0, rows - 1), abs=rows / 16)


def test_a_second_approach_is_another_curve() -> None:
    """Curves that turn twice for good are refused; what turns a little is told."""
    base = np.concatenate([motion(300, 135), motion(300, 0)[165:]])
    with pytest.raises(pl.ConfigError, match="goes to and fro 3 times"):
        clean(measured(base, 300, 0))
    base = np.concatenate([motion(300, 60), motion(300, 0)[240:]])
    curve = clean(measured(base, 300, 0))
    assert curve.force.size == base.size
    assert [text for text in curve.messages if "moves back by up to 600 nm" in text]


def test_a_time_that_begins_anew_orders_nothing() -> None:
    """Where each segment has a time of its own, rows stay as they are, without time."""
    curve = measured(motion(300, 200), 300, 0)
    time = np.concatenate([np.arange(300.0), np.arange(200.0)])
    approach = clean(replace(curve, time=time))
    assert approach.time is None
    assert np.array_equal(approach.force, curve.force[:300])
    assert [text for text in approach.messages if "as one without time" in text]


CREEP = {"extend": 300, "constant-force pause": 200, "retract": 60}
RELAXATION = {"first pause": 100, "extend": 300, "constant-height pause": 200, "retract": 60}


@pytest.mark.parametrize("segments", [CREEP, RELAXATION], ids=["creep", "relaxation"])
@pytest.mark.parametrize("name", ["export.h5", "export.tab", "curve.jpk-force"])
def test_stated_pauses_are_cut_off(tmp_path: Path, name: str, segments: dict[str, int]) -> None:
    """A pause in which the base goes on as fast as a fifth of the approach is no part of it."""
    before, rest = segments.get("first pause", 0), 0.2 * ("constant-force pause" in segments)
    parts = np.zeros(before), np.ones(300), np.full(200, rest), -np.ones(60)
    base = STEP * np.cumsum(np.concatenate(parts))
    curve = measured(base, before + 300, 200)
    height, force = -base, np.asarray(curve.force)
    recording = instruments.Recording(height, force, SPRING, segments=segments)
    instruments.WRITERS[name](tmp_path / name, recording)
    (reader,) = read(tmp_path / name).values()
    assert clean(reader()).force == pytest.approx(force[before : before + 300], abs=1e-15)
    assert clean(reader(), "retract").force == pytest.approx(force[-60:], abs=1e-15)
    both = clean(reader(), "both")
    assert both.force.size == force.size - before
    assert both.unloading is not None
    assert both.unloading.sum() == 60


MODULUS, RADIUS, DEEPEST = 100e3, 5e-6, 50e-9
STIFF, SENSITIVITY = 0.16, 50e-9
KINDS = {
    "extension [nm],deflection [nm]": ("base", 1 / STIFF),
    "height [um],deflection [V]": ("height", 1 / STIFF / SENSITIVITY),
    "extension [m],force [nN]": ("base", 1.0),
    "position [nm],deflection [nm]": ("tip", 1 / STIFF),
    "position [m],force [N]": ("tip", 1.0),
    "depth [nm],force [N]": ("depth", 1.0),
    "depth [nm],deflection [nm]": ("depth", 1 / STIFF),
}
"""Headers of tables, the place in their first column, and the second one over the force."""


def _fit(header: str, constant: float, folder: Path, **options: Any) -> pl.Fit:
    """Return the fit of a table whose forces are off by a constant, over the largest."""
    depth = np.linspace(-0.7, 1.0, 120) * DEEPEST
    force = 4 / 3 * MODULUS * np.sqrt(RADIUS) * np.maximum(depth, 0) ** 1.5
    largest, noise = force.max(), np.random.default_rng(3).standard_normal(depth.size)
    base, told = depth + force / STIFF, force + largest * (0.003 * noise + constant)
    place, over_force = KINDS[header]
    places = {"base": base, "height": 3e-6 - base, "tip": base - told / STIFF, "depth": depth}
    units = {"nm": 1e-9, "um": 1e-6, "nN": 1e-9}
    one, other = (units.get(part.split("[")[1][:-1], 1.0) for part in header.split(","))
    columns = np.column_stack([places[place] / one, told * over_force / other])
    path = folder / "curve.csv"
    np.savetxt(path, columns, fmt="%.15g", delimiter=",", header=header, comments="")
    if "[V]" in header:
        options["sensitivity"] = SENSITIVITY
    of_tip: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS, "spring_constant": STIFF}
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
        "spring_constant": STIFF,
    }
    depth = np.linspace(-0.7, 1.0, 300) * DEEPEST
    force = 4 / 3 * MODULUS * np.sqrt(RADIUS) * np.maximum(depth, 0) ** 1.5
    fits = [
        pl.fit(
            depth + (force - told) / STIFF,
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
    assert fractional_differences(values, 1.0)[1:] == pytest.approx(np.diff(values, axis=0))
    assert fractional_differences(values, 0.0) == pytest.approx(values)
    twice = fractional_differences(fractional_differences(values, 0.3), 0.7)
    assert twice == pytest.approx(fractional_differences(values, 1.0))


@pytest.mark.parametrize("exponent", [0.2, 0.5, 0.8])
def test_exponent_of_fractional_noise(exponent: float) -> None:
    """The exponent of noise is recovered; its standard error is 0.78 / √n, here 0.008."""
    random = np.random.default_rng(2)
    noise = fractional_differences(random.standard_normal((10_000, 1)), -exponent)[:, 0]
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
