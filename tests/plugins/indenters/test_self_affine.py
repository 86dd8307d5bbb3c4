"""The self-affine surface: one surface at every resolution, with the spectrum that it promises."""

import numpy as np
import pytest

import pellicle as pl

SIZE = 1e-3
FIELDS = {
    "rms_height": 1e-6,
    "hurst": 0.8,
    "cutoff_wavelength": SIZE / 7.5,
    "roll_off_wavelength": SIZE / 2,
    "seed": 4,
}


def _profile(
    points: int | list[int], size: float | list[float] = SIZE, **changes: object
) -> np.ndarray:
    grid = pl.Grid(points=points, size=size, boundary="periodic")
    return pl.indenter("self_affine", **(FIELDS | changes)).profile(*grid.coordinates())


def _power(profile: np.ndarray, grid: pl.Grid) -> tuple[np.ndarray, np.ndarray]:
    """Return wavenumber [rad/m] and power of each mode of a full 2-D transform."""
    qx, qy = (
        2 * np.pi * np.fft.fftfreq(n, d) for n, d in zip(grid.shape, grid.spacing, strict=True)
    )
    q = np.hypot(qx[:, None], qy[None, :])
    return q, np.abs(np.fft.fft2(profile - profile.mean(), norm="forward")) ** 2


@pytest.mark.parametrize(
    ("points", "size"),
    [
        (16, SIZE),
        (17, SIZE),
        (20, 0.7e-3),
        ([16, 24], SIZE),
        ([18, 21], [SIZE, 1.1e-3]),
        ([16, 32], [SIZE, 2 * SIZE]),
    ],
)
@pytest.mark.parametrize("seed", [0, 4])
def test_same_surface_at_every_resolution(
    points: int | list[int], size: float | list[float], seed: int
) -> None:
    """A grid of a third of the spacing has the same heights at the cell centres that it shares."""
    coarse = _profile(points, size, seed=seed)
    fine = _profile([3 * n for n in coarse.shape], size, seed=seed)[1::3, 1::3]
    assert np.abs(fine - coarse).max() <= 1e-12 * np.abs(coarse).max()


@pytest.mark.parametrize("edge", [SIZE, 0.7e-3, 1.1e-3, 1.3e-3])
def test_waves_of_equal_length_keep_their_phases(edge: float) -> None:
    """Modes whose wavenumbers differ by rounding only do not swap between resolutions."""
    # In a domain of 1 : 2 many wavenumbers coincide, and each grid rounds them differently.
    changes = {"cutoff_wavelength": edge / 5.5, "roll_off_wavelength": edge / 2}
    coarse = _profile([16, 32], [edge, 2 * edge], **changes)
    for factor in (3, 5, 7, 9):
        fine = _profile([16 * factor, 32 * factor], [edge, 2 * edge], **changes)
        shared = fine[factor // 2 :: factor, factor // 2 :: factor]
        assert np.abs(shared - coarse).max() <= 1e-12 * np.abs(coarse).max()


@pytest.mark.parametrize("points", [16, 17, [16, 25], 48])
def test_rms_height(points: int | list[int]) -> None:
    """The root mean square of the heights is exactly the one that is asked for."""
    assert np.std(_profile(points)) == pytest.approx(1e-6, rel=1e-12)


@pytest.mark.parametrize("points", [16, 17, [20, 31], 48])
def test_highest_point(points: int | list[int]) -> None:
    """The surface's own summit is at 0, so samples are at most 0 and come close to it."""
    assert -0.5e-6 < _profile(points).max() <= 0
    # On a fine grid within the curvature of a cell.
    assert -2e-3 * 1e-6 < _profile(16 * 27).max() <= 0


@pytest.mark.parametrize(
    ("points", "size"), [(32, SIZE), (33, SIZE), ([32, 48], [SIZE, 1.5e-3]), ([31, 40], SIZE)]
)
@pytest.mark.parametrize("hurst", [0.0, 0.3, 1.0])
def test_spectrum(points: int | list[int], size: float | list[float], hurst: float) -> None:
    """Power falls as q^(−2(H+1)) from roll-off to cut-off, both included, and is 0 outside."""
    grid = pl.Grid(points=points, size=size, boundary="periodic")
    q, power = _power(_profile(points, size, hurst=hurst, cutoff_wavelength=SIZE / 8), grid)
    low, high = 2 * np.pi / FIELDS["roll_off_wavelength"], 2 * np.pi / (SIZE / 8)
    inside = (q >= low * (1 - 1e-9)) & (q <= high * (1 + 1e-9))
    assert power[~inside].max() < 1e-24 * power.max()
    scaled = power[inside] * q[inside] ** (2 * (hurst + 1))
    assert scaled == pytest.approx(scaled.mean(), rel=1e-9)


def test_roll_off_is_the_domain_if_absent() -> None:
    """Without a roll-off the longest wavelength is the longer edge of the domain."""
    size = [SIZE, 2 * SIZE]
    assert np.array_equal(
        _profile([16, 32], size, roll_off_wavelength=None),
        _profile([16, 32], size, roll_off_wavelength=2 * SIZE),
    )


def test_seed() -> None:
    """The seed decides the surface: equal seeds agree, others have nothing in common."""
    assert np.array_equal(_profile(32, seed=1), _profile(32, seed=1))
    one, other = (_profile(32, seed=seed).ravel() for seed in (1, 2))
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.5


def test_phases_are_spread() -> None:
    """Phases are uniform: their mean direction over many modes is near zero."""
    transform = np.fft.rfft2(_profile(48, cutoff_wavelength=SIZE / 20))
    kept = np.abs(transform) > 1e-9 * np.abs(transform).max()
    kept[0, 0] = False
    directions = transform[kept] / np.abs(transform[kept])
    assert abs(directions.mean()) < 4 / np.sqrt(directions.size)


def test_longer_spectrum_keeps_the_longer_waves() -> None:
    """A shorter cut-off adds waves and leaves the phases of the others alone."""
    few, many = (
        np.fft.rfft2(_profile(48, cutoff_wavelength=SIZE / waves)) for waves in (6.5, 15.5)
    )
    common = np.abs(few) > 1e-9 * np.abs(few).max()
    common[0, 0] = False
    assert np.angle(many[common] / few[common]) == pytest.approx(0, abs=1e-9)


def test_cut_off_that_cannot_be_resolved() -> None:
    """A cut-off of two cells or less is refused, one above is not."""
    _profile(16, cutoff_wavelength=SIZE / 7.99)
    with pytest.raises(pl.ConfigError, match=r"cutoff_wavelength: .*cannot be resolved by cells"):
        _profile(16, cutoff_wavelength=SIZE / 8)
