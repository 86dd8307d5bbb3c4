"""Measured surfaces.

``patch.gwy`` and ``patch.x3p`` in tests/data hold one surface made of 40 waves with a tilt, of
39 × 33 points on 1.3 mm × 1.1 mm; the second lacks 7 points. tests/data/patch.py makes them.
"""

import io
import pickle
import runpy
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle import memory
from pellicle_plugins.indenters.text_table import read_tables
from tests.tables_of_runs import pressing, tensed

ROOT = Path(__file__).parents[3]
DATA = ROOT / "tests/data"
GWY, X3P = DATA / "patch.gwy", DATA / "patch.x3p"
PATCH = runpy.run_path(str(DATA / "patch.py"))
GRID = pl.Grid(points=[39, 33], size=["1.3 mm", "1.1 mm"])


def _profile(grid: pl.Grid = GRID, path: Path = GWY, **fields: Any) -> np.ndarray:
    return pl.indenter("topography", path=path, **fields).profile(*grid.coordinates())


def _heights() -> np.ndarray:
    """Return the heights [m] that both files are made from."""
    heights: np.ndarray = PATCH["surface"]()
    return heights


def test_heights_unit_and_size_are_the_files() -> None:
    """On its own points the profile is what the file holds, in metres, less the highest."""
    expected = _heights() - _heights().max()
    assert np.ptp(expected) == pytest.approx(42.48e-6, rel=1e-3)
    assert _profile(level="none") == pytest.approx(expected, abs=1e-19)


def test_both_formats_agree() -> None:
    """The same surface in two formats is the same, to single precision and but for what is lost."""
    one, two = _profile(level="none"), _profile(path=X3P, level="none", fill=0.01)
    difference = abs(one - two)
    assert difference[~PATCH["MISSING"]].max() < 5e-12
    # Filled points lie among their neighbours.
    assert difference.max() < 2e-6


def test_levels(tmp_path: Path) -> None:
    """What is added to the heights is taken away again by its own level, and by no lower one."""
    x, y = GRID.coordinates()
    plane, bowl = 0.03 * x - 0.01 * y, 10 * x**2 - 30 * x * y + 20 * y**2
    for level, added in (("none", 0 * x), ("mean", 0 * x), ("tilt", plane), ("curvature", bowl)):
        before, after, beyond = (
            _from_array(tmp_path, _heights() + more, level).profile(x, y)
            for more in (0, added, added + (plane if level in ("none", "mean") else bowl))
        )
        assert np.ptp(after - before) < 1e-15, level
        assert level == "curvature" or np.ptp(beyond - before) > 1e-9, level


@pytest.mark.parametrize("path", [GWY, X3P])
def test_what_is_left_by_a_level_has_none_of_it(path: Path) -> None:
    """Least squares: what is left has no product with any polynomial of the level's degree.

    The products are sums over the points that were measured.
    """
    measured = ~PATCH["MISSING"] if path == X3P else np.ones(GRID.shape, dtype=bool)
    x, y = (np.broadcast_to(axis / 1e-3, GRID.shape) for axis in GRID.coordinates())
    for level, polynomials in (("tilt", [x, y]), ("curvature", [x, y, x**2, x * y, y**2])):
        left = _profile(path=path, level=level, fill=0.01)
        left -= left[measured].mean()
        for polynomial in polynomials:
            assert abs(np.mean((left * polynomial)[measured])) < 1e-15 * np.ptp(left), level


def _from_array(folder: Path, heights: np.ndarray, level: str) -> pl.Indenter:
    """Return the indenter of a file without unit and size."""
    path = folder / "heights.npy"
    np.save(path, heights)
    return pl.indenter("topography", path=path, unit=1, size=["1.3 mm", "1.1 mm"], level=level)


def test_invert_turns_valleys_into_peaks() -> None:
    """Inverted, the lowest point of the scan is what touches first."""
    upright, upside_down = _profile(level="none"), _profile(level="none", invert=True)
    assert upside_down == pytest.approx(upright.min() - upright, abs=1e-19)


def test_domain_is_a_part_of_the_scan() -> None:
    """A smaller domain sees the points under it, about the middle or a point that is given."""
    grid = pl.Grid(points=13, size=13 / 30e3)
    part = _profile(grid, level="none")
    middle = _heights()[13:26, 10:23]
    assert part == pytest.approx(middle - middle.max(), abs=1e-19)
    part = _profile(grid, level="none", centre=[6.5 / 30e3, 20.5 / 30e3])
    corner = _heights()[:13, 14:27]
    assert part == pytest.approx(corner - corner.max(), abs=1e-19)


def test_coarser_grid_samples_the_surface() -> None:
    """A grid three times as coarse has the heights of every third point."""
    grid = pl.Grid(points=[13, 11], size=["1.3 mm", "1.1 mm"])
    assert _profile(grid) == pytest.approx(_profile()[1::3, 1::3], abs=1e-18)


def test_finer_grid_is_warned_about_and_goes_through_the_points() -> None:
    """Three cells to a point keep the heights of the points; a warning says what that means."""
    grid = pl.Grid(points=[117, 99], size=["1.3 mm", "1.1 mm"])
    with pytest.warns(UserWarning, match=r"cells of 11\.1 µm × .* are finer than the points"):
        fine = _profile(grid, level="none")
    assert (fine <= 0).all()
    shift = fine[1::3, 1::3] - _profile(level="none")
    assert np.ptp(shift) < 1e-15


def test_interpolation_is_of_fourth_order(tmp_path: Path) -> None:
    """A wave sampled between its points is met to the fourth order of their distance."""
    errors = []
    for n in (48, 96):
        x, y = pl.Grid(points=n, size=["1.3 mm", "1.1 mm"]).coordinates()
        q = 2 * np.pi / 0.7e-3
        given = 1e-6 * np.cos(q * x + 0.3) * np.cos(q * y)
        grid = pl.Grid(points=n, size=["0.65 mm", "0.55 mm"])
        with pytest.warns(UserWarning, match="finer"):
            heights = _from_array(tmp_path, given, "none").profile(*grid.coordinates())
        x, y = grid.coordinates()
        wanted = 1e-6 * np.cos(q * x + 0.3) * np.cos(q * y)
        difference = (heights - wanted)[4:-4, 4:-4]
        errors.append(np.ptp(difference))
    assert errors[0] / errors[1] > 12


def test_rough_run_under_tension_converges() -> None:
    """A run from a file, with a tension, converges and touches with the peaks.

    A warning says that a scan is not periodic.
    """
    scan, skin = {"type": "topography", "path": str(X3P), "fill": 0.01}, tensed(1e4, "20 mN/m")
    more: dict[str, Any] = {"boundary": "periodic", "mean_pressure": "30 Pa"}
    run = pressing([39, 33], ["1.3 mm", "1.1 mm"], skin, scan, **more)
    with pytest.warns(UserWarning, match="not periodic along [xy]"):
        result = pl.run(run, progress=False)
    assert result.converged
    assert ", SurfaceTopography " in result.dataset.attrs["versions"]
    data = result.dataset.isel(step=0)
    profile = (data["displacement"] - data["depth"] - data["gap"]).values
    touching = profile[data["contact"].values]
    assert 0 < touching.size < profile.size / 2
    assert touching.mean() > profile.mean() + profile.std()


def _changed(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[-3000] ^= 1
    path.write_bytes(content)


def test_is_recorded_by_the_hash_of_the_file(tmp_path: Path) -> None:
    """The hash of the file is written down, and a file that has changed is refused."""
    path = tmp_path / "a.gwy"
    path.write_bytes(GWY.read_bytes())
    indenter = pl.indenter("topography", path=path)
    recorded = indenter.model_dump(exclude_none=True)
    # Workers have no file: a run that is sent there has its heights with it.
    copy = pickle.loads(pickle.dumps(indenter))
    assert copy == indenter
    assert np.array_equal(copy.profile(*GRID.coordinates()), _profile())
    _changed(path)
    with pytest.raises(pl.ConfigError, match=r"^sha256: .*they have changed"):
        pl.indenter(recorded.pop("type"), **recorded)


def _run(path: Path, **fields: Any) -> pl.Run:
    return pl.Run(
        grid=GRID,
        kernel={"type": "half_space", "reduced_modulus": 1e4},
        indenter={"type": "sum", "parts": [{"type": "topography", "path": path, **fields}]},
        loading={"depth": "1 um"},
    )


def test_run_is_told_apart_by_the_content_of_the_file(tmp_path: Path) -> None:
    """Another file of the same content makes the same run; the same file changed another one."""
    path = tmp_path / "a.gwy"
    path.write_bytes(GWY.read_bytes())
    first = _run(path).identity
    assert first == _run(GWY).identity
    _changed(path)
    assert _run(path).identity != first


def test_parts_of_one_scan_share_its_heights() -> None:
    """A study over places of a scan reads it once, and holds it once."""
    centres = [["0.5 mm", "0.5 mm"], ["0.6 mm", "0.4 mm"]]
    study = pl.Study(run=_run(GWY), vary={"indenter.parts.0.centre": centres})
    indenters: list[Any] = [point.run.indenter for point in study.points]
    first, second = (indenter.parts[0] for indenter in indenters)
    assert first != second
    assert first._values is second._values


def _truncated(content: bytes) -> bytes:
    return content[: len(content) // 2]


def _bad_zip(content: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(stream, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, data[:100] if name.endswith("data.bin") else data)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("path", "damage"),
    [(GWY, _truncated), (X3P, _truncated), (X3P, _bad_zip), (GWY, lambda content: content[:60])],
)
def test_damaged_files(tmp_path: Path, path: Path, damage: Callable[[bytes], bytes]) -> None:
    """A file that ends too early is called damaged, in one line."""
    file = tmp_path / path.name
    file.write_bytes(damage(path.read_bytes()))
    with pytest.raises(pl.ConfigError, match=r"^path: .*damaged") as caught:
        pl.indenter("topography", path=file)
    assert "\n" not in str(caught.value)


X, Y = (axis.ravel() for axis in np.meshgrid([0.0, 1, 2, 3], [0.0, 1, 2], indexing="ij"))
POINTS = np.stack([X, Y, X * Y / 10], axis=1)
SIZED = "# Channel: Main\n# Width: 4 um\n# Height: 3 um\n# Value units: um\n"
ROWS = "1 2 3 4 5\n2 2 2 2 2\n5 4 3 2 1\n2 2 2 2 2\n"
PHASE = "# Channel: Phase\n# Value units: deg\n"
LINE = "\n".join(f"{x} {x**2}" for x in range(20))
TERRAIN = np.random.default_rng(1).integers(0, 500, (24, 24))
UNIT, SIZE = {"unit": "1 nm"}, {"size": "10 um"}


def _columns(points: np.ndarray) -> str:
    return "\n".join(" ".join(map(repr, row)) for row in points.tolist())


@pytest.mark.parametrize(
    ("content", "fields", "message"),
    [
        (ROWS, {}, r"^unit: is missing, .* the length that 1 stands for"),
        (ROWS, UNIT, r"^size: is missing, .*edge lengths"),
        (SIZED.replace("4", "0").replace("3", "0") + ROWS, {}, r"^size: .* does not state it"),
        (SIZED + ROWS, UNIT, "^unit: .*states its own unit"),
        (SIZED + ROWS, {"size": "1 um"}, "^size: .*states its own size, 4e-06 × 3e-06 m"),
        (SIZED + ROWS, {"channel": "Phase"}, r"^channel: 'Phase' is not in .*: 'Main'"),
        (SIZED + ROWS, {"fill": 1}, "^fill: .*< 1"),
        (SIZED + ROWS, {"level": "cubic"}, "^level: .*curvature"),
        ("h=4 w=5\n1 2 3 4 5\n", {}, "states 4 rows of heights and has 1"),
        (PHASE + ROWS, {}, "'Phase' of .* is in deg, not heights"),
        ("Width: 10,5 µm\nHeight: 8,2 µm\n" + ROWS, UNIT, "its size in ',5 µm', which is"),
        (ROWS + "1 2 3\n", {}, "rows of 5 and 3 numbers, in lines 1 and 5"),
        (ROWS.replace("3", "1.2.3"), {}, r"damaged or incomplete \(could not convert .*'1.2.3'"),
        (LINE, UNIT, r"^path: .*profile along a line.*grid\.points = \[…, 1\]"),
        ("1\n2\n3\n", UNIT | SIZE, r"profile along a line.*grid\.points = \[…, 1\]"),
        (_columns(POINTS**2), UNIT, r"^path: .* irregular distances; resample"),
        (SIZED + _columns(POINTS[:-1]), {}, "irregular distances"),
        (SIZED + _columns(POINTS[[0, *range(11)]]), {}, "irregular distances"),
        (SIZED + _columns(POINTS * [0, 1, 1]), {}, "irregular distances"),
        (SIZED + _columns(POINTS + [[0, 0.2, 0]] * (POINTS[:, :1] > 2)), {}, "irregular distances"),
        (
            SIZED.replace("3 um", "30 um") + _columns(POINTS),
            {},
            "states a size of 4 um × 30 um, and its coordinates are as 4 to 3",
        ),
        (b"\x01\x02nothing that anybody reads" * 9, {}, "unknown format.*gwy.*x3p.*commas"),
        # Whole numbers without a mark are the format hgt, which is read from files named so only.
        (TERRAIN.astype(">i2").tobytes(), UNIT | SIZE, "^path: .*unknown format"),
        (None, {}, r"^path: .*a\.txt: no such file"),
    ],
)
def test_refused_files(
    content: str | bytes | None, fields: dict[str, Any], message: str, tmp_path: Path
) -> None:
    """What a file does not say, contradicts or cannot mean is refused with what to do."""
    path = tmp_path / "a.txt"
    if content is not None:
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(pl.ConfigError, match=message):
        pl.indenter("topography", path=path, **fields)


@pytest.mark.parametrize("unit", [1.0, 1e-6])
@pytest.mark.parametrize("header", ["", SIZED])
def test_coordinates_on_a_grid_are_its_heights(header: str, unit: float, tmp_path: Path) -> None:
    """Three columns on a regular grid, in any order; under sizes also in any unit of length."""
    path = tmp_path / "a.xyz"
    scale = unit if header else 1.0
    points = np.random.default_rng(0).permutation(POINTS * [scale, scale, 1])
    path.write_text(header + _columns(points))
    given = {} if header else {"unit": "1 um"}
    profile = _profile(pl.Grid(points=[4, 3], size=["4 um", "3 um"]), path, level="none", **given)
    assert profile == pytest.approx((X * Y - 6).reshape(4, 3) * 1e-7, abs=1e-18)


def test_missing_points_are_refused_or_filled() -> None:
    """Missing points are counted under the domain; a share that is stated is filled in."""
    with pytest.raises(pl.ConfigError, match=r"^fill: 0\.54% of the points .* allows 0\.00%"):
        _profile(path=X3P)
    assert np.isfinite(_profile(path=X3P, fill=0.006)).all()
    # Nothing is missing under this part.
    grid = pl.Grid(points=9, size="0.3 mm")
    assert np.isfinite(_profile(grid, path=X3P, centre=["0.8 mm", "0.7 mm"])).all()


@pytest.mark.parametrize(
    ("size", "centre", "message"),
    [
        ("1.2 mm", None, r"^path: the domain reaches along y .* grid\.size at most 1\.1 mm"),
        (["1.4 mm", "0.6 mm"], None, r"along x .* at most 1.3 mm along x"),
        ("0.3 mm", ["0.1 mm", "0.3 mm"], r"^centre: .* at most 200 µm along x, or move centre"),
    ],
)
def test_domain_that_does_not_fit_the_scan(size: object, centre: object, message: str) -> None:
    """A domain beyond the scan, or of less than two of its points, is refused with numbers."""
    grid = pl.Grid(points=3, size=size)
    indenter = pl.indenter("topography", path=GWY, centre=centre)
    with pytest.raises(pl.ConfigError, match=message):
        indenter.profile(*grid.coordinates())


@pytest.mark.parametrize(
    ("header", "fields", "message"),
    [
        (
            "Width: 160 m\nHeight: 160 m\nValue units: um",
            {},
            r"measures 160 × 160 m: a unit may be wrong; if so, export it again",
        ),
        (
            "",
            {"unit": "1 m", "size": "2 m"},
            r"measures 2 × 2 m and has an rms slope of .*; if so, correct unit or size",
        ),
    ],
)
def test_size_and_slope_of_a_wrong_unit_are_remarked_on(
    header: str, fields: dict[str, Any], message: str, tmp_path: Path
) -> None:
    """A scan of 160 m, or steeper than 1, is read with a warning that says what to correct."""
    path = tmp_path / "a.txt"
    np.savetxt(path, np.random.default_rng(0).standard_normal((8, 8)), header=header)
    with pytest.warns(UserWarning, match=message):
        pl.indenter("topography", path=path, **fields)


WITHOUT_UNIT = [
    "# Width: 10 µm\n# Height: 8 µm",
    "# Width: 10 μm\n# Height: 8000 nm",
    "x-length = 10\ny-length = 8\nx-unit = um",
]
WITH_UNIT = [
    "# Width: 10 µm\n# Height: 8 µm\n# Value units: nm",
    "# Kanal: Topo\n# Breite: 10 µm\n# Höhe: 8000 nm\n# Einheiten: nm",
    "# チャネル：Topo\n# 幅：10 µm\n# 高さ：8 µm\n# 値の単位：nm",
    "# File Format = ASCII\n# x-length = 10000\n# y-length = 8000\n# Bit2nm = 1",
    "File Format = ASCII\nNX = 5\nNY = 4\nScale X = 2\nUnit X = um\nUnit Data = nm",
    "# x-pixels: 5\n# x-length: 10\n# y-length: 8\n# x-unit: um\n# y-unit: um\n# z-unit: nm",
    "h=4 w=5\npixel size=2e-6 m\nheight conversion factor (-> nm)=1.0",
    "Wyko ASCII Data File Format 0 0 1\nX Size\t4\nY Size\t5\nPixel_size\t7\t4\t0.002\n"
    "Wavelength\t7\t4\t640\nMult\t7\t4\t640\nRAW_DATA\t3\t80",
    "# Channel: Phase\n# Value units: deg\n9 8 7 6\n"
    "# Channel: Topo\n# Width: 10 um\n# Height: 8 um\n# Value units: nm",
]


@pytest.mark.parametrize("header", WITHOUT_UNIT + WITH_UNIT)
def test_headers_of_programs(tmp_path: Path, header: str) -> None:
    """The exports of Gwyddion, SPIP, Nova, Attocube and two profilometers are one scan.

    Nanometres of heights, given or stated, do not make a scan of micrometres a thousandth.
    """
    path = tmp_path / "a.asc"
    encoding = {"# Kan": "utf-16", "# チャ": "utf-8-sig"}.get(header[:5], "utf-8")
    path.write_text(f"{header}\n{ROWS}", encoding)
    unit = {"unit": "1 nm"} if header in WITHOUT_UNIT else {}
    profile = _profile(pl.Grid(points=[5, 4], size=["10 um", "8 um"]), path, level="none", **unit)
    rows = np.array([row.split() for row in ROWS.splitlines()], dtype=float)
    assert profile == pytest.approx(1e-9 * (rows - 5).T, abs=1e-20)


TABLES = [
    "# h [nm], 4 x 3 points\n1.5,2,3,4\n4,nan,-6e0,1\n0,1,1,0\n",
    "1.5, 2, 3, 4\n4, nan, -6, 1\n0, 1, 1, 0\n",
    "1,5;2;3;4;\n4;;-6;1;\n0;1;1;0;\n",
    "1,5\t2\t3\t4\n4\tnan\t-6,0\t1\n0\t1\t1\t0\n",
    "1.5,2,3,4\r\n4,,-6,1\r\n0,1,1,0\r\n",
    "1.5\t2\t3\t4\t\n4\t\t-6\t1\t\n0\t1\t1\t0\n",
    "1.5,2,3,4\n4,NAN,-6,1\n0,1,1,0\n",
    "1.5;2;3;4\n4;bad;-6;1\n0;1;1;0\n",
]


@pytest.mark.parametrize("text", TABLES)
def test_tables_of_any_country(text: str) -> None:
    """Whatever separates columns and decimals, and stands for a missing point, it is one table."""
    (table,) = read_tables(text, Path("a.csv")).values()
    np.testing.assert_array_equal(table.values, [[1.5, 2, 3, 4], [4, np.nan, -6, 1], [0, 1, 1, 0]])


@pytest.mark.parametrize("mark", ["\t", ",", ";"])
@pytest.mark.parametrize("column", [0, 2, 4])
def test_missing_points_of_a_text_keep_their_place(mark: str, column: int) -> None:
    """One point missing in some rows, at an edge too: all others stay where they were measured."""
    heights = np.random.default_rng(2).normal(size=(6, 5))
    entries = [list(map(repr, row)) for row in heights.tolist()]
    for row in entries[1::2]:
        row[column] = ""
    heights[1::2, column] = np.nan
    (table,) = read_tables("\n".join(map(mark.join, entries)), Path("a.txt")).values()
    np.testing.assert_array_equal(table.values, heights)


@pytest.mark.parametrize("mark", [" ", "\t", ",", ";"])
@pytest.mark.parametrize("word", ["NA", "--", "#N/A"])
@pytest.mark.parametrize("count", [1, 5])
def test_no_row_of_a_text_is_lost(mark: str, word: str, count: int) -> None:
    """A word for a missing point is named with its line; below it the scan would move up."""
    entries = [["1.5", "2", "3", "4", "-5"] for _ in range(6)]
    entries[3][:count] = [word] * count
    text = "# Size: 5 um\n" + "\n".join(map(mark.join, entries))
    with pytest.raises(pl.ConfigError, match=rf"^path: .*'{word}' among the numbers of line 5;"):
        read_tables(text, Path("a.txt"))


def test_terrain(tmp_path: Path) -> None:
    """Bare whole numbers in a file named so are heights; one size is that of both edges."""
    path = tmp_path / "a.hgt"
    path.write_bytes(TERRAIN.astype(">i2").tobytes())
    fields = {"unit": 1e-9, "size": "1 mm", "level": "none"}
    terrain = pl.indenter("topography", path=path, **fields)
    profile = terrain.profile(*pl.Grid(points=24, size="1 mm").coordinates())
    lowered = np.sort(TERRAIN - TERRAIN.max(), axis=None) * 1e-9
    np.testing.assert_allclose(np.sort(profile, axis=None), lowered, atol=1e-18)


def test_without_the_library(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Where SurfaceTopography is not installed text is read, and the rest says how to get it."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "SurfaceTopography"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    (tmp_path / "a.txt").write_text(ROWS)
    pl.indenter("topography", path=tmp_path / "a.txt", unit="1 nm", size="10 um")
    (tmp_path / "a.gwy").write_bytes(GWY.read_bytes())
    with pytest.raises(pl.ConfigError, match=r"^type: .*pip install 'pellicle\[topography\]'"):
        pl.indenter("topography", path=tmp_path / "a.gwy")


def test_huge_scan_is_refused_before_it_is_read(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Memory is estimated from the 39 × 33 points in its header."""
    path = tmp_path / "a.gwy"
    path.write_bytes(GWY.read_bytes())
    monkeypatch.setattr(memory, "available", lambda: 2e4)
    message = r"^path: .* with its 39 × 33 points needs about 9\.27e-05 GB, .*export a part"
    with pytest.raises(pl.ConfigError, match=message):
        pl.indenter("topography", path=path)
