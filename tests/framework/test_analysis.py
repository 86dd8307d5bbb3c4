"""Analysis of contact: closed forms of shapes, surfaces and contacts that have one."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import pellicle as pl
from pellicle.analysis import (
    coordination,
    distribution,
    ellipse,
    extrapolate,
    patches,
    perimeter,
    spectrum,
)
from pellicle_plugins.closed_forms import hertz
from tests.tables_of_runs import half_space, pressing, self_affine, tensed

HALF_SPACE = half_space("10 kPa")


def square(points: int = 24, boundary: str = "free", **fields: Any) -> pl.Grid:
    """Return a grid of cells of 1 m."""
    return pl.Grid(**{"points": points, "size": float(points), "boundary": boundary, **fields})


def filled(grid: pl.Grid, semi_x: float, semi_y: float, angle: float = 0.0) -> np.ndarray:
    """Return the cells in an ellipse about the centre."""
    x, y = grid.coordinates()
    along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
    return np.asarray((along / semi_x) ** 2 + (across / semi_y) ** 2 <= 1)


@pytest.fixture(scope="module", params=["free", "periodic"])
def rough(request: pytest.FixtureRequest) -> pl.Result:
    """Return rough contact, of which the last step has several patches."""
    punch, skin = self_affine("10 um", 0.5, "0.15 mm", seed=2), tensed("10 kPa", "10 mN/m")
    depths = ["8 um", "15 um"]
    run = pressing(48, "1 mm", skin, punch, boundary=request.param, depth=depths)
    return pl.run(run, progress=False)


@pytest.fixture(scope="module")
def elliptic() -> pl.Result:
    """Return the contact of an elliptic paraboloid without tension."""
    quadric = {"type": "quadric", "radius_x": "1 mm", "radius_y": "2 mm"}
    run = pressing(48, "0.8 mm", HALF_SPACE, quadric, depth=["0 um", "50 um"])
    return pl.run(run, progress=False)


def test_patches_sum_to_the_contact(rough: pl.Result) -> None:
    """Areas and forces of the patches are those of the contact; the table counts them."""
    for index in range(2):
        step = rough.dataset.isel(step=index)
        result = patches(step["contact"], rough.grid)
        assert result.count == step["patches"] >= 2
        assert result.area.sum() == pytest.approx(step["contact_area"].item(), rel=1e-12)
        assert np.array_equal(result.labels > 0, step["contact"])
        assert (np.diff(result.area) <= 0).all()
        cells = np.bincount(result.labels.ravel())[1:]
        np.testing.assert_allclose(cells * rough.grid.cell_area, result.area, rtol=1e-12)


def test_no_two_patches_touch(rough: pl.Result) -> None:
    """Cells in contact that share an edge are of one patch, across periodic edges too."""
    labels = patches(rough.dataset["contact"][-1], rough.grid).labels
    for axis in (0, 1):
        here, opposite = labels, np.roll(labels, 1, axis)
        if rough.grid.boundary == "free":
            here, opposite = (np.delete(side, 0, axis) for side in (here, opposite))
        both = (here > 0) & (opposite > 0)
        assert both.any()
        assert np.array_equal(here[both], opposite[both])


@pytest.mark.parametrize(
    ("boundary", "connectivity", "count"),
    [("free", 4, 5), ("free", 8, 5), ("periodic", 4, 3), ("periodic", 8, 2)],
)
def test_patches_across_the_edge(boundary: str, connectivity: Any, count: int) -> None:
    """The edges of a periodic domain lie against each other; those of a free one do not."""
    rows = (
        "#....#",
        "......",
        "..#...",
        "......",
        ".....#",
        "#.....",
    )
    contact = np.array([[cell == "#" for cell in row] for row in rows])
    # Across the edge the three at the corners are one, and the fourth touches them at a corner.
    assert patches(contact, square(6, boundary), connectivity).count == count


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_empty_and_full_contact(boundary: str) -> None:
    """No contact has nothing of anything; full contact is one patch, with a border if it ends."""
    grid = square(12, boundary)
    empty, full = np.zeros((12, 12), dtype=bool), np.ones((12, 12), dtype=bool)
    assert patches(empty, grid).count == 0
    assert coordination(patches(empty, grid).labels, grid).size == 0
    assert perimeter(empty, grid) == 0
    none = ellipse(empty, grid)
    assert none.semi_major_axis == none.semi_minor_axis == 0
    assert np.isnan([none.x, none.y, none.angle]).all()
    assert list(patches(full, grid).area) == [144.0]
    assert list(coordination(patches(full, grid).labels, grid)) == [0]
    if boundary == "periodic":
        assert perimeter(full, grid) == 0
        assert np.isnan(ellipse(full, grid).semi_major_axis)
    else:
        # n lines along each axis and 2n − 1 along each diagonal enter and leave it once.
        expected = np.pi / 2 * 12 + np.pi / np.sqrt(8) * 23
        assert perimeter(full, grid) == pytest.approx(expected, rel=1e-12)
        # A square of edge a has the second moments a²/12.
        assert ellipse(full, grid).semi_major_axis == pytest.approx(12 / np.sqrt(3), rel=1e-12)


@pytest.mark.parametrize("along", [0, 1])
def test_line_contact(along: int) -> None:
    """A strip across a period has two straight borders and no ellipse; a free one has ends too."""
    points, size = [(32, 1), (1, 32)][along], [(32.0, 5.0), (5.0, 32.0)][along]
    strip = np.zeros(32, dtype=bool)
    strip[[0, 1, 2, 30, 31]] = True
    contact = strip.reshape(points)
    periodic = pl.Grid(points=points, size=size, boundary="periodic")
    assert perimeter(contact, periodic) == pytest.approx(2 * 5.0, rel=1e-12)
    assert np.isnan(list(vars(ellipse(contact, periodic)).values())).all()
    free = pl.Grid(points=points, size=size)
    assert perimeter(contact, free) == pytest.approx(2 * (3 + 5.0) + 2 * (2 + 5.0), rel=1e-12)


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 0.6)])
def test_perimeter_of_a_disc(spacing: tuple[float, float]) -> None:
    """It is 2πa to 1 %, on cells of any shape, and the same wherever it lies in a period."""
    size = 60.0, 60.0
    points = tuple(round(length / step) for length, step in zip(size, spacing, strict=True))
    grid = pl.Grid(points=points, size=size, boundary="periodic")
    disc = filled(grid, 20, 20)
    assert perimeter(disc, grid) == pytest.approx(40 * np.pi, rel=0.01)
    moved = np.roll(disc, (points[0] // 2, 7), (0, 1))
    assert perimeter(moved, grid) == pytest.approx(perimeter(disc, grid), rel=1e-12)


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 0.6), (0.5, 1.0)])
def test_cells_that_are_no_squares(spacing: tuple[float, float]) -> None:
    """Edges b along y and c along x count b (α + ½π cos α)/2, tan α = dy/dx; moments are exact."""
    (dx, dy), angle = spacing, np.arctan2(spacing[1], spacing[0])
    grid = pl.Grid(points=(60, 50), size=(60 * dx, 50 * dy))
    block = np.zeros(grid.shape, dtype=bool)
    block[10:50, 15:25] = True
    along, across = 40 * dx, 10 * dy
    border = across * (angle + np.pi / 2 * np.cos(angle))
    border += along * (np.pi / 2 - angle + np.pi / 2 * np.sin(angle))
    # A diagonal through a corner meets the border once.
    assert perimeter(block, grid) == pytest.approx(border, abs=np.hypot(dx, dy))
    found = ellipse(block, grid)
    axes = sorted([along / np.sqrt(3), across / np.sqrt(3)], reverse=True)
    assert [found.semi_major_axis, found.semi_minor_axis] == pytest.approx(axes, rel=1e-12)


@pytest.mark.parametrize("angle", np.radians([0, 15, 22.5, 45, 70]))
def test_perimeter_of_a_strip_is_within_its_bounds(angle: float) -> None:
    """A straight border comes out between 5.2 % short and 2.6 % long."""
    grid = square(200)
    strip = filled(grid, 1e9, 20, float(angle))
    x, y = grid.coordinates()
    within = np.hypot(x, y) < 80
    # Both borders are chords of the circle; its own arcs are right in the mean.
    arcs = 160 * 2 * np.arcsin(20 / 80)
    chords = perimeter(strip & within, grid) - arcs
    true = 4 * np.sqrt(80**2 - 20**2)
    assert -0.06 < chords / true - 1 < 0.035


def test_ellipse_of_hertz(elliptic: pl.Result) -> None:
    """The ellipse fitted to the contact is that of Hertz, to a cell; its axis lies along y."""
    truth = hertz.ellipse(1e-3, 2e-3, 1e4, depth=50e-6)
    assert (truth.semi_x, truth.semi_y) == pytest.approx((0.210473e-3, 0.333769e-3), rel=3e-6)
    cell = elliptic.grid.spacing[0]
    last = elliptic.dataset.isel(step=-1)
    assert last["semi_minor_axis"].item() == pytest.approx(truth.semi_x, abs=cell / 4)
    assert last["semi_major_axis"].item() == pytest.approx(truth.semi_y, abs=cell / 4)
    assert abs(last["major_axis_angle"].item()) == pytest.approx(np.pi / 2, abs=1e-6)
    radius = np.sqrt(truth.semi_x * truth.semi_y)
    assert last["contact_radius"].item() == pytest.approx(radius, abs=cell / 4)
    area = np.pi * truth.semi_x * truth.semi_y
    assert last["mean_contact_pressure"].item() == pytest.approx(truth.force / area, rel=0.02)
    assert last["patches"].item() == 1


def test_a_step_without_contact(elliptic: pl.Result) -> None:
    """Its lengths and counts are 0; what has no value is NaN."""
    first = elliptic.dataset.isel(step=0)
    for name in ("contact_radius", "semi_major_axis", "semi_minor_axis", "patches", "perimeter"):
        assert first[name].item() == 0
    assert np.isnan(first["mean_contact_pressure"].item())
    assert np.isnan(first["major_axis_angle"].item())


@pytest.mark.parametrize("degrees", [-75, -30, 0, 20, 45, 89])
def test_ellipse_turns_with_the_contact(degrees: float) -> None:
    """Semi-axes stay, and the angle is that by which the ellipse was turned."""
    grid = pl.Grid(points=(80, 64), size=(80.0, 80.0))
    result = ellipse(filled(grid, 30, 15, np.radians(degrees)), grid)
    assert result.semi_major_axis == pytest.approx(30, abs=0.3)
    assert result.semi_minor_axis == pytest.approx(15, abs=0.3)
    assert np.degrees(result.angle) == pytest.approx(degrees, abs=1)


def test_ellipse_across_a_periodic_edge() -> None:
    """A contact that lies across the edges has the ellipse of the same contact in the middle."""
    grid = pl.Grid(points=(40, 50), size=(40.0, 50.0), boundary="periodic")
    middle = filled(grid, 15, 9, 0.5)
    middle_ellipse, moved = ellipse(middle, grid), ellipse(np.roll(middle, (20, 22), (0, 1)), grid)
    assert moved.semi_major_axis == pytest.approx(middle_ellipse.semi_major_axis, rel=1e-12)
    assert moved.semi_minor_axis == pytest.approx(middle_ellipse.semi_minor_axis, rel=1e-12)
    assert moved.angle == pytest.approx(middle_ellipse.angle, rel=1e-12)
    assert abs(moved.x) == pytest.approx(20, abs=1e-9)
    assert moved.y == pytest.approx(22, abs=1e-9)


def test_coordination_of_a_lattice() -> None:
    """Each patch of a hexagonal lattice has six neighbours, but for those at a free edge."""
    contact = np.zeros((32, 32), dtype=bool)
    contact[::8, ::8] = True
    contact[4::8, 4::8] = False
    for row in range(8, 32, 16):
        contact[row] = np.roll(contact[row], 4)
    periodic, free = square(32, "periodic"), square(32)
    labels = patches(contact, periodic).labels
    assert set(coordination(labels, periodic)) == {6}
    result = coordination(labels, free)
    assert result.max() == 6
    assert result.mean() < 6


@pytest.mark.parametrize("points", [(24, 24), (24, 15), (17, 32), (24, 1)])
def test_spectrum_keeps_the_mean_square(points: tuple[int, int]) -> None:
    """Parseval: the sum over wave vectors is the variance of the heights; weighted if windowed."""
    heights = np.random.default_rng(1).normal(size=points)
    fields = {"points": points, "size": (3.0, 2.0)}
    periodic = spectrum(heights, pl.Grid(**fields, boundary="periodic"))
    assert periodic.mean_square == pytest.approx(heights.var(), rel=1e-12)
    assert periodic.count.sum() == heights.size - 1
    assert (np.diff(periodic.wavenumber) > 0).all()
    i, j = (np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 2 for n in points)
    window = np.outer(i, j)
    centred = heights - np.average(heights, weights=window)
    expected = np.average(centred**2, weights=window**2)
    windowed = spectrum(heights, pl.Grid(**fields, boundary="free"))
    # What the window makes of the heights has mean zero, so q = 0 held nothing.
    assert windowed.mean_square == pytest.approx(expected, rel=1e-12)


def test_spectrum_of_a_wave() -> None:
    """A cosine is one wave vector with A² h²/4 per area; a window spreads it, and keeps its sum."""
    grid = pl.Grid(points=64, size=2.0, boundary="periodic")
    x, y = grid.coordinates()
    wave = 3e-3 * np.cos(2 * np.pi * 5 * x / 2.0) + 0 * y
    result = spectrum(wave, grid)
    strongest = int(np.argmax(result.density))
    assert result.wavenumber[strongest] == pytest.approx(5 * np.pi, rel=0.03)
    total = result.density * result.count / grid.area
    assert total[strongest] == pytest.approx(3e-3**2 / 2, rel=1e-12)
    assert np.delete(total, strongest).max() < 1e-12 * total[strongest]
    windowed = spectrum(wave, grid.model_copy(update={"boundary": "free"}))
    assert windowed.mean_square == pytest.approx(3e-3**2 / 2, rel=1e-3)
    near = abs(windowed.wavenumber - 5 * np.pi) < 2 * np.pi
    share = (windowed.density * windowed.count)[near].sum() / grid.area
    assert share == pytest.approx(3e-3**2 / 2, rel=1e-2)


def test_spectrum_of_a_self_affine_punch() -> None:
    """The spectrum of the surface falls as q^{−2(H+1)} up to its shortest wave, and ends there."""
    grid = pl.Grid(points=96, size="1 mm", boundary="periodic")
    punch = pl.indenter(
        "self_affine", rms_height="10 um", hurst=0.7, cutoff_wavelength="0.0625 mm", seed=1
    )
    result = spectrum(punch.profile(*grid.coordinates()), grid)
    assert result.mean_square == pytest.approx(10e-6**2, rel=1e-9)
    modes = result.wavenumber * 1e-3 / (2 * np.pi)
    inside = (modes > 3) & (modes < 15)
    slope = np.polyfit(np.log(result.wavenumber[inside]), np.log(result.density[inside]), 1)[0]
    assert slope == pytest.approx(-3.4, abs=0.05)
    assert result.density[modes > 17].max() < 1e-20 * result.density.max()


def test_heights_without_end_have_no_spectrum() -> None:
    """A profile that ends is refused."""
    with pytest.raises(ValueError, match="not finite everywhere"):
        spectrum(np.array([[0.0, -np.inf]]), pl.Grid(points=(1, 2), size=1.0))


def test_distributions_integrate(rough: pl.Result) -> None:
    """Density integrates to 1, pressure times density to the force, gap to the volume between."""
    for index in range(2):
        step = rough.dataset.isel(step=index)
        contact = step["contact"].values
        pressure = distribution(step["pressure"].values[contact])
        share = pressure.density * pressure.width
        assert share.sum() == pytest.approx(1, rel=1e-12)
        area = step["contact_area"].item()
        force = step["force"].item()
        assert area * (share @ pressure.mean) == pytest.approx(force, rel=1e-12)
        # The middles of the bins are within half of one.
        middle = pressure.edges[:-1] + pressure.width / 2
        assert area * (share @ middle) == pytest.approx(force, rel=0.05)
        gap = distribution(step["gap"].values[~contact], bins=20)
        mean = (gap.density * gap.width) @ gap.mean
        assert mean == pytest.approx(step["gap"].values[~contact].mean(), rel=1e-12)


def test_distribution_of_hertz_is_linear(elliptic: pl.Result) -> None:
    """Under a paraboloid the pressure has the density 2p/p₀²: an ellipse without tension too."""
    step = elliptic.dataset.isel(step=-1)
    result = distribution(step["pressure"].values[step["contact"].values], bins=5)
    peak = hertz.ellipse(1e-3, 2e-3, 1e4, depth=50e-6).peak_pressure
    middle = result.edges[:-1] + result.width / 2
    np.testing.assert_allclose(result.density, 2 * middle / peak**2, atol=0.12 / peak)


def test_distribution_of_nothing() -> None:
    """No samples, or zeros and infinite ones only, have no bins."""
    for samples in (np.empty(0), np.array([0.0, np.inf])):
        result = distribution(samples)
        assert result.density.size == result.mean.size == result.width.size == 0


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.7, 3.0])
def test_extrapolation_finds_a_power_law(exponent: float) -> None:
    """Limit, coefficient and exponent come back, from three grids and from more."""
    for points in ([32, 64, 128], [20, 32, 64, 100, 128]):
        h = 1e-3 / np.array(points)
        values = 4e-8 - 3e-8 * (h / h[0]) ** exponent
        result = extrapolate(h, values)
        assert result.exponent == pytest.approx(exponent, rel=1e-5)
        assert result.limit == pytest.approx(4e-8, rel=1e-6)
        np.testing.assert_allclose(result(h), values, rtol=1e-7)
        if len(points) > 3:
            assert [result.lowest, result.highest] == pytest.approx([4e-8, 4e-8], rel=1e-5)
        else:
            assert np.isnan([result.lowest, result.highest]).all()


def test_extrapolated_displacement_is_the_integral() -> None:
    """u(0) = ∫ exp(−q²/4)/(1 + sq) dq, s = 2, under exp(−r²), from grids that miss it by more."""
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=1.0)
    spacings, centres = [], []
    for points in (21, 31, 45, 63):
        grid = pl.Grid(points=points, size=8.0)
        x, y = grid.coordinates()
        u = pl.displacement(np.exp(-(x**2) - y**2), kernel=kernel, grid=grid)
        spacings.append(grid.spacing[0])
        centres.append(u[points // 2, points // 2])
    fit = extrapolate(spacings, centres)
    truth = quad(lambda q: np.exp(-(q**2) / 4) / (1 + 2 * q), 0, np.inf)[0]
    assert 1.7 < fit.exponent < 2
    assert abs(fit.limit / truth - 1) < 1e-4 < abs(centres[-1] / truth - 1) / 5
    assert fit.lowest < fit.limit < fit.highest


def test_extrapolation_of_what_tends_nowhere() -> None:
    """Values that go up and down have no limit; equal ones have theirs."""
    assert np.isnan(extrapolate([1.0, 0.5, 0.25], [1.0, 3.0, 2.0]).limit)
    assert np.isnan(extrapolate([1.0, 0.5, 0.25], [1.0, 1.1, 1.5]).limit)
    assert extrapolate([1.0, 0.5, 0.25], [2.0, 2.0, 2.0]).limit == 2.0
    with pytest.raises(ValueError, match="at least three"):
        extrapolate([1.0, 0.5], [1.0, 2.0])
