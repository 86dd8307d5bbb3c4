"""Cells too wide for kernel or contact, surfaces of no period and steep slopes are said to be."""

import warnings
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle import Grid
from pellicle.analysis import steepest
from pellicle.runs.compose import warn_of_period
from pellicle.surface import operator_of
from pellicle.surface.influence import error_of_cells, warn_of_cells
from tests.tables_of_runs import half_space, heights, paraboloid, pressing, tensed

THICK = 10e-6


def layer(poissons_ratio: float = 0.5, type_: str = "bonded_layer") -> Any:
    """Return a layer of the thickness `THICK`."""
    fields = {"youngs_modulus": "9 kPa", "poissons_ratio": poissons_ratio, "thickness": THICK}
    return pl.kernel(type_, **fields)


def skin(length: float, bending: float = 0.0) -> Any:
    """Return a skin on a half-space, by 2τ₀/E* and (2B/E*)^⅓ [m]."""
    return pl.kernel(
        "bending_skin", reduced_modulus=1e4, tension=5e3 * length, bending=5e3 * bending**3
    )


@pytest.mark.parametrize("ratio", [0.3, 0.6, 1.0, 3.0])
@pytest.mark.parametrize("poissons_ratio", [0.5, 0.4])
def test_error_is_that_of_the_cells(ratio: float, poissons_ratio: float) -> None:
    """It is how a long wave of cells sinks under the operator, over what the kernel says."""
    kernel, n = layer(poissons_ratio), 129
    grid = pl.Grid(points=n, size=n * THICK / ratio, boundary="free")
    pressure = np.zeros(grid.shape)
    pressure[n // 2, n // 2] = 1.0
    # Far from the edges the line response of one cell, summed up with the wave.
    response = operator_of(kernel, grid)(pressure).sum(axis=1)
    q = 2 * np.pi / (16 * grid.spacing[0])
    total = (response * np.cos(q * grid.coordinates()[0][:, 0])).sum()
    expected = total / kernel.compliance(np.array([q]))[0] - 1
    error = error_of_cells(kernel.compliance, grid.spacing[0])
    assert error == pytest.approx(expected, abs=2e-4)


def test_force_is_as_wrong_as_is_said() -> None:
    """Cells twice as wide as a film is thick: its force against that of cells a fifth as wide."""
    radius, width = 1e-3, 12 * THICK

    def force(points: int) -> float:
        run = pressing(
            points, 3.2 * width, layer(), paraboloid(radius), depth=width**2 / (4 * radius)
        ) | {"solver": {"type": "active_set", "tolerance": 1e-6}}
        return float(pl.run(run, progress=False).dataset["force"][0])

    with pytest.warns(UserWarning, match=r"grid\.points: cells of .* by 12% more .* use about"):
        coarse = force(19)
    error = error_of_cells(layer().compliance, 3.2 * width / 19)
    assert coarse / force(96) * (1 + error) == pytest.approx(1, abs=0.03)


@pytest.mark.parametrize("ratio", [0.12, 0.2, 0.3, 0.5, 0.8])
def test_films_thinner_than_a_cell_are_warned_of(ratio: float) -> None:
    """The number of points that is recommended is enough, and four fifths of it are not."""
    spacing = THICK / ratio
    grid = pl.Grid(points=40, size=40 * spacing, boundary="free")
    with pytest.warns(UserWarning, match=r"use about \d+ × \d+ points$") as result:
        pl.displacement(np.ones(grid.shape), kernel=layer(), grid=grid)
    recommended = int(str(result[0].message).split(" × ")[-1].split()[0])
    finer = 40 * spacing / recommended
    assert abs(error_of_cells(layer().compliance, finer)) < 0.03
    assert abs(error_of_cells(layer().compliance, finer / 0.8)) > 0.03


@pytest.mark.parametrize("ratio", [1e-3, 0.03, 0.1, 0.3, 1.0, 3.0, 30.0, 1e3])
@pytest.mark.parametrize(
    "make",
    {
        "tension": skin,
        "bending": lambda length: skin(0.0, length),
        "both": lambda length: skin(length, length),
        "springs": lambda _: pl.kernel("winkler", foundation="1 GPa/m"),
        "slips": lambda length: layer(0.5, "frictionless_layer").model_copy(
            update={"thickness": length}
        ),
        "compressible": lambda length: layer(0.4).model_copy(update={"thickness": length}),
    }.values(),
)
def test_no_other_length_under_a_cell_is_warned_of(make: Any, ratio: float) -> None:
    """A skin that the cells do not resolve is the half-space, a compressible layer is springs."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_cells(make(ratio * 1e-5).compliance, pl.Grid(points=16, size=16e-5))


def test_periodic_boundaries_sample_the_kernel_itself() -> None:
    """No warning: each wave has the compliance that the kernel says."""
    grid = pl.Grid(points=16, size=16 * 3 * THICK, boundary="periodic")
    wave = np.cos(2 * np.pi * np.arange(16) / 16)[:, None] + np.zeros((16, 16))
    q = 2 * np.pi / grid.size[0]
    result = pl.displacement(wave, kernel=layer(), grid=grid)
    np.testing.assert_allclose(result, layer().compliance(np.array([q]))[0] * wave, atol=1e-18)


def test_kernel_that_overflows_at_short_waves_is_not_judged() -> None:
    """A closed form needs its symbol at the waves of the grid only."""
    error = error_of_cells(lambda q: np.sinh(q * 1e-5) / np.cosh(q * 1e-5), 1e-6)
    assert np.isnan(error)
    warn_of_cells(lambda q: np.full_like(q, np.nan), pl.Grid(points=16, size=1e-3))


PERIODIC = pl.Grid(points=[24, 32], size=["0.6 mm", "0.8 mm"], boundary="periodic")
X, Y = PERIODIC.coordinates()


def test_a_tilted_surface_is_no_period() -> None:
    """The step is that of the tilt, along the axis that it is along."""
    with pytest.warns(UserWarning, match=r"along y: .* step of 775 µm .* 25 µm") as warning:
        warn_of_period(np.broadcast_to(Y, PERIODIC.shape), PERIODIC)
    assert len(warning) == 1


@pytest.mark.parametrize("seed", range(5))
def test_what_is_a_period_is_silent(seed: int) -> None:
    """Rough surfaces made periodic, waves, noise and single peaks on the seam have no seam."""
    rough = pl.indenter(
        "self_affine", rms_height=1e-6, hurst=0.8, cutoff_wavelength=1e-4, seed=seed
    )
    noise = np.random.default_rng(seed).standard_normal(PERIODIC.shape)
    wave = np.sin(2 * np.pi * (X / 6e-4 + Y / 8e-4) + seed)
    peak = np.exp(-(((np.abs(X) - 3e-4) ** 2 + (np.abs(Y) - 4e-4) ** 2) / 1e-9))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for heights in (rough.profile(X, Y), noise, wave, peak):
            warn_of_period(heights, PERIODIC)


def test_a_free_grid_has_no_seam() -> None:
    """There nothing goes on beyond the edge."""
    free = pl.Grid(points=PERIODIC.points, size=PERIODIC.size)
    warn_of_period(np.broadcast_to(Y, free.shape), free)


GRID = Grid(points=(40, 60), size=(2.0, 2.4))
AT_X, AT_Y = np.broadcast_arrays(*(axis - axis.mean() for axis in GRID.coordinates()))


@pytest.mark.parametrize("angle", np.deg2rad([0.0, 20.0, 45.0, 70.0, 90.0]))
def test_slope_of_a_roof_at_any_angle(angle: float) -> None:
    """A plane slopes by the same in any direction, on cells that are not square, too."""
    roof = -0.35 * np.abs(np.cos(angle) * AT_X + np.sin(angle) * AT_Y)
    assert steepest(roof, AT_X < 9, GRID) == pytest.approx(0.35, rel=1e-9)


def test_slope_of_a_paraboloid_is_that_at_its_rim() -> None:
    """Less than half a cell inside of r/R."""
    contact = AT_X**2 + AT_Y**2 < 0.7**2
    assert 0.66 / 3 < steepest(-(AT_X**2 + AT_Y**2) / 6, contact, GRID) < 0.7 / 3


def test_contacts_of_few_cells_have_the_slopes_between_them() -> None:
    """A row has those along it, cells apart from each other none, nor has the ground beside."""
    heights = -np.abs(AT_X)
    heights[~np.isclose(np.abs(AT_Y), 0.02)] = -np.inf
    assert steepest(heights, np.isfinite(heights), GRID) == pytest.approx(1.0)
    assert steepest(heights, np.isclose(AT_X, 0.025) & np.isfinite(heights), GRID) == 0.0
    assert steepest(heights, np.zeros(GRID.shape, dtype=bool), GRID) == 0.0


@pytest.mark.parametrize("degrees", [0.0, 45.0])
def test_a_turned_pyramid_is_as_steep(degrees: float) -> None:
    """A pyramid whose sides slope by 0.35 is beyond the theory at any angle."""
    x = (np.arange(32) + 0.5) / 16 - 1
    angle = np.deg2rad(degrees)
    one = np.cos(angle) * x[:, None] + np.sin(angle) * x
    other = np.cos(angle) * x - np.sin(angle) * x[:, None]
    pyramid = -0.35 * np.maximum(np.abs(one), np.abs(other))
    with pytest.warns(pl.ConvergenceWarning, match=r"slopes in contact reach 0\.35"):
        result = pl.run(
            pressing(32, 2.0, half_space(), heights(pyramid), depth=0.15)
            | {"interaction": {"type": "jkr", "work_of_adhesion": 1e-3}},
            progress=False,
        )
    assert [step for step, _ in result.steep()] == [1]


def test_a_step_between_any_two_rows_counts() -> None:
    """The slope is the largest of blocks of rows, each of which holds the first row of the next."""
    grid = Grid(points=(300, 400), size=(3.0, 4.0))
    for row in range(1, 300):
        heights = np.zeros(grid.shape)
        heights[row:, 7] = -0.004
        contact = np.zeros(grid.shape, dtype=bool)
        contact[row - 1 : row + 1, 7] = True
        assert steepest(heights, contact, grid) == pytest.approx(0.4)


def test_slope_at_the_rim_of_a_contact_that_sticks() -> None:
    """Under a tension τ₀ the surface meets the indenter at √(2w/τ₀), whatever the indenter is."""
    run = pressing(32, 4.0, tensed(1.0, 1.0), paraboloid(2.0), depth=[0.03, -0.05]) | {
        "interaction": {"type": "jkr", "work_of_adhesion": 0.5 * 0.35**2}
    }
    with pytest.warns(pl.ConvergenceWarning, match=r"slopes in contact reach 0\.35"):
        pl.run(run, progress=False)


RADIUS, MODULUS = 1e-3, 1e4
POINTS, SIZE = 32, 5e-4
COARSE = "too coarse for this contact"


def pressed(points: Any = POINTS, indenter: Any = None, **loading: Any) -> pl.Result:
    """Return a paraboloid, or another indenter, on a half-space."""
    run = pressing(points, SIZE, half_space(MODULUS), indenter or paraboloid(RADIUS), **loading)
    return pl.run(run, progress=False)


def hertz(depths: Any) -> Any:
    """Return the force [N]."""
    return 4 / 3 * MODULUS * RADIUS**0.5 * np.asarray(depths) ** 1.5


@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
@pytest.mark.parametrize("points", [POINTS, POINTS + 1])
def test_what_is_not_said_to_be_coarse_is_good(points: int) -> None:
    """Of contacts about a grid point or about a cell those without a word are good to 3 %."""
    depths = (np.linspace(0.1, 4, 40) * SIZE / points) ** 2 / RADIUS
    result = pressed(points, depth=depths)
    coarse = [step - 1 for step, _ in result.coarse()]
    error = np.abs(result.dataset["force"].values / hertz(depths) - 1)
    assert result.converged
    assert np.delete(error, coarse).max() < 0.03
    assert error[coarse].max() > 0.5
    # The words come with few cells only, so not for ever.
    assert coarse == list(range(len(coarse)))
    assert len(coarse) < 25


def test_a_contact_between_the_cells_is_warned_of() -> None:
    """A depth at which no cell touches makes no force, and is not passed over in silence."""
    with pytest.warns(pl.ConvergenceWarning, match=f"step 1 and 1 more: .*{COARSE}.* none of them"):
        result = pressed(depth=[1e-9, 2e-9, 2e-5])
    assert result.dataset["force"].values[0] == 0
    assert [step for step, _ in result.coarse()] == [1, 2]


def test_no_load_is_not_coarse() -> None:
    """Nothing prescribed is nothing to resolve, and without force the lowest point just touches."""
    result = pressed(force=["20 uN", 0])
    assert list(result.dataset["status"].values) == ["converged", "converged"]
    assert result.dataset["depth"].values[1] == 0
    assert pressed(depth=0).dataset["status"].item() == "converged"


ONE_LINE = heights(-(np.linspace(-1e-2, 1e-2, 64)[:, None] ** 2))


@pytest.mark.parametrize(
    ("points", "indenter"),
    [
        (1, {}),
        ([1, 64], {}),
        ([64, 1], {}),
        ([64, 1], ONE_LINE),
        ([64, 1], {"type": "sum", "parts": [paraboloid(1e-3), ONE_LINE]}),
    ],
)
def test_a_free_grid_one_cell_wide_has_an_edge(points: Any, indenter: dict[str, Any]) -> None:
    """The contact reaches beyond a strip of cells, and beyond a single one."""
    words = "reaches the edge" if points == 1 else 'give grid.boundary = "periodic"'
    with pytest.warns(pl.ConvergenceWarning, match=words):
        result = pressed(points, indenter=indenter, depth=2e-5)
    code = "CONTACT_AT_EDGE" if points == 1 else "STRIP"
    assert result.dataset["status_code"].item() == code


@pytest.mark.parametrize(
    ("x", "y"), [(-0.45, 0.0), (0.45, 0.0), (0.0, -0.45), (0.0, 0.45), (-0.9, 0.0), (0.0, 0.9)]
)
def test_each_edge_of_a_free_domain_is_one(x: float, y: float) -> None:
    """A contact that leaves by one edge alone, or lies beyond it, is told; turned, it is equal."""
    shifted = {"type": "shifted", "x": x * SIZE, "y": y * SIZE, "part": paraboloid(RADIUS)}
    is_beyond = max(abs(x), abs(y)) > 0.5
    words = "lowest point of the indenter lies outside" if is_beyond else "reaches the edge"
    with pytest.warns(pl.ConvergenceWarning, match=words):
        result = pressed(indenter=shifted, depth=2e-5)
    code = "BEYOND_EDGE" if is_beyond else "CONTACT_AT_EDGE"
    assert result.dataset["status_code"].item() == code


def test_a_zone_that_reaches_the_edge_has_words_of_its_own() -> None:
    """Without contact it is the zone that needs room; with room the same is said of neither."""
    run = pressing(10, 1.0, half_space(), paraboloid(10.0), depth=-0.5) | {
        "interaction": {"type": "dugdale", "work_of_adhesion": 1e-4, "range": 1.0}
    }
    for boundary in ("free", "periodic"):
        grid = {**run["grid"], "boundary": boundary}
        with pytest.warns(pl.ConvergenceWarning, match="the zone in which the interaction pulls"):
            data = pl.run({**run, "grid": grid}, progress=False).dataset
        assert data["status_code"].item() == "ZONE_AT_EDGE"
        assert not data["contact"].any()
        data = pl.run({**run, "grid": {**grid, "points": 24, "size": 12.0}}, progress=False).dataset
        assert data["converged"].all()
