"""What levelling, filling and cutting leave of a measured surface: the same contact."""

import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pellicle as pl
from pellicle.components import profile_of

SIZE = 20e-6


def _rough(n: int, seed: int, roll: float = 3.0) -> np.ndarray:
    """Return heights [m] of a periodic self-affine surface of n² points and 20 nm rms."""
    q = n * np.hypot(np.fft.fftfreq(n)[:, None], np.fft.rfftfreq(n)[None, :])
    noise = np.fft.rfft2(np.random.default_rng(seed).standard_normal((n, n)))
    with np.errstate(divide="ignore"):
        shape = np.where(q > 0, np.maximum(q, roll) ** -1.8, 0.0)
    heights: np.ndarray = np.fft.irfft2(noise * shape, s=(n, n))
    heights *= 20e-9 / heights.std()
    return heights


def _scan(heights: np.ndarray, **fields: Any) -> pl.Indenter:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scan.txt"
        np.savetxt(path, heights.T, fmt="%.17g")
        return pl.indenter("topography", path=path, unit="1 m", size=SIZE, **fields)


def _solve(
    scan: pl.Indenter, points: int, boundary: str = "free", size: float = SIZE
) -> tuple[pl.Result, list[str]]:
    load = {"force": ["10 uN"]} if boundary == "free" else {"mean_pressure": ["30 kPa"]}
    run = pl.Run(
        grid=pl.Grid(points=points, size=size, boundary=boundary),
        kernel={"type": "half_space", "reduced_modulus": "10 MPa"},
        indenter=scan,
        loading=load,
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = pl.run(run, progress=False)
    return result, [str(entry.message) for entry in caught]


@st.composite
def _holes(draw: st.DrawFn, n: int = 32) -> np.ndarray:
    """Return which points are missing: some lines at an edge, or a corner, and some inside."""
    missing = np.zeros((n, n), dtype=bool)
    rows, columns = (
        draw(st.sampled_from([slice(None), slice(k), slice(n - k, n)])) for k in (2, 5)
    )
    missing[rows, columns] = True
    if missing.all():
        missing[:, 3:] = False
    rest = np.random.default_rng(draw(st.integers(0, 9))).random((n, n))
    return missing | (rest < 0.02)


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    missing=_holes(),
    seed=st.integers(0, 99),
    slopes=st.tuples(st.sampled_from([-0.06, 0.06]), st.sampled_from([-0.06, 0.0, 0.06])),
    fields=st.fixed_dictionaries(
        {
            "level": st.sampled_from(["tilt", "curvature"]),
            "invert": st.booleans(),
            "centre": st.sampled_from([None, (SIZE * 0.45, SIZE * 0.6)]),
        }
    ),
)
def test_a_tilt_changes_no_pressure_where_points_are_missing(
    missing: np.ndarray, seed: int, slopes: tuple[float, float], fields: dict[str, Any]
) -> None:
    """Heights are levelled, then filled: nothing that is subtracted is seen in what is filled."""
    n = len(missing)
    x = (np.arange(n) + 0.5) * SIZE / n
    rough = np.where(missing, np.nan, _rough(n, seed))
    tilt = slopes[0] * x[:, None] + slopes[1] * x
    points, size = (n, SIZE) if fields["centre"] is None else (24, 0.75 * SIZE)
    flat, tilted = (
        _solve(_scan(heights, fill=0.4, **fields), points, size=size)[0].dataset.pressure.values[-1]
        for heights in (rough, rough + tilt)
    )
    assert np.abs(tilted - flat).max() < 0.01 * flat.max()


@settings(max_examples=8, deadline=None, derandomize=True)
@given(
    missing=_holes(),
    level=st.sampled_from(["none", "mean", "tilt", "curvature"]),
    invert=st.booleans(),
    slope=st.sampled_from([-0.06, 0.03]),
)
def test_what_is_filled_follows_the_plane_of_what_is_measured(
    missing: np.ndarray, level: str, invert: bool, slope: float
) -> None:
    """Holes of a plane are filled with the plane, at every edge and corner and for every level."""
    n = len(missing)
    x = (np.arange(n) + 0.5) * SIZE / n
    plane = slope * x[:, None] - 0.02 * x
    scan = _scan(np.where(missing, np.nan, plane), fill=0.4, level=level, invert=invert)
    expected = (-plane if invert else plane) if level in ("none", "mean") else 0 * plane
    profile = scan.profile(*pl.Grid(points=n, size=SIZE).coordinates())
    assert profile == pytest.approx(expected - expected.max(), abs=1e-9 * SIZE)


def _steps_told(indenter: pl.Indenter, points: int) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        profile_of(indenter, pl.Grid(points=points, size=SIZE, boundary="periodic"))
    return [str(entry.message) for entry in caught]


@settings(max_examples=10, deadline=None, derandomize=True)
@given(seed=st.integers(0, 999), coarser=st.sampled_from([1, 4]))
def test_a_periodic_surface_keeps_its_period(seed: int, coarser: int) -> None:
    """On a periodic grid nothing but the mean is subtracted; a plane parts the edges, as is told.

    On cells four times as coarse the step is no higher than those between neighbouring cells.
    """
    heights = _rough(64, seed, 1.0)
    assert not _steps_told(_scan(heights), 64 // coarser)
    for level in ("tilt", "curvature"):
        said = _steps_told(_scan(heights, level=level), 64 // coarser)
        assert any(f"with level = '{level}'" in text and "'mean'" in text for text in said)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 999),
    coarser=st.sampled_from([1, 4]),
    axis=st.sampled_from([0, 1]),
    level=st.sampled_from([None, "none", "mean"]),
)
def test_a_tilt_on_a_periodic_grid_is_told_with_its_level(
    seed: int, coarser: int, axis: int, level: str | None
) -> None:
    """A tilt of five rms heights over the domain is told on any cells, also in a sum."""
    tilted = _rough(64, seed) + np.expand_dims(np.linspace(0, 100e-9, 64), 1 - axis)
    scan = _scan(tilted, level=level)
    both = pl.indenter("sum", parts=[scan, pl.indenter("paraboloid", radius="1 m")])
    for indenter in (scan, both):
        said = _steps_told(indenter, 64 // coarser)
        expected = f"along {'xy'[axis]} with level = '{level or 'mean'}'"
        assert any(expected in text and "level = 'tilt' of" in text for text in said)


def test_level_by_default() -> None:
    """A scan takes the level from the grid on which it is pressed, however it is made."""
    tilted = _rough(32, 1) + 0.01 * np.arange(32)[:, None] * SIZE / 32
    for boundary, level in (("free", "tilt"), ("periodic", "mean")):
        gaps = [
            _solve(scan, 32, boundary)[0].dataset.gap.values
            for scan in (_scan(tilted), _scan(tilted, level=level))
        ]
        assert np.array_equal(gaps[0], gaps[1])


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 99),
    share=st.floats(0.2, 0.6),
    finer=st.sampled_from([0.25, 1.0, 3.0, 8.0]),
    at=st.tuples(st.floats(0.31, 0.69), st.floats(0.31, 0.69)),
)
def test_a_part_of_a_scan_is_solved_on_any_cells(
    seed: int, share: float, finer: float, at: tuple[float, float]
) -> None:
    """Depth counts from the highest point that the domain has, wherever that of the scan is."""
    heights = _rough(48, seed)
    heights[24:26, 24:26] += 1e-6
    scan = _scan(heights, centre=[SIZE * a for a in at], level="none")
    points = max(4, round(48 * share * finer))
    result, _ = _solve(scan, points, size=share * SIZE)
    step = result.dataset.isel(step=0)
    assert step.depth.item() > 0
    assert step.contact.any()
