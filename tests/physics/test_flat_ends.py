"""Flat ends under tension: all of a flat counts as contact, and its edge holds what sticks."""

from math import inf, pi
from typing import Any

import numpy as np
import pytest
import xarray as xr

from pellicle_axisymmetric import Adhesion
from pellicle_plugins.indenters.of_revolution import Paraboloid
from pellicle_plugins.validation.adhesive_path import curve_of
from tests.tables_of_runs import heights, steps, tensed

pytestmark = [
    pytest.mark.filterwarnings(f"ignore:.*{words}")
    for words in ("are those of the", "it jumps from", "too coarse")
]

PUNCH = {"type": "flat_punch", "radius": 1.0}
WORN = {"type": "sphere", "radius": 5.0, "flat_radius": 1.0}


CELLS = (np.arange(65)[:, None] - 32) * 4 / 65
DISC, BESIDE = np.hypot(CELLS, CELLS.T) < 1, -1 - CELLS**2 - CELLS.T**2


def pressed(
    indenter: dict[str, Any], length: float, points: Any = 65, size: Any = 4.0, **changed: Any
) -> xr.Dataset:
    """Return the steps of an indenter on a skin with s = ``length``."""
    run = {"grid": {"points": points, "size": size}, "kernel": tensed(1.0, length / 2)}
    return steps(indenter=indenter, **run | {"loading": {"depth": 1e-3}} | changed)


def _flat(data: xr.Dataset) -> Any:
    """Return the cells of the end, by the profile u − g = δ + f."""
    return data["displacement"] - data["gap"] > 0.97 * data["depth"]


@pytest.mark.parametrize("length", [0.1, 1.0, 10.0])
@pytest.mark.parametrize(
    ("indenter", "changed"),
    [
        (PUNCH, {}),
        (WORN, {}),
        (PUNCH, {"points": [64, 96]}),
        (PUNCH, {"grid": {"points": 64, "size": 4.0, "boundary": "periodic"}}),
        (
            {"type": "shifted", "part": PUNCH, "x": 0.01, "y": 0.02},
            {"loading": {"force": 1e-2}},
        ),
        ({"type": "sum", "parts": [PUNCH, {"type": "paraboloid", "radius": 2e4}]}, {}),
        (heights(np.where(DISC, -1e-5 * (CELLS + 1), BESIDE)), {}),
        (heights(np.where(DISC, 1e-9 * np.cos(7 * CELLS), BESIDE)), {}),
    ],
    ids=[
        *("punch", "worn sphere", "rectangles", "periodic", "shifted under a force"),
        *("round", "tilted", "rough by a millionth"),
    ],
)
def test_a_flat_touches_as_a_whole(
    indenter: dict[str, Any], changed: dict[str, Any], length: float
) -> None:
    """Its area is that of its cells, in one patch, though some of them carry no pressure."""
    data = pressed(indenter, length, **changed).isel(step=0)
    flat = _flat(data)
    assert np.array_equal(data["contact"], flat)
    assert data["patches"] == 1
    assert data["contact_radius"] == pytest.approx(1, rel=0.02)
    assert data["contact_area"] == pytest.approx(flat.sum() * 4**2 / flat.size)
    if length > 1:
        assert (data["pressure"] > 0).sum() < 0.95 * flat.sum()


def test_a_strip_one_cell_long_touches_as_a_whole() -> None:
    """The flat of a line contact has no blocks of cells across its line."""
    grid = {"points": [65, 1], "size": [4.0, 4 / 65], "boundary": "periodic"}
    strip = heights(np.where(np.abs(CELLS) < 1, 0.0, -1 - CELLS**2))
    data = pressed(strip, 10.0, grid=grid).isel(step=0)
    assert np.array_equal(data["contact"], _flat(data))


@pytest.mark.slow
def test_what_is_counted_is_what_is_prescribed_and_remembered() -> None:
    """A contact radius beyond the flat is searched from there, corrections and domains follow."""
    found = pressed(WORN, 10.0, 48, 4.5, loading={"contact_radius": 1.1}).isel(step=0)
    assert found["contact_radius"].item() == pytest.approx(1.1, rel=0.02)
    assert found["contact"].values[_flat(found)].all()
    corrected = pressed(PUNCH, 10.0, corrections=[{"type": "yastrebov"}])
    assert corrected["contact_area_yastrebov"].item() == pytest.approx(pi, rel=0.03)


def test_round_and_bent_contacts_are_not_filled() -> None:
    """Without a flat, and where a bending skin opens under one by more than a cell's error."""
    skin = {"type": "half_space", "reduced_modulus": 1.0}
    bent = {"type": "coated", "substrate": skin, "tension": 0.0, "bending": 1.0}
    for data in (
        pressed({"type": "paraboloid", "radius": 5.0}, 10.0, 64, loading={"depth": 0.1}),
        pressed({"type": "cone", "half_angle": 1.2, "tip_radius": 2.0}, 1.0),
        pressed(PUNCH, 0.0, kernel=bent),
    ):
        assert np.array_equal(data["contact"], data["pressure"] > 0)


@pytest.mark.slow
@pytest.mark.parametrize("length", [0.0, 0.1, 1.0])
def test_the_edge_of_a_worn_tip_is_that_of_the_theory(length: float) -> None:
    """Pull-off and the lowest depth of a solved path, where the edge holds one of them or both."""
    body = Paraboloid(radius=1.0, flat_radius=0.6)
    path = {"start": 0.02, "stop": 4.0, "num": 16, "spacing": "log"}
    solved = pressed(body.model_dump(), length, 96, 6.0, loading={"depth": path, "stiffness": True})
    curve, theory = curve_of(solved, 1.0), Adhesion(body, 1.0, length / 2, 1.0)
    for spring in (0.0, inf):
        end, true = curve.instability(spring), theory.instability(spring)
        assert end.force == pytest.approx(float(true.force), abs=0.04 * pi)
        assert end.depth == pytest.approx(float(true.depth), abs=0.05)
        assert (end.contact_radius < 0.62) == (true.contact_radius < 0.62)


@pytest.mark.slow
def test_the_grid_follows_the_edge() -> None:
    """A run that sticks holds the flat beyond the lowest force of the round part, -1.18 πwR."""
    depths = 0.01 * np.array([1.0, -1.25, -1.35])
    found = pressed(
        {"type": "paraboloid", "radius": 100.0, "flat_radius": 0.6},
        1.0,
        64,
        6.0,
        interaction={"type": "jkr", "work_of_adhesion": 1e-4},
        loading={"depth": [*depths]},
    )
    stiffness = 1.504754 * pi / 1.688003
    forces = found["force_extrapolated"].values
    assert forces[1:] == pytest.approx(stiffness * depths[1:], rel=0.08)
    assert np.all(np.abs(found["contact_radius"].values[1:] - 0.6) < 0.1)
