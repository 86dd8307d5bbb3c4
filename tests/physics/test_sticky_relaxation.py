"""Contacts that stick: on solids that relax, and a rough punch on springs that jump alone."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle.results.path import path_variables
from tests.adhesive_paths import FORCE, PARABOLOID, pulled_off, relaxing, solved
from tests.tables_of_runs import coated, half_space, heights, layer, pressing

# The units E* = R = w = 1 have slopes beyond the theory, a rough punch few cells in its zone.
pytestmark = pytest.mark.filterwarnings("ignore::pellicle.errors.ConvergenceWarning")

LINEAR: dict[str, Any] = {"type": "linear", "work_of_adhesion": 1.0, "strength": 2.0}


def configuration(**changes: Any) -> dict[str, Any]:
    """Return a run in which a paraboloid is pressed, held and pulled, with changes."""
    depth, time = [0.2, 0.4, 0.4, 0.2, -0.2, -0.6, -0.9], [0.0, 1.0, 9.0, 9.0, 9.5, 10.5, 11.0]
    tables = pressing(24, 6.0, relaxing(), PARABOLOID, depth=depth, time=time)
    return {**tables, "interaction": LINEAR, "outputs": [], **changes}


def test_springs_that_relax_open_as_the_law_softens() -> None:
    """A flat indenter on springs: one equation for the traction, which the law and E(t) share."""
    stiffness, share, time = 5.0, 0.6, 2.0
    depth = np.array([0.1, -0.3, -0.5, -0.5, -0.7])
    times = np.array([0.0, 1.0, 1.5, 1.5, 4.0])
    law = {"type": "linear", "work_of_adhesion": 0.6, "strength": 1.2}
    springs = {"type": "winkler", "foundation": stiffness}
    data = solved(
        8, 0.0, depth.tolist(), size=1.0, boundary="periodic", time=times, interaction=law,
        kernel=relaxing(share, time, springs),
        indenter=heights(np.zeros((8, 8))),
    )  # fmt: skip
    slope = 1.2**2 / (2 * 0.6)
    u = carried = 0.0
    for index, (z, t) in enumerate(zip(depth, times, strict=True)):
        x = (t - times[index - 1]) / time if index else 0.0
        mean = -np.expm1(-x) / x if x else 1.0
        before, old = u, carried
        rest = stiffness * old * np.exp(-x)
        growth = stiffness * share * mean
        permanent = stiffness * (1 - share)
        u = z
        pressure = permanent * u + rest + growth * (u - before)
        if pressure < -1.2:
            # permanent u + rest + growth (u − before) = −1.2 + slope (u − z)
            u = (-1.2 - slope * z - rest + growth * before) / (permanent + growth - slope)
            pressure = -1.2 + slope * (u - z)
        carried = old * np.exp(-x) + share * mean * (u - before)
        np.testing.assert_allclose(data["pressure"][index], pressure, rtol=1e-7)
        np.testing.assert_allclose(data["displacement"][index], u, rtol=1e-7)
    assert data["contact"].values.all(axis=(1, 2)).tolist() == [True, False, False, False, False]


@pytest.mark.parametrize(
    "law",
    [
        LINEAR,
        {"type": "dugdale", "work_of_adhesion": 1.0, "strength": 1.0},
        {"type": "exponential", "work_of_adhesion": 1.0, "range": 0.4},
    ],
    ids=lambda law: law["type"],
)
@pytest.mark.parametrize(("time", "share"), [(1e12, 1.0), (1e-12, 0.2)])
def test_limits_are_elastic(law: dict[str, Any], time: float, share: float) -> None:
    """Slow relaxation leaves the instantaneous solid, fast relaxation the relaxed one, to 1e-7."""
    run = configuration(interaction=law, solver={"type": "active_set", "tolerance": 1e-10})
    run["loading"] = {"depth": [0.2, 0.4, 0.1, -0.3], "time": [0.0, 1.0, 2.0, 3.0]}
    if law["type"] == "dugdale" and share < 1:
        # The drop at its range is spread as the instantaneous solid requires.
        run["interaction"] = {**LINEAR, "strength": 1.0}
    slow = pl.run(run | {"kernel": relaxing(time=time)}, progress=False).dataset
    other = {"kernel": half_space(5.0 * share), "loading": {"depth": run["loading"]["depth"]}}
    elastic = pl.run(run | other, progress=False).dataset
    after = slice(1, None) if share < 1 else slice(None)
    for name in ("force", "contact_area", "zone_area"):
        np.testing.assert_allclose(slow[name][after], elastic[name][after], rtol=1e-7)


@pytest.mark.slow
def test_pull_off_at_a_speed_depends_on_the_range_and_not_on_the_cells() -> None:
    """Fast retraction pulls harder than slow; twice the points change either by 2 % at most."""
    pulls = [[pulled_off(points, speed, LINEAR, 16) for points in (32, 64)] for speed in (0.01, 1)]
    for coarse, fine in pulls:
        assert coarse == pytest.approx(fine, rel=0.02)
    assert pulls[1][1] < 2 * pulls[0][1] < -3 * FORCE


def test_energy_that_the_solid_stores_is_not_known() -> None:
    """After the first step energy and dissipated energy are NaN, and the work is a number."""
    result = pl.run(configuration(), progress=False)
    assert np.isfinite(result.dataset["energy"].values).tolist() == [True] + 6 * [False]
    summary = path_variables(result.dataset)
    assert np.isfinite(summary["work"])
    assert np.isnan(summary["dissipated_energy"])
    legs = [{"to": 0.6, "time": 20.0, "num": 2}]
    first = pl.run(configuration(loading={"depth": legs}), progress=False).dataset
    assert np.isnan(first["energy"].values).all()


@pytest.mark.parametrize(("cells", "message"), [(1.5, "here it is 1.5"), (3.5, "")])
def test_jkr_needs_a_tension_that_the_cells_resolve(cells: float, message: str) -> None:
    """Its range is that of the cells, and the rate decides with the range."""
    tension = 0.5 * 5.0 * cells * 6.0 / 24
    changes = configuration(
        grid={"points": 24, "size": 6.0, "boundary": "periodic"},
        kernel=coated(relaxing(), tension),
        interaction={"type": "jkr", "work_of_adhesion": 1.0},
    )
    if not message:
        assert pl.Run(**changes).interaction
        return
    with pytest.raises(
        pl.ConfigError, match=f"interaction.type: 'jkr'.*linear or dugdale.*{message}"
    ):
        pl.Run(**changes)


POINTS = 20
PATH = [-0.06, 0.0, 0.02, 0.05, 0.1, 0.15, 0.1, 0.05, 0.02, 0.0, -0.06]


def _rough() -> Array:
    x = (np.arange(POINTS) + 0.5) / POINTS - 0.5
    rough = np.random.default_rng(0).normal(size=(POINTS, POINTS))
    heights = 0.02 * rough - x[:, None] ** 2 - 1.3 * x**2
    lowered: Array = heights - heights.max()
    return lowered


def _one_by_one(
    heights: Array, work: float, reach: float, path: Sequence[float]
) -> tuple[list[float], list[int]]:
    """Return force and closed cells on springs of stiffness 1 under a linear law, of slope > 1.

    A gap to the undeformed surface of less than ``reach`` closes; a closed one opens where the
    spring pulls by more than the strength.
    """
    strength = 2 * work / reach
    closed = np.zeros(heights.shape, dtype=bool)
    forces, cells = [], []
    for depth in path:
        stretch = -depth - heights
        closed = (stretch < reach) | (closed & (stretch < strength))
        forces.append(float(-stretch[closed].sum()) / heights.size)
        cells.append(int(closed.sum()))
    return forces, cells


@pytest.mark.parametrize(("work", "reach"), [(1e-3, 0.03), (1e-3, 0.04)])
@pytest.mark.parametrize("turn", [np.s_[:, :], np.s_[::-1, :]])
@pytest.mark.parametrize(
    "kernel",
    [
        {"type": "winkler", "foundation": 1.0},
        # p = M u/h with M = 1.225 E*, on cells five times as wide as the layer is thick.
        layer("bonded_layer", 0.01, 0.3, reduced_modulus=0.01 / 1.225),
    ],
    ids=["springs", "layer"],
)  # fmt: skip
def test_springs_close_and_open_one_by_one(
    kernel: dict[str, Any], turn: tuple[slice, slice], work: float, reach: float
) -> None:
    """Cells jump in and off where their own spring does, there and back, in mirror images too."""
    rough = _rough()
    law = {"type": "linear", "work_of_adhesion": work, "range": reach}
    steps = solved(
        POINTS, 0.0, PATH, size=1.0, kernel=kernel, indenter=heights(rough[turn]), interaction=law
    )
    forces, cells = _one_by_one(rough, work, reach, PATH)
    if kernel["type"] == "winkler":
        assert steps["contact"].values.sum((1, 2)).tolist() == cells
        np.testing.assert_allclose(steps["force"], forces, atol=1e-7 * np.abs(forces).max())
    else:
        # Cells of the layer feel their neighbours a little.
        assert steps["contact"].values.sum((1, 2)) == pytest.approx(cells, abs=3)
