"""Measured surfaces.

``patch.gwy`` and ``patch.x3p`` in tests/data hold one surface made of 40 waves with a tilt, of
39 × 33 points on 1.3 mm × 1.1 mm; the second lacks 7 points. tests/data/patch.py makes them.
"""

from __future__ import annotations

import io
import pickle
import runpy
import sys
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
from typer.testing import CliRunner

import pellicle as pl
from pellicle import memory
from pellicle.cli.app import app

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


def test_files_are_what_their_script_makes(tmp_path: Path) -> None:
    """The script beside the files writes the same surfaces again."""
    PATCH["write"](tmp_path)
    for path in (GWY, X3P):
        profile = _profile(path=tmp_path / path.name, fill=0.01)
        assert profile == pytest.approx(_profile(path=path, fill=0.01), abs=5e-12)


def test_both_formats_agree() -> None:
    """The same surface in two formats is the same, to single precision and but for what is lost."""
    one, two = _profile(level="none"), _profile(path=X3P, level="none", fill=0.01)
    difference = abs(one - two)
    assert difference[~PATCH["MISSING"]].max() < 5e-12
    # Filled points lie among their neighbours.
    assert difference.max() < 2e-6


def test_levels(tmp_path: Path) -> None:
    """A plane, or a paraboloid, added to the heights is taken away again."""
    x, y = GRID.coordinates()
    plane, bowl = 0.03 * x - 0.01 * y, 10 * x**2 - 30 * x * y + 20 * y**2
    for level, added, left in (
        ("none", plane, plane),
        ("mean", plane, plane),
        ("tilt", plane, 0),
        ("curvature", plane + bowl, 0),
    ):
        before, after = (
            _from_array(tmp_path, _heights() + more, level).profile(x, y) for more in (0, added)
        )
        difference = after - before - left
        assert np.ptp(difference) < 1e-15, level
    # A paraboloid is not level by a plane.
    bowed = _from_array(tmp_path, _heights() + bowl, "tilt").profile(x, y)
    assert np.ptp(bowed - _from_array(tmp_path, _heights(), "tilt").profile(x, y)) > 1e-9


@pytest.mark.parametrize("path", [GWY, X3P])
def test_what_is_left_by_a_level_has_none_of_it(path: Path) -> None:
    """Least squares: what is left has no product with any polynomial of the level's degree."""
    x, y = (np.broadcast_to(axis / 1e-3, GRID.shape) for axis in GRID.coordinates())
    for level, polynomials in (
        ("tilt", [x, y]),
        ("curvature", [x, y, x**2, x * y, y**2]),
    ):
        left = _profile(path=path, level=level, fill=0.01)
        left -= left.mean()
        for polynomial in polynomials:
            assert abs(np.mean(left * polynomial)) < 1e-15 * np.ptp(left), level


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
    with pytest.warns(UserWarning, match="not periodic along [xy]"):
        result = pl.run(
            {
                "grid": {"points": [39, 33], "size": ["1.3 mm", "1.1 mm"], "boundary": "periodic"},
                "kernel": {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": "20 mN/m"},
                "indenter": {"type": "topography", "path": str(X3P), "fill": 0.01},
                "loading": {"mean_pressure": "30 Pa"},
            },
            progress=False,
        )
    assert result.converged
    assert ", SurfaceTopography " in result.dataset.attrs["versions"]
    data = result.dataset.isel(step=0)
    profile = (data["displacement"] - data["depth"] - data["gap"]).values
    touching = profile[data["contact"].values]
    assert 0 < touching.size < profile.size / 2
    assert touching.mean() > profile.mean() + profile.std()


def test_is_recorded_by_the_hash_of_the_file(tmp_path: Path) -> None:
    """The hash of the file is written down, and a file that has changed is refused."""
    path = tmp_path / "a.gwy"
    path.write_bytes(GWY.read_bytes())
    indenter = pl.indenter("topography", path=path)
    recorded = indenter.model_dump(exclude_none=True)
    copy = pickle.loads(pickle.dumps(indenter))
    assert copy == indenter
    assert np.array_equal(copy.profile(*GRID.coordinates()), _profile())
    changed = bytearray(path.read_bytes())
    changed[-3000] ^= 1
    path.write_bytes(changed)
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
    changed = bytearray(path.read_bytes())
    changed[-3000] ^= 1
    path.write_bytes(changed)
    assert _run(path).identity != first


def test_workers_need_no_file(tmp_path: Path) -> None:
    """A run that is sent to a worker has its heights with it."""
    path = tmp_path / "a.gwy"
    path.write_bytes(GWY.read_bytes())
    sent = pickle.dumps(_run(path, level="none"))
    path.unlink()
    profile = pickle.loads(sent).indenter.profile(*GRID.coordinates())
    assert profile == pytest.approx(_profile(level="none"), abs=1e-19)


def test_parts_of_one_scan_share_its_heights() -> None:
    """A study over places of a scan reads it once, and holds it once."""
    centres = [["0.5 mm", "0.5 mm"], ["0.6 mm", "0.4 mm"]]
    study = pl.Study(run=_run(GWY), vary={"indenter.parts.0.centre": centres})
    indenters: list[Any] = [point.run.indenter for point in study.points]
    first, second = (indenter.parts[0] for indenter in indenters)
    assert first != second
    assert first._heights is second._heights


def test_example_runs_from_a_file_and_warns(tmp_path: Path) -> None:
    """docs/studies/topography.toml, seen from elsewhere; on cells too fine it says so in a line."""
    words = ["run", str(ROOT / "docs/studies/topography.toml"), "-o", str(tmp_path), "--threads=1"]
    finer = [
        "--set",
        "grid.points=[78, 66]",
        "--set",
        "loading.depth='3 um'",
        "--set",
        "outputs=[{type='csv'}]",
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        done = CliRunner().invoke(app, [*words, *finer])
    assert done.exit_code == 0, done.output
    lines = [line for line in done.stderr.splitlines() if line.startswith("warning: ")]
    assert len(lines) == 1
    assert "finer than the points of" in lines[0]


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


def test_unknown_format_names_some_that_can_be_read(tmp_path: Path) -> None:
    """A file of no known format is answered with usual formats, and with those of text."""
    file = tmp_path / "a.bin"
    file.write_bytes(b"\x01\x02nothing that anybody reads" * 9)
    with pytest.raises(pl.ConfigError, match=r"unknown format.*gwy.*x3p.*commas"):
        pl.indenter("topography", path=file)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({}, r"^unit: is missing, .* the length that 1 stands for"),
        ({"unit": "1 um"}, r"^size: is missing, .*edge lengths"),
    ],
)
def test_what_a_file_does_not_say_is_asked_for(
    tmp_path: Path, fields: dict[str, Any], message: str
) -> None:
    """Plain numbers have neither unit nor size: both are asked for by the name of the field."""
    np.savetxt(tmp_path / "a.txt", _heights() * 1e6)
    with pytest.raises(pl.ConfigError, match=message):
        pl.indenter("topography", path=tmp_path / "a.txt", **fields)


def test_size_of_zero_is_none(tmp_path: Path) -> None:
    """A file whose edges are 0 does not say its size: it is asked for, and taken."""
    path = tmp_path / "a.txt"
    header = "Channel: Height\nWidth: 0 um\nHeight: 0 um\nValue units: um"
    np.savetxt(path, _heights().T * 1e6, header=header)
    with pytest.raises(pl.ConfigError, match=r"^size: is missing, .* does not state it"):
        pl.indenter("topography", path=path)
    sized = _profile(path=path, level="none", size=GRID.size)
    assert sized == pytest.approx(_profile(level="none"), abs=1e-19)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"unit": "1 um"}, "^unit: .*states its own unit"),
        ({"size": ["1 um", "1 um"]}, r"^size: .*states its own size, 0.0013 × 0.0011 m"),
        ({"channel": "Phase"}, r"^channel: 'Phase' is not in .*: 'Height'"),
        ({"fill": 1}, "^fill: .*< 1"),
        ({"level": "cubic"}, "^level: .*curvature"),
    ],
)
def test_bad_fields(fields: dict[str, Any], message: str) -> None:
    """What contradicts the file, or is not allowed, is named with what is."""
    with pytest.raises(pl.ConfigError, match=message):
        pl.indenter("topography", path=GWY, **fields)


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
        (
            "1.2 mm",
            None,
            r"^path: the domain reaches along y .* grid\.size at most 1\.1 mm",
        ),
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


@pytest.mark.parametrize("header", ["", "Lateral units: um\nValue units: um"])
def test_irregular_points_are_refused(tmp_path: Path, header: str) -> None:
    """Columns x, y, z are read where they make a regular grid; no others are taken for heights."""
    x, y = (points.ravel() for points in np.meshgrid([0.0, 1, 2, 3], [0.0, 1, 2], indexing="ij"))
    regular, irregular = tmp_path / "regular.xyz", tmp_path / "irregular.xyz"
    np.savetxt(regular, np.stack([x, y, x * y / 10], axis=1), header=header)
    np.savetxt(irregular, np.stack([x**2, y, x * y], axis=1), header=header)
    unit = {} if header else {"unit": "1 um"}
    grid = pl.Grid(points=[4, 3], size=["4 um", "3 um"])
    profile = _profile(grid, regular, level="none", **unit)
    assert profile == pytest.approx((x * y - 6).reshape(4, 3) * 1e-7, abs=1e-18)
    with pytest.raises(pl.ConfigError, match=r"^path: .* irregular distances; resample"):
        pl.indenter("topography", path=irregular, **unit)


SIZED = "Channel: Main\nWidth: 4 um\nHeight: 3 um\nValue units: um"


@pytest.mark.parametrize("unit", [1.0, 1e-6])
def test_coordinates_under_a_header_with_sizes(unit: float, tmp_path: Path) -> None:
    """Three columns on a regular grid, in any order and length unit, are its heights."""
    x, y = (axis.ravel() for axis in np.meshgrid([0.0, 1, 2, 3], [0.0, 1, 2], indexing="ij"))
    columns = np.stack([unit * x, unit * y, x * y / 10], axis=1)
    path = tmp_path / "a.txt"
    np.savetxt(path, np.random.default_rng(0).permutation(columns), header=SIZED)
    profile = _profile(pl.Grid(points=[4, 3], size=["4 um", "3 um"]), path, level="none")
    assert profile == pytest.approx((x * y - 6).reshape(4, 3) * 1e-7, abs=1e-18)


@pytest.mark.parametrize(
    ("change", "header", "message"),
    [
        (lambda c: c[:-1], SIZED, "irregular distances"),
        (lambda c: c[[0, *range(11)]], SIZED, "irregular distances"),
        (lambda c: c * [0, 1, 1], SIZED, "irregular distances"),
        (lambda c: c + [[0, 0.2, 0]] * (c[:, :1] > 2), SIZED, "irregular distances"),
        (
            lambda c: c,
            SIZED.replace("3 um", "30 um"),
            r"states a size of 4 um × 30 um, and its coordinates are as 4 to 3",
        ),
    ],
)
def test_coordinates_that_are_no_grid_of_that_size(
    change: Callable[[np.ndarray], np.ndarray], header: str, message: str, tmp_path: Path
) -> None:
    """A point that is missing, twice or off its place, and another size, are refused."""
    x, y = (axis.ravel() for axis in np.meshgrid([0.0, 1, 2, 3], [0.0, 1, 2], indexing="ij"))
    np.savetxt(tmp_path / "a.txt", change(np.stack([x, y, x * y], axis=1)), header=header)
    with pytest.raises(pl.ConfigError, match=rf"^path: .*{message}"):
        pl.indenter("topography", path=tmp_path / "a.txt")


@pytest.mark.parametrize(
    ("header", "fields", "message"),
    [
        (
            "Width: 160 m\nHeight: 160 m\nValue units: um",
            {},
            r"measures 160 × 160 m: a unit may be wrong; if so, export it again",
        ),
        (
            "Width: 160 um\nHeight: 160 um\nValue units: mm",
            {},
            r"has an rms slope of \d+\.?\d*: a unit may be wrong; if so, export it again",
        ),
        ("", {"unit": "1 mm", "size": "80 um"}, r"rms slope .*; if so, correct unit or size"),
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


@pytest.mark.parametrize(
    "text",
    [
        "# h [nm], 4 x 3 points\n1.5,2,3,4\n4,nan,-6e0,1\n0,1,1,0\n",
        "1.5, 2, 3, 4\n4, nan, -6, 1\n0, 1, 1, 0\n",
        "1,5;2;3;4;\n4;;-6;1;\n0;1;1;0;\n",
        "1,5\t2\t3\t4\n4\tnan\t-6,0\t1\n0\t1\t1\t0\n",
        "1.5,2,3,4\r\n4,,-6,1\r\n0,1,1,0\r\n",
        "1.5\t2\t3\t4\t\n4\t\t-6\t1\t\n0\t1\t1\t0\n",
        "1.5,2,3,4\n4,NAN,-6,1\n0,1,1,0\n",
        "\ufeff1.5 2 3 4\n4 nan -6 1\n0 1 1 0\n",
        "\ufeff1.5;2;3;4\n4;bad;-6;1\n0;1;1;0\n",
    ],
)
def test_numbers_between_commas_or_semicolons(tmp_path: Path, text: str) -> None:
    """Tables as spreadsheets of any country write them are the same scan as one with blanks."""
    heights = []
    for name, content in (("a.csv", text), ("b.txt", "1.5 2 3 4\n4 nan -6 1\n0 1 1 0\n")):
        path = tmp_path / name
        path.write_text(content, encoding="utf-8", newline="")
        scan = pl.indenter("topography", path=path, unit="1 nm", size=["1 mm", "1 mm"], fill=0.2)
        heights.append(scan.profile(*pl.Grid(points=[4, 3], size="1 mm").coordinates()))
    assert heights[0] == pytest.approx(heights[1], abs=0)


ROWS = "1 2 3 4 5\n2 2 2 2 2\n5 4 3 2 1\n2 2 2 2 2\n"
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
    path.write_text(f"{header}\n{ROWS}", "utf-16" if "Kanal" in header else "utf-8")
    unit = {"unit": "1 nm"} if header in WITHOUT_UNIT else {}
    profile = _profile(pl.Grid(points=[5, 4], size=["10 um", "8 um"]), path, level="none", **unit)
    rows = np.array([row.split() for row in ROWS.splitlines()], dtype=float)
    assert profile == pytest.approx(1e-9 * (rows - 5).T, abs=1e-20)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("h=4 w=5\n1 2 3 4 5\n", "states 4 rows of heights and has 1"),
        ("# Channel: Phase\n# Value units: deg\n" + ROWS, "'Phase' of .* is in deg, not heights"),
        ("Width: 10,5 µm\nHeight: 8,2 µm\n" + ROWS, "states its size in ',5 µm', which is"),
        (ROWS + "1 2 3\n", "rows of 5 and 3 numbers, in lines 1 and 5"),
        (ROWS.replace("3", "1.2.3"), r"damaged or incomplete \(could not convert .*'1.2.3'"),
    ],
)
def test_damaged_texts(tmp_path: Path, text: str, message: str) -> None:
    """Rows that are missing, numbers that are no heights, and sizes in no unit, are refused."""
    (tmp_path / "a.txt").write_text(text, encoding="utf-8")
    with pytest.raises(pl.ConfigError, match=message):
        pl.indenter("topography", path=tmp_path / "a.txt", unit="1 nm", size="10 um")


def test_text_needs_no_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Plain text is read where SurfaceTopography is not installed."""
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    monkeypatch.setitem(sys.modules, "SurfaceTopography.IO", None)
    (tmp_path / "a.txt").write_text(ROWS)
    scan = pl.indenter("topography", path=tmp_path / "a.txt", unit="1 nm", size="10 um")
    assert scan.profile(*pl.Grid(points=[5, 4], size="10 um").coordinates()).shape == (5, 4)


@pytest.mark.parametrize("mark", ["\t", ",", ";"])
@pytest.mark.parametrize("column", [0, 2, 4])
def test_missing_points_of_a_text_keep_their_place(tmp_path: Path, mark: str, column: int) -> None:
    """One point missing in some rows, at an edge too: all others stay where they were measured."""
    heights = np.random.default_rng(2).normal(size=(6, 5))
    rows = [list(map(repr, row)) for row in heights.tolist()]
    for row in rows[1::2]:
        row[column] = ""
    path = tmp_path / "a.txt"
    path.write_text("\n".join(map(mark.join, rows)))
    scan = pl.indenter(
        "topography", path=path, unit=1e-9, size=["5 um", "6 um"], fill=0.5, level="none"
    )
    profile = scan.profile(*pl.Grid(points=[5, 6], size=["5 um", "6 um"]).coordinates())
    measured = np.array([[bool(entry) for entry in row] for row in rows]).T
    difference = (profile - heights.T * 1e-9)[measured]
    assert np.ptp(difference) < 1e-20


@pytest.mark.parametrize("mark", [" ", "\t", ",", ";"])
@pytest.mark.parametrize("word", ["NA", "--", "#N/A"])
@pytest.mark.parametrize("count", [1, 5])
def test_no_row_of_a_text_is_lost(tmp_path: Path, mark: str, word: str, count: int) -> None:
    """A word for a missing point is named with its line; below it the scan would move up."""
    rows = [["1.5", "2", "3", "4", "-5"] for _ in range(6)]
    rows[3][:count] = [word] * count
    path = tmp_path / "a.txt"
    path.write_text("# Size: 5 um\n" + "\n".join(map(mark.join, rows)))
    with pytest.raises(pl.ConfigError, match=rf"^path: .*'{word}' among the numbers of line 5;"):
        pl.indenter("topography", path=path, unit=1e-9, size="5 um")


def test_any_file_of_the_right_length_is_no_terrain(tmp_path: Path) -> None:
    """Bare whole numbers, a format without a mark, are read from files named so only."""
    path = tmp_path / "a.bin"
    heights = np.random.default_rng(1).integers(0, 500, (24, 24))
    path.write_bytes(heights.astype(">i2").tobytes())
    with pytest.raises(pl.ConfigError, match=r"^path: .*unknown format"):
        pl.indenter("topography", path=path, unit="1 nm", size="1 um")
    fields = {"unit": 1e-9, "size": "1 mm", "level": "none"}
    terrain = pl.indenter("topography", path=path.rename(tmp_path / "a.hgt"), **fields)
    profile = terrain.profile(*pl.Grid(points=24, size="1 mm").coordinates())
    lowered = np.sort(heights - heights.max(), axis=None) * 1e-9
    np.testing.assert_allclose(np.sort(profile, axis=None), lowered, atol=1e-18)


def test_complex_heights_are_refused(tmp_path: Path) -> None:
    """A part that is imaginary is not dropped."""
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"z": _heights() * (1 + 1j)})
    with pytest.raises(pl.ConfigError, match=r"^path: .* holds complex values"):
        pl.indenter("topography", path=path, unit=1, size=["1.3 mm", "1.1 mm"])


def test_column_says_how_line_contact_is_run(tmp_path: Path) -> None:
    """A scan one point wide is answered with what to do instead."""
    np.save(tmp_path / "a.npy", np.zeros((8, 1)))
    with pytest.raises(pl.ConfigError, match=r"\(8, 1\) points; .*grid\.points = \[…, 1\]"):
        pl.indenter("topography", path=tmp_path / "a.npy", unit=1, size="1 mm")


@pytest.mark.parametrize("power", [1, 2])
def test_profile_along_a_line_is_refused(tmp_path: Path, power: int) -> None:
    """A line scan, of equal or unequal steps, is answered with what to do instead."""
    x = np.linspace(0, 1, 20) ** power
    np.savetxt(tmp_path / "line.txt", np.stack([x, np.sin(x)], axis=1))
    with pytest.raises(
        pl.ConfigError, match=r"^path: .*profile along a line.*grid\.points = \[…, 1\]"
    ):
        pl.indenter("topography", path=tmp_path / "line.txt", unit="1 um")


@pytest.mark.parametrize(
    ("available", "message"),
    [
        # The file has 10,526 bytes, and 39 × 33 points.
        (1e4, r"^path: .*, a file of 1\.05e-05 GB, needs about 1\.05e-05 GB, and 1e-05 GB"),
        (2e4, r"^path: .* with its 39 × 33 points needs about 9\.27e-05 GB, .*export a part"),
    ],
)
def test_huge_file_is_refused_before_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, available: float, message: str
) -> None:
    """Memory is estimated from the length of the file, then from the points in its header."""
    path = tmp_path / "a.gwy"
    path.write_bytes(GWY.read_bytes())
    monkeypatch.setattr(memory, "available", lambda: available)
    with pytest.raises(pl.ConfigError, match=message):
        pl.indenter("topography", path=path)


def test_huge_hole_is_not_filled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Filling takes memory by the number of missing points."""
    indenter = pl.indenter("topography", path=X3P, fill=0.01)
    monkeypatch.setattr(memory, "available", lambda: 6e3)
    with pytest.raises(pl.ConfigError, match=r"^fill: filling in 0\.54% .* needs about 6\.3e-06"):
        indenter.profile(*GRID.coordinates())


def test_without_the_extra_it_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where SurfaceTopography is not installed, the message has the command."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "SurfaceTopography"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    path = tmp_path / "a.gwy"
    path.write_bytes(GWY.read_bytes())
    with pytest.raises(pl.ConfigError, match=r"^type: .*pip install 'pellicle\[topography\]'"):
        pl.indenter("topography", path=path)


def test_no_such_file() -> None:
    """A file that is not there is named."""
    with pytest.raises(pl.ConfigError, match=r"^path: nowhere\.x3p: no such file"):
        pl.indenter("topography", path="nowhere.x3p")


def test_one_size_is_that_of_both_edges(tmp_path: Path) -> None:
    """As that of a grid."""
    path = tmp_path / "scan.txt"
    np.savetxt(path, np.random.default_rng(0).standard_normal((6, 6)) / 10)
    given = {"path": path, "unit": "1 um"}
    one, two = (pl.indenter("topography", size=s, **given) for s in ("6 um", ["6 um", "6 um"]))
    assert one == two
