"""Indenters made of others."""

import json
import tomllib
from math import pi
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from tests.plugins.outputs.shared import bead
from tests.tables_of_runs import self_affine

SIZE = 1e-3
ROUGH = self_affine("2 um", 0.7, "0.2 mm", seed=4)
QUADRIC = {"type": "quadric", "radius_x": "1 mm", "radius_y": "4 mm"}


def grid(points: int = 32) -> pl.Grid:
    """Return a grid; the centre of an even one is no cell's."""
    return pl.Grid(points=points, size=SIZE)


def _profile(indenter: pl.Indenter, points: int = 32) -> np.ndarray:
    return indenter.profile(*grid(points).coordinates())


def _solve(indenter: dict[str, Any], points: int, **loading: object) -> pl.Result:
    kernel = {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "1 N/m"}
    size = {"points": points, "size": SIZE}
    run = bead(grid=size, kernel=kernel, indenter=indenter, loading=loading)
    return pl.run(run, progress=False)


def test_run_of_sphere_and_zero_roughness_is_that_of_the_sphere() -> None:
    """Force and pressure are the sphere's own, to the last bit."""
    sphere = {"type": "sphere", "radius": "1 mm"}
    flat = {"type": "scaled", "factor": 0, "part": ROUGH}
    alone = _solve(sphere, 32, depth="20 um").dataset
    both = _solve({"type": "sum", "parts": [sphere, flat]}, 32, depth="20 um").dataset
    assert np.array_equal(both["pressure"], alone["pressure"])
    assert both["force"] == alone["force"]


def test_paraboloids_add_their_curvatures() -> None:
    """Two coaxial paraboloids are one of 1/R = 1/R₁ + 1/R₂, on any grid."""
    two = pl.indenter(
        "sum",
        parts=[{"type": "paraboloid", "radius": 1e-3}, {"type": "paraboloid", "radius": 3e-3}],
    )
    one = pl.indenter("paraboloid", radius=0.75e-3)
    assert two.footprint == "unbounded"
    for points in (31, 32):
        assert _profile(two, points) == pytest.approx(_profile(one, points), rel=1e-13)


def test_paraboloids_apart_are_one_between_them() -> None:
    """Of two paraboloids apart the sum is one whose lowest point, no cell, lies between them.

    −((x − a)² + (x + a)²)/2R = −x²/R − a²/R for equal ones; the lowest point is found to rounding.
    """
    a = 0.11e-3
    apart = pl.indenter(
        "sum",
        parts=[
            {
                "type": "shifted",
                "x": sign * a + 1e-5,
                "part": {"type": "paraboloid", "radius": 1e-3},
            }
            for sign in (-1, 1)
        ],
    )
    one = pl.indenter("shifted", x=1e-5, part={"type": "paraboloid", "radius": 0.5e-3})
    # Of heights up to 5e-4 m.
    assert _profile(apart) == pytest.approx(_profile(one), rel=0, abs=1e-18)


def test_cones_apart_have_a_ridge() -> None:
    """A lowest point with a kink is found too: equal cones apart are lowest all between them."""
    cone = {"type": "cone", "half_angle": pi / 4}
    apart = pl.indenter(
        "sum", parts=[{"type": "shifted", "part": cone, "x": x} for x in (-1e-4, 1e-4)]
    )
    x, y = grid().coordinates()
    exact = 2e-4 - np.hypot(x - 1e-4, y) - np.hypot(x + 1e-4, y)
    assert _profile(apart) == pytest.approx(exact, rel=0, abs=1e-16)


def test_lowest_point_is_off_by_what_cells_hide() -> None:
    """The lowest point of a rough sphere is that of a fine grid to O(h²), as those of its parts."""
    both = pl.indenter("sum", parts=[{"type": "sphere", "radius": "1 mm"}, ROUGH])
    assert both.footprint == "domain"
    fine = _profile(both, 729)
    assert -1e-10 < fine.max() <= 0
    curvature = 2e-6 * (2 * pi / 0.2e-3) ** 2
    for points in (27, 81, 243):
        step = 729 // points
        shared = fine[step // 2 :: step, step // 2 :: step]
        bound = curvature * (SIZE / points) ** 2 / 8
        assert abs(_profile(both, points) - shared).max() < bound


def test_turned_quadric_gives_the_turned_result() -> None:
    """A quadric turned by 30° gives force and area of the quadric, and its contact turned."""
    turned = {"type": "rotated", "angle": "30 degree", "part": QUADRIC}
    plain, other = (_solve(entry, 256, depth="20 um").dataset for entry in (QUADRIC, turned))
    assert float(other["force"][0]) == pytest.approx(float(plain["force"][0]), rel=2e-5)
    areas = [float(entry["contact_area"][0]) for entry in (plain, other)]
    # 1 in 18 cells in contact lies at the edge.
    assert areas[1] == pytest.approx(areas[0], rel=0.01)
    assert _axis(plain) == pytest.approx(pi / 2, abs=1e-9)
    assert _axis(other) == pytest.approx(pi / 2 + pi / 6, abs=2e-3)


def _axis(data: Any) -> float:
    """Return the angle of the longer axis of the pressure [rad], by its second moments."""
    p = data["pressure"][0]
    x, y = data["x"], data["y"]
    xx, yy, xy = (float((p * entry).sum()) for entry in (x * x, y * y, x * y))
    return float(np.arctan2(2 * xy, xx - yy) / 2 % pi)


def test_shift_moves_the_result() -> None:
    """A punch moved by whole cells gives the same pressure, moved."""
    cells = 3
    moved = {"type": "shifted", "x": cells * SIZE / 32, "part": QUADRIC}
    plain, other = (_solve(entry, 32, depth="10 um").dataset for entry in (QUADRIC, moved))
    expected = np.roll(plain["pressure"].values, cells, axis=1)
    scale = expected.max()
    assert other["pressure"].values == pytest.approx(expected, rel=0, abs=1e-6 * scale)


def test_scaled_paraboloid() -> None:
    """Heights times two are those of half the radius; a punch keeps its end."""
    doubled = pl.indenter("scaled", factor=2, part={"type": "paraboloid", "radius": "1 mm"})
    half = pl.indenter("paraboloid", radius="0.5 mm")
    assert _profile(doubled) == pytest.approx(_profile(half), rel=1e-15)
    punch = pl.indenter("scaled", factor=0, part={"type": "flat_punch", "radius": "0.3 mm"})
    assert set(np.unique(_profile(punch))) == {-np.inf, 0.0}


def _run(indenter: dict[str, Any]) -> pl.Run:
    grid = {"points": 24, "size": SIZE}
    return pl.Run(**bead(grid=grid, indenter=indenter, loading={"depth": "1 um"}))


def test_part_that_does_not_fit_the_grid_is_named() -> None:
    """An error on the grid has the path of the part, through every level."""
    heights = {"type": "scaled", "factor": 2, "part": pl.indenter("heights", values=[[1]], unit=1)}
    with pytest.raises(
        pl.ConfigError, match=r"^indenter\.parts\.1\.part\.values: .* shape \(1, 1\)"
    ):
        pl.run(_run({"type": "sum", "parts": [QUADRIC, heights]}), progress=False)


NESTED = """
[indenter]
type = "sum"
[[indenter.parts]]
type = "rotated"
angle = "30 degree"
part = { type = "quadric", radius_x = "1 mm", radius_y = "4 mm" }
[[indenter.parts]]
type = "scaled"
factor = 0.5
[indenter.parts.part]
type = "self_affine"
rms_height = "400 nm"
hurst = 0.7
cutoff_wavelength = "0.2 mm"
"""


def test_nested_parts_of_a_file() -> None:
    """They take units, are recorded in SI, defaults included, and are the same after TOML, JSON."""
    run = pl.Run(**bead(**tomllib.loads(NESTED)))
    turned, scaled = json.loads(run.to_json())["indenter"]["parts"]
    assert turned["angle"] == pytest.approx(pi / 6)
    assert turned["part"] == {"type": "quadric", "radius_x": 1e-3, "radius_y": 4e-3}
    assert scaled["part"]["rms_height"] == 4e-7
    assert scaled["part"]["seed"] == 0
    assert pl.Run.from_json(run.to_json()) == run
    assert pl.Run(**tomllib.loads(run.to_toml())) == run
    assert hash(pl.Run.from_json(run.to_json()).indenter) == hash(run.indenter)
