"""What must not change when the problem is turned, mirrored, scaled or split."""

from typing import Any, Literal

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import pellicle as pl
from pellicle.components import profile_of
from tests.tables_of_runs import heights, pressing, self_affine, step, steps, tensed

TOLERANCE = 1e-9


def _step(run: dict[str, Any], solver: str) -> xr.Dataset:
    return step(solver, TOLERANCE, **run)


def _quadric(
    radius_x: float,
    radius_y: float,
    boundary: str = "free",
    length: float = 1.0,
    modulus: float = 1.0,
) -> dict[str, Any]:
    """Return the run of a quadric, with lengths and moduli in given units."""
    shape = {"type": "quadric", "radius_x": radius_x * length, "radius_y": radius_y * length}
    skin, force = tensed(modulus, 0.02 * modulus * length), 2e-4 * modulus * length**2
    return pressing(48, 0.4 * length, skin, shape, boundary=boundary, force=force)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_a_quadric_turned_by_90_degrees(boundary: str, solver: str) -> None:
    """Swapping its radii transposes the pressure and leaves force, depth and area alone."""
    one = _step(_quadric(1.0, 2.0, boundary), solver)
    other = _step(_quadric(2.0, 1.0, boundary), solver)
    assert float(one["depth"]) == pytest.approx(float(other["depth"]), rel=1e-8)
    assert float(one["contact_area"]) == float(other["contact_area"])
    highest = one["pressure"].values.max()
    np.testing.assert_allclose(
        one["pressure"].values, other["pressure"].values.T, atol=1e-6 * highest
    )


def test_mirror_images_have_mirrored_pressures(solver: str) -> None:
    """A rough punch and its mirror images have the same force and mirrored pressures."""
    grid = {"points": [40, 32], "size": [1.0, 0.8]}
    fine = pl.Grid(**grid)
    rough = pl.indenter("self_affine", rms_height=0.01, hurst=0.8, cutoff_wavelength=0.1, seed=3)
    profile = rough.profile(*fine.coordinates())
    pressures = []
    for turn in (np.s_[:, :], np.s_[::-1, :], np.s_[:, ::-1]):
        tables = {"grid": grid, "kernel": tensed(1.0, 0.01), "loading": {"depth": 0.02}}
        mirrored = _step({**tables, "indenter": heights(profile[turn])}, solver)
        pressures.append(mirrored["pressure"].values[turn])
    for pressure in pressures[1:]:
        np.testing.assert_allclose(pressure, pressures[0], atol=1e-6 * pressures[0].max())


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_the_operator_is_linear_symmetric_and_positive(boundary: str) -> None:
    """A(αp + q) = αAp + Aq, ⟨Ap, q⟩ = ⟨p, Aq⟩ and ⟨Ap, p⟩ > 0 to round-off."""
    grid = pl.Grid(points=[15, 22], size=[1.0, 2.0], boundary=boundary)
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=0.1)
    p, q = np.random.default_rng(1).normal(size=(2, *grid.shape))
    ap, aq, both = (pl.displacement(v, kernel=kernel, grid=grid) for v in (p, q, 3 * p + q))
    np.testing.assert_allclose(both, 3 * ap + aq, atol=1e-14)
    assert np.vdot(ap, q) == pytest.approx(np.vdot(p, aq), rel=1e-12)
    assert np.vdot(ap, p) > 0


def test_an_isolated_contact_does_not_see_its_domain(solver: str) -> None:
    """On a free boundary a larger domain with the same cells changes nothing."""
    small, large = _quadric(1.0, 1.0), _quadric(1.0, 1.0)
    large["grid"] = {"points": 64, "size": 0.4 * 64 / 48}
    one, other = _step(small, solver), _step(large, solver)
    assert float(one["depth"]) == pytest.approx(float(other["depth"]), rel=1e-8)
    np.testing.assert_allclose(
        one["pressure"].values,
        other["pressure"].values[8:-8, 8:-8],
        atol=1e-6 * one["pressure"].values.max(),
    )


def test_a_wide_periodic_cell_comes_near_the_free_boundary() -> None:
    """The stiffness between two loads is that of an isolated contact once the images are far."""
    stiffness = {}
    for boundary, width in (("free", 1), ("periodic", 1), ("periodic", 4)):
        run = _quadric(1.0, 1.0, boundary)
        run["grid"] = {"points": 32 * width, "size": 0.4 * width, "boundary": boundary}
        run["loading"] = {"force": [2e-4, 2.4e-4]}
        depth = steps(**run)["depth"].values
        stiffness[boundary, width] = 4e-5 / (depth[1] - depth[0])
    free = stiffness["free", 1]
    near, far = stiffness["periodic", 1] / free - 1, stiffness["periodic", 4] / free - 1
    assert abs(far) < 0.35 * abs(near)


CELLS, PERIODIC = 20, pl.Grid(points=20, size=1.0, boundary="periodic")
ROUGH: dict[str, Any] = self_affine(0.005, 0.8, 0.2)


def _moved(body: dict[str, Any], x: float, y: float) -> dict[str, Any]:
    return {"type": "shifted", "x": x, "y": y, "part": body}


BEAD: dict[str, Any] = {"type": "paraboloid", "radius": 2.0}
BODIES: dict[str, dict[str, Any]] = {
    "paraboloid": BEAD,
    "sphere": {"type": "sphere", "radius": 0.9},
    "blunt cone": {"type": "cone", "half_angle": 1.3, "tip_radius": 0.1},
    "flat punch": {"type": "flat_punch", "radius": 0.31},
    "quadric": {"type": "quadric", "radius_x": 2.0, "radius_y": 3.0},
    "four sides": {"type": "pyramid", "half_angle": 1.3},
    "three sides": {"type": "pyramid", "half_angle": 1.3, "sides": 3},
    "turned": {
        "type": "rotated",
        "angle": 0.5,
        "part": _moved({"type": "quadric", "radius_x": 1.0, "radius_y": 3.0}, 0.3, 0.2),
    },
    "beads apart": {"type": "sum", "parts": [BEAD, _moved(BEAD, 0.1, 0.0)]},
    "rough bead": {"type": "sum", "parts": [_moved(BEAD, 0.45, -0.4), ROUGH]},
    "rough": ROUGH,
    "heights": heights(0.01 * np.random.default_rng(1).random((CELLS, CELLS))),
    "half as rough": {"type": "scaled", "factor": 0.5, "part": ROUGH},
}
LOADS: dict[str, dict[str, Any]] = {
    "depth": {"depth": 0.004},
    "mean plane": {"mean_plane_depth": -0.0015},
    "force": {"force": 2e-3},
    "mean pressure": {"mean_pressure": 2e-3},
    "radius": {"contact_radius": 0.2},
    "area": {"contact_area": 0.1},
    "cantilever": {"base_displacement": 0.02, "spring_constant": 0.1},
    "gap volume": {"gap_volume": 0.002},
}


@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
@pytest.mark.parametrize("load", LOADS)
@settings(max_examples=10, deadline=None, derandomize=True)
@given(
    name=st.sampled_from([*BODIES]),
    x=st.integers(-CELLS, CELLS),
    y=st.integers(-2 * CELLS, CELLS),
)
def test_a_periodic_problem_has_no_origin(load: str, name: str, x: int, y: int) -> None:
    """Force, depth, area, gap and status of a body are those of the same body moved by cells."""
    edge = PERIODIC.spacing[0]
    run = {
        "grid": PERIODIC,
        "kernel": tensed(1.0, 0.05),
        "loading": LOADS[load],
        "solver": {"type": "active_set", "tolerance": 1e-11},
        "outputs": [],
    }
    bodies = BODIES[name], _moved(BODIES[name], x * edge, y * edge)
    try:
        one = pl.run({**run, "indenter": bodies[0]}, progress=False).dataset
    except pl.ConfigError as refusal:
        # What is out of reach of a body stays so wherever it is.
        with pytest.raises(pl.ConfigError, match=f"^{refusal.problems[0].field}"):
            pl.run({**run, "indenter": bodies[1]}, progress=False)
        return
    other = pl.run({**run, "indenter": bodies[1]}, progress=False).dataset
    assert other["status_code"].item() == one["status_code"].item()
    for quantity in ("force", "depth", "contact_area"):
        assert other[quantity].item() == pytest.approx(one[quantity].item(), rel=1e-9)
    gaps = [data["gap"].values[0] for data in (one, other)]
    assert gaps[1].mean() == pytest.approx(gaps[0].mean(), rel=1e-9)
    np.testing.assert_allclose(gaps[1], np.roll(gaps[0], (x, y), (0, 1)), atol=1e-9)


class Bump(pl.Indenter):
    """A stranger's paraboloid, which has its place among its own fields."""

    type: Literal["bump"] = "bump"
    x: float = 0.0

    def profile(self, x: Any, y: Any) -> Any:
        return -((x - self.x) ** 2 + y**2) / 4


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(["paraboloid", "blunt cone", "flat punch", "quadric", "four sides"]),
    x=st.integers(-2500, 2500).map(lambda share: share / 1000),
    y=st.integers(-2500, 2500).map(lambda share: share / 1000),
)
def test_a_body_anywhere_is_its_nearest_image(name: str, x: float, y: float) -> None:
    """Its profile is that at the distance from its nearest image, half a period off at most."""
    body: Any = pl.Run(
        grid=PERIODIC,
        kernel=tensed(1.0, 0.05),
        indenter=_moved(BODIES[name], x, y),
        loading={"depth": 0.01},
    ).indenter
    near = [c - v - np.round(c - v) for c, v in zip(PERIODIC.coordinates(), (x, y), strict=True)]
    np.testing.assert_allclose(
        profile_of(body, PERIODIC), body.part.profile(*near), rtol=0, atol=1e-14
    )


@pytest.mark.parametrize("x", [-0.5, -0.13, 0.25, 0.5])
def test_the_place_of_a_strangers_body(x: float) -> None:
    """A body that moves itself is the nearest image too, though nothing says where it is."""
    along, across = PERIODIC.coordinates()
    near = along - x - np.round(along - x)
    np.testing.assert_allclose(
        profile_of(Bump(x=x), PERIODIC), Bump().profile(near, across), rtol=0, atol=1e-15
    )


def test_bodies_that_repeat_are_moved_where_they_repeat() -> None:
    """Heights move by whole cells of a periodic grid, a series by any share; on a free one none."""
    half = 0.5 * PERIODIC.spacing[0]
    free = pl.Grid(points=CELLS, size=1.0)
    for name in ("rough", "heights"):
        run = {"kernel": tensed(1.0, 0.05), "loading": {"depth": 0.01}}
        body: Any = pl.Run(grid=PERIODIC, indenter=_moved(BODIES[name], half, 0.0), **run).indenter
        with pytest.raises(pl.ConfigError, match="move the other parts of a sum"):
            profile_of(body, free)
        if name == "heights":
            with pytest.raises(pl.ConfigError, match=r"^indenter\.part: .* no whole number"):
                profile_of(body, PERIODIC)
            continue
        twice = pl.Grid(points=2 * CELLS, size=1.0, boundary="periodic")
        # The cells of the moved body are every second of a grid twice as fine.
        fine = profile_of(body.part, twice)
        np.testing.assert_allclose(
            profile_of(pl.indenter("shifted", x=half / 2, y=half / 2, part=body.part), PERIODIC),
            fine[::2, ::2],
            rtol=0,
            atol=1e-15,
        )
