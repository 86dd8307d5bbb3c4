"""Loading paths, contact stiffness and prescribed areas, with every solver."""

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.tables_of_runs import ROUGH as ROUGH_PUNCH
from tests.tables_of_runs import half_space, paraboloid, steps, tensed

SKIN, BARE = tensed(1e4, 0.1), half_space(1e4)
SPRINGS = {"type": "winkler", "foundation": 1e8}
SMOOTH: dict[str, Any] = {
    "grid": {"points": 32, "size": 4e-4},
    "kernel": SKIN,
    "indenter": paraboloid(1e-3),
}
ROUGH = SMOOTH | {"grid": {"points": 32, "size": 1e-3}, "indenter": ROUGH_PUNCH}
PERIODIC = ROUGH | {"grid": {"points": 32, "size": 1e-3, "boundary": "periodic"}}
PUNCH = SMOOTH | {"indenter": {"type": "flat_punch", "radius": 1e-4}}
# What is compared here is on the same cells, few or not.
pytestmark = pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
CASES: dict[str, tuple[dict[str, Any], float]] = {
    "paraboloid": (SMOOTH, 2e-5),
    "rough punch": (ROUGH, 6e-5),
    "rough periodic": (PERIODIC, 1.8e-5),
}
THERE_AND_BACK = [0.3, 0.6, 1.0, 0.6, 0.3]


def _solved(
    base: dict[str, Any], solver: str, tolerance: float = 1e-8, **loading: Any
) -> xr.Dataset:
    return steps(solver, tolerance, **base, loading=loading)


@cache
def _path(case: str, solver: str) -> xr.Dataset:
    """Return a case that is loaded and unloaded by depths, with its stiffness."""
    base, deepest = CASES[case]
    depths = [share * deepest for share in THERE_AND_BACK]
    return _solved(base, solver, depth=depths, stiffness=True)


@pytest.mark.parametrize("case", CASES)
def test_unloading_retraces_loading(case: str, solver: str) -> None:
    """Without adhesion there is no hysteresis: the way back is that there, step by step."""
    data = _path(case, solver)
    for back, forth in ((3, 1), (4, 0)):
        for name, relative in (("force", 1e-6), ("contact_area", 0.0), ("stiffness", 1e-6)):
            values = data[name].values
            assert values[back] == pytest.approx(values[forth], rel=relative), name
        pressure = data["pressure"].values
        np.testing.assert_allclose(
            pressure[back], pressure[forth], rtol=0, atol=1e-4 * pressure[forth].max()
        )


@pytest.mark.parametrize("case", CASES)
def test_forces_found_at_depths_return_them(case: str, solver: str) -> None:
    """Prescribing the forces found at given depths returns depths and areas."""
    by_depth = _path(case, solver)
    by_force = _solved(CASES[case][0], solver, force=by_depth["force"].values)
    for name in ("depth", "contact_area"):
        np.testing.assert_allclose(by_force[name], by_depth[name], rtol=1e-3, err_msg=name)


@pytest.mark.parametrize("case", CASES)
def test_stiffness_is_the_slope_of_the_force(case: str, solver: str) -> None:
    """dF/dδ from the solution is the central difference of forces over depths."""
    base, deepest = CASES[case]
    step = 1e-6 * deepest
    data = _solved(base, solver, 1e-11, depth=[deepest - step, deepest + step])
    slope = float(data["force"].diff("step").item()) / (2 * step)
    stiffness = _path(case, solver)["stiffness"].values[2]
    assert stiffness == pytest.approx(slope, rel=1e-3)
    # And so it is when the force is prescribed.
    force = float(_path(case, solver)["force"].values[2])
    again = _solved(base, solver, force=force, stiffness=True)
    assert again["stiffness"].item() == pytest.approx(stiffness, rel=1e-6)


def test_stiffness_under_tension_is_the_exact_one(solver: str) -> None:
    """A paraboloid's dF/dδ is that of the axisymmetric integral equation, within a cell."""
    exact = [indent(Paraboloid(radius=1e-3), 1e4, 0.1, depth=d).force for d in (1.99e-5, 2.01e-5)]
    slope = (exact[1] - exact[0]) / 2e-7
    assert _path("paraboloid", solver)["stiffness"].values[2] == pytest.approx(slope, rel=0.02)


def test_stiffness_of_flat_punches(solver: str) -> None:
    """A flat punch has F = K δ, without tension 2 E* a."""
    for kernel in (SKIN, BARE):
        data = _solved(PUNCH | {"kernel": kernel}, solver, depth=1e-6, stiffness=True)
        stiffness = data["stiffness"].item()
        assert data["force"].item() == pytest.approx(1e-6 * stiffness, rel=1e-7)
    assert stiffness == pytest.approx(2 * 1e4 * 1e-4, rel=0.04)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_stiffness_of_springs(boundary: str, solver: str) -> None:
    """Springs side by side are as stiff as those that are pressed: k A; none, nothing."""
    grid = SMOOTH["grid"] | {"boundary": boundary}
    base = SMOOTH | {"grid": grid, "kernel": SPRINGS}
    data = _solved(base, solver, depth=[0.0, 1e-6, 8e-6], stiffness=True)
    np.testing.assert_allclose(data["stiffness"], 1e8 * data["contact_area"], rtol=1e-7)


def test_stiffness_of_full_contact(solver: str) -> None:
    """Full contact that keeps its mean is rigid; on a layer it yields by G(0)."""
    rigid = _solved(PERIODIC, solver, mean_pressure=1e4, stiffness=True)
    assert rigid["contact"].all()
    assert rigid["stiffness"].item() == np.inf
    layer = {"type": "frictionless_layer", "thickness": 2e-4, "poissons_ratio": 0.3}
    base = PERIODIC | {"kernel": layer | {"reduced_modulus": 1e4}}
    yields = _solved(base, solver, mean_pressure=1e4, stiffness=True)
    assert yields["contact"].all()
    run = pl.Run(**base, loading={"depth": 0})
    expected = run.grid.area / run.kernel.mean_compliance()
    assert yields["stiffness"].item() == pytest.approx(expected, rel=1e-7)


@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
@pytest.mark.parametrize("wanted", [2, 23, 30, 170])
def test_area_on_springs_is_known_cell_by_cell(wanted: int, solver: str) -> None:
    """On springs a cell touches when the indenter is as deep: which areas there are is known."""
    grid = {"points": [21, 24], "size": [2.1e-4, 2.4e-4]}
    base = SMOOTH | {"grid": grid, "kernel": SPRINGS}
    cell = 1e-10
    x, y = pl.Grid(**grid).coordinates()
    # What is the same by symmetry differs by round-off.
    heights = np.round((x**2 + y**2) / 2e-3, 15).ravel()
    data = _solved(base, solver, contact_area=wanted * cell)
    count = round(data["contact_area"].item() / cell)
    touching = [int(np.count_nonzero(heights <= one)) for one in np.unique(heights)]
    assert count in touching
    assert abs(count - wanted) == min(abs(other - wanted) for other in touching)
    # Cells at the same height as the indenter is deep may be counted or not.
    assert np.count_nonzero(heights < data["depth"].item() * (1 - 1e-3)) <= count
    assert np.count_nonzero(heights < data["depth"].item() * (1 + 1e-3)) >= count
    misses = abs(count - wanted) / wanted
    assert data["residual_area"].item() == pytest.approx(misses, abs=1e-9)
    assert ("misses the prescribed one" in data["status"].item()) == (count != wanted)


@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
def test_radius_of_hertz(solver: str) -> None:
    """The force of a given contact radius is Hertz's within the error of counting cells."""
    radius = 1e-4
    base = SMOOTH | {"kernel": BARE, "grid": {"points": 64, "size": 3e-4}}
    data = _solved(base, solver, contact_radius=radius)
    width = data["contact_radius"].item()
    assert width == pytest.approx(radius, rel=0.01)
    assert data["force"].item() == pytest.approx(4 / 3 * 1e4 * radius**3 / 1e-3, rel=0.03)
    assert np.pi * width**2 == pytest.approx(data["contact_area"].item(), rel=1e-12)


@pytest.mark.parametrize("base", [ROUGH, PERIODIC], ids=["free", "periodic"])
def test_areas_of_a_rough_surface(base: dict[str, Any], solver: str) -> None:
    """Areas up and down are met to half a cell, and none is that without load."""
    cell = (1e-3 / 32) ** 2
    cells = [0, 100, 400, 100]
    data = _solved(base, solver, contact_area=[n * cell for n in cells])
    np.testing.assert_allclose(data["contact_area"] / cell, cells, atol=1.01)
    assert data["force"].values[0] == 0
    # A stair is that wide.
    assert data["force"].values[3] == pytest.approx(data["force"].values[1], rel=0.03)


def test_depth_of_the_mean_plane(solver: str) -> None:
    """The same contact, by the depth of the lowest point or of the mean plane of the heights."""
    for base, depth in (ROUGH, 6e-5), (PERIODIC, 1.8e-5):
        run = pl.Run(**base, loading={"depth": depth})
        mean = float(run.indentation.indenter.profile(*run.grid.coordinates()).mean())
        data = _solved(base, solver, mean_plane_depth=depth + mean)
        assert data["mean_plane_depth"].item() == pytest.approx(depth + mean, rel=1e-9)
        assert data["depth"].item() == pytest.approx(depth, rel=1e-12)
        if run.grid.boundary == "periodic":
            # The mean displacement is 0, so the mean gap is the height of the mean plane.
            gap = float(data["gap"].mean())
            assert gap == pytest.approx(-data["mean_plane_depth"].item(), rel=1e-9)


def test_an_area_between_two_numbers_of_cells_is_said_to_be_unresolved() -> None:
    """An area of 4.45 cells is met by 4, within half a cell; no load is to blame for the rest."""
    grid = pl.Grid(points=16, size="0.5 mm")
    tables = {"grid": grid, "kernel": BARE, "loading": {"contact_area": 4.45 * grid.cell_area}}
    with pytest.warns(pl.ConvergenceWarning, match="nothing nearer can be resolved"):
        result = pl.run(SMOOTH | tables, progress=False).dataset
    assert result["contact_area"].item() == pytest.approx(4 * grid.cell_area)
    assert result["status_code"].item() == "AREA"
