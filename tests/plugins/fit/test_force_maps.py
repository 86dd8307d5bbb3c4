"""Force maps: images of what was fitted, from files that know where curves were measured."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

import pellicle as pl
from pellicle.errors import ConfigError
from pellicle_fit.files.measurement import Site
from pellicle_fit.population.images import force_maps
from pellicle_fit.population.row import Row
from pellicle_fit.report.population import map_figure
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.plugins.fit import instruments
from tests.plugins.fit.test_many import ALONE, BEAD, curve, save
from tests.plugins.fit.test_population import CLOSED, estimate, row

COLUMNS, ROWS, BROKEN, EMPTY = 4, 3, 5, 10
OPTIONS = BEAD | ALONE
NAMES = "reduced_modulus", "tension", "contact_height"


def truth(columns: int, rows: int) -> dict[str, NDArray[np.float64]]:
    """Return the images that should be found: a stiff spot, a tension that grows, a wavy height."""
    y, x = np.meshgrid(np.arange(rows) / rows, np.arange(columns) / columns, indexing="ij")
    spot = np.exp(-((x - 0.5) ** 2 + (y - 0.4) ** 2) / 0.04)
    return {
        "reduced_modulus": 5e3 * (1 + 2 * spot),
        "tension": 2e-3 * (1 + x),
        "contact_height": -1e-6 * np.sin(3 * x) * y,
    }


def recordings(columns: int, rows: int) -> list[instruments.Recording]:
    """Return what an instrument sees at each pixel, with noise in which each tension is seen."""
    random = np.random.default_rng(7)
    bead, depth = Paraboloid(radius=10e-6), np.linspace(-0.5e-6, 1.5e-6, 60)
    images = [truth(columns, rows)[name].ravel().tolist() for name in NAMES]
    result = []
    for number, (modulus, tension, height) in enumerate(zip(*images, strict=True)):
        force = modulus * bead.force_curve(depth, 2 * tension / modulus).force
        noise = 0.001 * force.max() * random.standard_normal(depth.size)
        seen = instruments.record(depth - height, force, noise, spring_constant=0.05)
        place = 0.5e-6 * (number % columns), 0.5e-6 * (number // columns)
        result.append(replace(seen, place=place))
    return result


@pytest.fixture(scope="module")
def mapped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a map of 4 × 3 curves, one without contact and one empty, fitted."""
    folder = tmp_path_factory.mktemp("map")
    curves = recordings(COLUMNS, ROWS)
    curves[BROKEN] = replace(curves[BROKEN], force=0 * curves[BROKEN].force)
    nothing = curves[EMPTY].force[:0]
    curves[EMPTY] = replace(curves[EMPTY], force=nothing, height=nothing)
    instruments.jpk(folder / "cell.jpk-force-map", *curves)
    pl.fit_map(folder / "cell.jpk-force-map", directory=folder / "out", **OPTIONS)
    return folder


def picture(path: Path | str) -> NDArray[np.float32]:
    """Return the numbers of a TIFF, the smallest y first."""
    with Image.open(path) as opened:
        assert opened.mode == "F"
        return np.array(opened)[::-1]


@pytest.mark.slow
def test_images(mapped: Path) -> None:
    """Most intervals hold the truth of their pixel, and nothing is made up where there is none."""
    expected = truth(COLUMNS, ROWS)
    for name in NAMES:
        stem = mapped / "out" / "maps" / f"cell-{name}"
        image, low, high = (picture(f"{stem}{end}.tif") for end in ("", "_low", "_high"))
        assert image.shape == (ROWS, COLUMNS)
        missing = np.isnan(image)
        assert missing.flat[[BROKEN, EMPTY]].all()
        assert missing.sum() <= 3
        assert np.array_equal(missing, np.isnan(low) | np.isnan(high))
        inside = (np.nan_to_num(low, nan=-1e9) <= expected[name]) & (
            expected[name] <= np.nan_to_num(high, nan=1e9)
        )
        assert inside.sum() >= 0.8 * image.size
    assert (mapped / "out" / "maps" / "cell.png").stat().st_size > 10_000


@pytest.mark.slow
def test_killed_and_resumed(mapped: Path) -> None:
    """Killed without warning, the same command goes on, and ends with the same numbers."""
    source, folder = mapped / "cell.jpk-force-map", mapped / "killed"
    command = [sys.executable, "-m", "pellicle", "fit", str(source), "-i", "paraboloid"]
    command += ["--radius", "10 um", "-o", str(folder), "--fix", "tension=0", "--rivals", "none"]
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while len(list((folder / "curves").glob("*.json"))) < 2 and child.poll() is None:
            time.sleep(0.002)
    finally:
        os.kill(child.pid, signal.SIGTERM if os.name == "nt" else signal.SIGKILL)
        child.wait()
    finished = {path: path.stat().st_mtime_ns for path in (folder / "curves").glob("*.json")}
    assert 2 <= len(finished) < COLUMNS * ROWS - 2
    images = pl.fit_map(source, directory=folder, fix={"tension": 0}, **OPTIONS)
    assert all(path.stat().st_mtime_ns == at for path, at in finished.items())
    assert not list(folder.rglob("*.part"))
    xr.testing.assert_identical(images, pl.fit_map(source, fix={"tension": 0}, **OPTIONS))
    stored = picture(folder / "maps" / "cell-reduced_modulus.tif")
    np.testing.assert_allclose(stored, images["reduced_modulus"], rtol=1e-6)


@pytest.mark.slow
def test_places_as_text(tmp_path: Path) -> None:
    """Places in a file of afmformats may be texts with units."""
    curves = [replace(c, place=None) for c in recordings(3, 1)]
    instruments.hdf5(tmp_path / "line.h5", *curves)
    with h5py.File(tmp_path / "line.h5", "r+") as file:
        for number, x in enumerate(("0 nm", "500 nm", "1 um")):
            file[str(number)].attrs.update({"position x": x, "position y": "2 um"})
    options = OPTIONS | {"fix": {"tension": 0}, "accept": "r_squared > 0"}
    images = pl.fit_map(tmp_path / "line.h5", directory=tmp_path, **options)
    assert images["x"].values == pytest.approx([0, 5e-7, 1e-6])
    assert images["y"].values == pytest.approx([2e-6])
    assert np.isfinite(images["reduced_modulus"]).all()
    assert "tension" not in images
    assert picture(tmp_path / "maps" / "line-contact_height.tif").shape == (1, 3)


def placed(places: list[tuple[float, float]]) -> list[Row]:
    """Return accepted rows at places [µm], their moduli in order."""
    rows = [row(f"m:{k}", 1e3 + k) for k in range(len(places))]
    for one, (x, y) in zip(rows, places, strict=True):
        one.accepted, one.map, one.site = True, "m", Site(1e-6 * x, 1e-6 * y)
    return rows


def only_image(rows: list[Row]) -> tuple[list[list[float]], list[str]]:
    """Return the modulus of the only map less 1000, -1 where there is none, and the notes."""
    maps, notes = force_maps(rows)
    (images,) = maps.values()
    return (np.nan_to_num(images["reduced_modulus"].values, nan=999) - 1e3).tolist(), notes


def test_two_at_one_place() -> None:
    """Of two curves at one place the last accepted one is shown."""
    rows = placed([(0, 0), (1, 0), (0, 1), (1, 1), (0, 0), (1, 0)])
    rows[5].accepted = False
    assert only_image(rows)[0] == [[4, 1], [2, 3]]


def test_open_intervals_have_no_pixel() -> None:
    """The value of an open interval is one of many."""
    rows = placed([(0, 0), (1, 0)])
    rows[0].keep(row("m:0", is_open=True).fit.data)
    assert only_image(rows)[0] == [[-1, 1]]


def test_map_of_verdicts() -> None:
    """Each verdict has a number, which is in its legend with how many curves have it."""
    rows = placed([(0, 0), (1, 0), (0, 1), (1, 1)])
    rows[0].fit.data["verdict"] = "needed"
    rows[3].accepted = False
    (images,) = force_maps(rows)[0].values()
    np.testing.assert_array_equal(images["verdict"], [[1, 3], [3, np.nan]])
    assert images["verdict"].attrs["meanings"][0] == "needed"
    fill, size = map_figure(images, "map")
    figure = Figure(size)
    fill(figure)
    (legend,) = filter(None, (axes.get_legend() for axes in figure.axes))
    assert [text.get_text() for text in legend.get_texts()] == ["needed (1)", "no sign (2)"]


def test_odd_grids() -> None:
    """Noise of the stage, a missing column and a map that is not square change no pixel."""
    noise = 0.05 * np.random.default_rng(1).standard_normal((6, 2))
    snake = [(0, 0), (1, 0), (3, 0), (3, 1), (1, 1), (0, 1)]
    rows = placed([(x + a, y + b) for (x, y), (a, b) in zip(snake, noise.tolist(), strict=True)])
    image, notes = only_image(rows)
    assert (image, notes) == ([[0, 1, -1, 2], [5, 4, -1, 3]], [])


def test_no_grid(tmp_path: Path) -> None:
    """Places of a rotated scan, or at random, make no image, which is said."""
    turned = np.exp(0.3j) * np.add.outer(np.arange(5), 1j * np.arange(5)).ravel()
    scattered = np.random.default_rng(2).random((12, 2)) @ np.array([1, 1j])
    for points in (turned, scattered):
        maps, notes = force_maps(placed([(z.real, z.imag) for z in points.tolist()]))
        assert not maps
        assert notes == ["m: its places are not on a grid, so there is no image"]
    # One place is not a map.
    assert force_maps(placed([(0, 0), (0, 0)])) == ({}, [])
    save(tmp_path / "a.csv", *curve(1))
    with pytest.raises(ConfigError, match="hold 0 force maps"):
        pl.fit_map(tmp_path / "a.csv", fix={"tension": 0}, **OPTIONS)


def test_open_pixels_are_hatched() -> None:
    """Those with one open end are, in both images of the quantity; all others are not."""
    rows = [
        row(f"{n}", 2e3, tension=estimate(1e-3, "N/m", (None, 2.0) if n in (1, 4) else CLOSED))
        for n in range(6)
    ]
    for number, one in enumerate(rows):
        one.map, one.accepted = "map", True
        one.site = Site(1e-6 * (number % 3), 2e-6 * (number // 3))
    (images,) = force_maps(rows)[0].values()
    fill, size = map_figure(images, "map")
    figure = Figure(size)
    fill(figure)
    drawn = {
        axes.get_title(): np.asarray(axes.patches[0].get_path().vertices, dtype=float)
        for axes in figure.axes
        if axes.images and axes.patches
    }
    assert len(drawn) == 2
    for corners in drawn.values():
        centres = corners.reshape(-1, 5, 2)[:, :4].mean(axis=1)
        np.testing.assert_allclose(centres, [[1.0, 0.0], [1.0, 2.0]], atol=1e-9)
