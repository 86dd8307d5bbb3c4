"""The passes of a curve are told by where the motion turns, or by segments that a file states."""

from collections.abc import Callable
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.files.choice import read
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.measurement import Measurement, Segment
from pellicle_fit.files.passes import passes
from tests.plugins.fit import instruments

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
