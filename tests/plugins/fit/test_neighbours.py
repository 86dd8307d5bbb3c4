"""In a folder, curves beside each other spare each other comparisons, and no answer changes."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle_fit.alike import kind_of, neighbours, order_of
from pellicle_fit.selection.neighbour import RULED_OUT, Neighbour
from pellicle_plugins.indenters.of_revolution import Paraboloid

COUNT, OTHER = 18, 6
"""Curves of the folder, and the one of another solid."""
BEAD: dict[str, Any] = {
    "indenter": "paraboloid",
    "radius": 5e-6,
    "progress": False,
    "rivals": ("cone", "brush"),
}


def measured() -> dict[str, Any]:
    """Return curves under a tension, with offsets of their own, and one that is adhesive."""
    random, curves = np.random.default_rng(4), {}
    depth = np.linspace(-0.5e-6, 1e-6, 100)
    for number in range(COUNT):
        force = 2e3 * Paraboloid(radius=5e-6).force_curve(depth, 3e-6).force
        if number == OTHER:
            force = np.where(depth > 0, 5e3 * depth, 0.0) * 1e-3
        force = random.uniform(0.9, 1.1) * force
        force = force + 0.002 * force.max() * random.standard_normal(depth.size)
        curves[str(number)] = depth + random.uniform(0, 3e-6), force
    return curves


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> tuple[xr.Dataset, xr.Dataset, Path]:
    """Return the table with every rival, that without those ruled out, and its folder."""
    folder = tmp_path_factory.mktemp("fits")
    curves = measured()
    whole = pl.fit_many(curves, every_rival=True, **BEAD)
    return whole, pl.fit_many(curves, directory=folder, **BEAD), folder


def test_answers_are_the_same(tables: tuple[xr.Dataset, xr.Dataset, Path]) -> None:
    """Verdicts are those of all comparisons, and ends of intervals to 0.05 of a half-width."""
    whole, spared, _ = tables
    assert whole["verdict"].values.tolist() == spared["verdict"].values.tolist()
    half = (whole["reduced_modulus_high"] - whole["reduced_modulus_low"]).values / 2
    for name in ("reduced_modulus", "reduced_modulus_low", "reduced_modulus_high"):
        there = np.isfinite(half)
        off = (spared[name].values - whole[name].values)[there] / half[there]
        assert np.max(np.abs(off)) < 0.05


def test_rows_say_what_was_not_weighed(tables: tuple[xr.Dataset, xr.Dataset, Path]) -> None:
    """One in 16 is compared with everything, as is what differs from those beside it."""
    whole, spared, _ = tables
    assert not any(whole["not_weighed"].values)
    told = spared["not_weighed"].values
    full = [number for number in range(COUNT) if not told[number]]
    order = np.argsort(order_of([*measured().values()]), kind="stable")
    assert {OTHER, *order[::16].tolist()} <= set(full)
    assert len(full) <= 5
    assert all("cone" in text.split("; ") for text in told[told != ""])


def test_an_interrupted_folder_goes_on_alike(tables: tuple[xr.Dataset, xr.Dataset, Path]) -> None:
    """What was fitted before speaks for what is new as it did."""
    _, spared, folder = tables
    kept = sorted((folder / "curves").glob("*.json"))
    for path in kept[::3]:
        path.unlink()
    again = pl.fit_many(measured(), directory=folder, **BEAD)
    xr.testing.assert_identical(spared.drop_attrs(), again.drop_attrs())


def test_which_curves_speak_for_others() -> None:
    """Of each kind one in 16, the nearest first; of few curves all are compared in full."""
    assert neighbours(["a"] * 7) == [[]] * 7
    found = neighbours(["a", "b"] * 18)
    assert [i for i, near in enumerate(found) if not near] == [0, 1, 32, 33]
    assert found[4] == [0, 32]
    assert found[31] == [33, 1]
    assert found[34] == [32]
    assert RULED_OUT > 12


def test_each_material_of_a_map_speaks_for_itself() -> None:
    """Curves of one stiffness and shape come together, wherever they were measured."""
    depth, random = np.linspace(-0.5, 1.0, 300), np.random.default_rng(3)
    rise = np.maximum(depth, 0.0)
    materials = rise**1.5, rise**1.2, 3 * rise**1.5
    noise = 0.01 * random.normal(size=(96, 300))
    curves = [
        (depth + i, random.uniform(0.9, 1.1) * materials[i % 3] + noise[i]) for i in range(96)
    ]
    order = order_of(curves)
    runs = [number % 3 for number in np.argsort(order)]
    assert sum(a != b for a, b in pairwise(runs)) == 2
    near = neighbours(["map"] * 96, order)
    mixed = [i for i, of in enumerate(near) if of and not any(j % 3 == i % 3 for j in of)]
    assert not mixed
    # Of a detector out of its range nearly all forces are the largest.
    saturated = np.where(np.arange(depth.size) < 3, 0.0, 1e-9)
    flat = [(depth, 0 * depth), (depth[:0], depth[:0]), (depth, saturated)]
    assert order_of(flat).tolist() == [0.0, 0.0, 0.0]


def test_what_makes_a_kind() -> None:
    """Numbers that differ little, and all else alike."""
    bead = {"type": "sphere", "radius": 5e-6}
    assert kind_of("", bead, 0.05) == kind_of("", bead | {"radius": 5.1e-6}, 0.051)
    assert kind_of("", bead, 0.05) != kind_of("", bead | {"radius": 50e-6}, 0.05)
    assert kind_of("", bead, 0.05) != kind_of("", bead, None)
    assert kind_of("", bead, 0.05) != kind_of("day", bead, 0.05)


def test_noise_alone_makes_no_curve_another() -> None:
    """A check that fails by the noise alone contradicts no model, so that the curve speaks."""
    plain = {"effects": [], "delta_aic": 0.0, "tied": True, "parameters": {}}
    fit = {"verdict": "no sign", "explanations": [plain]}
    fit["curves"] = [{"failed_checks": [{"code": "slow"}]}]
    assert Neighbour.of_dict(fit).has(frozenset(), is_described=True)
    assert not Neighbour.of_dict(fit | {"verdict": "no model describes"}).has(frozenset(), True)
