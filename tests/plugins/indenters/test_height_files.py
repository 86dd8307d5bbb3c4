"""Files of heights that mark, hide, claim or lack something: read, or refused in words."""

import tempfile
import tracemalloc
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import netcdf_file, savemat

import pellicle as pl
from pellicle import memory
from pellicle_plugins.indenters.text_table import read_tables

DATA = Path(__file__).parents[2] / "data"
GWY, X3P = DATA / "patch.gwy", DATA / "patch.x3p"
GRID = pl.Grid(points=[9, 7], size=["9 um", "7 um"])
ROUGH = np.random.default_rng(4).standard_normal((9, 7))
SCALE = {"unit": "1 nm", "size": ["9 um", "7 um"]}
FEW = settings(max_examples=12, deadline=None, derandomize=True)


def _text(path: Path, heights: np.ndarray) -> None:
    np.savetxt(path, heights.T, fmt="%.17g")


def _float32(path: Path, heights: np.ndarray) -> None:
    with np.errstate(over="ignore"):
        np.save(path, heights.astype(np.float32))


WRITERS: dict[str, Callable[[Path, np.ndarray], object]] = {
    "a.txt": _text,
    "a.npy": np.save,
    "b.npy": _float32,
    "a.mat": lambda path, heights: savemat(path, {"z": heights}),
}


def _topography(name: str, heights: np.ndarray, **fields: Any) -> tuple[pl.Indenter, list[str]]:
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        WRITERS[name](Path(folder) / name, heights)
        scan = pl.indenter("topography", path=Path(folder) / name, **SCALE | fields)
    return scan, [str(entry.message) for entry in caught]


@FEW
@given(
    name=st.sampled_from(sorted(WRITERS)),
    mark=st.sampled_from(
        [1e20, 1e30, 1.70141e38, 9.96921e36, 3.4028235e38, 1.7976931348623157e308]
    ),
    sign=st.sampled_from([1, -1]),
    cells=st.sets(st.integers(0, ROUGH.size - 1), min_size=1, max_size=9),
    level=st.sampled_from(["none", "tilt"]),
)
def test_what_is_beyond_any_surface_is_missing(
    name: str, mark: float, sign: int, cells: set[int], level: str
) -> None:
    """Numbers that no surface has are missing points: refused, or filled as NaN are."""
    profiles = []
    for value in (sign * mark, np.nan):
        heights = ROUGH.copy()
        heights.flat[sorted(cells)] = value
        scan, said = _topography(name, heights, fill=0.2, level=level)
        assert not said
        profiles.append(scan.profile(*GRID.coordinates()))
        with pytest.raises(pl.ConfigError, match=r"^fill: .* are missing, and fill allows 0"):
            _topography(name, heights)[0].profile(*GRID.coordinates())
    assert np.array_equal(profiles[0], profiles[1])


@FEW
@given(
    name=st.sampled_from(sorted(WRITERS)),
    mark=st.sampled_from([-9999, 9999, -99999, -32768, 32767, -32767, 65535, 99999, -999.25]),
    count=st.integers(1, 3),
    is_steep=st.booleans(),
)
def test_a_usual_mark_is_named(name: str, mark: float, count: int, is_steep: bool) -> None:
    """A warning counts points that have a usual mark as their height, steep or only apart."""
    heights = ROUGH.copy()
    heights.flat[10 : 10 + count] = mark
    _, said = _topography(name, heights, unit="1 um" if is_steep else "1 pm")
    (text,) = said
    assert f"{count} point{'s' * (count > 1)} of {mark:.10g}: if they mark missing" in text
    assert text.endswith("write nan")
    assert ("rms slope" in text) == is_steep
    with pytest.warns(UserWarning, match=f"of {mark:.10g}: if they mark missing .*crop them"):
        pl.indenter("heights", values=heights, unit="1 nm")


@FEW
@given(
    name=st.sampled_from(sorted(WRITERS)),
    marks=st.sampled_from([(0,), (255,), (-1234.5,), (32767, -32768), (77, -66), (9999, -9999)]),
    count=st.integers(1, 3),
)
def test_heights_apart_from_all_others_are_named(
    name: str, marks: tuple[float, ...], count: int
) -> None:
    """What a file marks missing points with needs no usual number, and may be at both ends."""
    heights = ROUGH + 30
    for number, mark in enumerate(marks):
        heights.flat[10 + 9 * number : 10 + 9 * number + count] = mark
    _, said = _topography(name, heights, unit="1 pm")
    (text,) = said
    for mark in marks:
        assert f"{count} point{'s' * (count > 1)} of {mark:.10g}: if they mark" in text


def test_a_pattern_of_two_heights_has_no_marks() -> None:
    """Neither height of a pattern is one, nor is a tip above rough heights."""
    bump = 30 * np.exp(-((np.arange(9)[:, None] - 4) ** 2 + (np.arange(7) - 3) ** 2) / 4)
    for heights in (np.where(ROUGH > 0, 0.0, 1.0), ROUGH + bump):
        assert not _topography("a.txt", heights, unit="1 pm")[1]


def test_a_mark_in_another_unit_is_named_where_it_is_steep() -> None:
    """Of a file in metres, in which -9999 nm are no usual number, what lies apart is named."""
    heights = 1e-9 * ROUGH
    heights[2, 3] = -9999e-9
    _, said = _topography("a.mat", heights, unit="1 m")
    assert said[0].endswith("it has 1 point of -9.999e-06: if they mark missing points, write nan")


def test_heights_that_have_the_number_of_a_mark_are_no_marks() -> None:
    """Among heights of their size -9999 and 32767 are heights."""
    heights = np.linspace(-9999, 32767, 63).reshape(9, 7)
    assert not _topography("a.txt", heights, unit="1 pm")[1]


@pytest.mark.parametrize("value", [1e308, -1e308, 1e31, 1.7e38])
def test_an_array_beyond_any_surface_is_refused(value: float, tmp_path: Path) -> None:
    """Such numbers are counted, without a warning of numpy; a file is named."""
    heights = np.where(ROUGH > 1, value, ROUGH)
    _text(tmp_path / "a.txt", heights)
    for fields in ({"values": heights}, {"path": tmp_path / "a.txt"}):
        with pytest.raises(pl.ConfigError, match=r"(the array|a\.txt) holds \d+ .*beyond any surf"):
            pl.indenter("heights", unit="1 um", **fields)


@pytest.mark.parametrize("name", ["scale_factor", "add_offset"])
def test_packed_numbers_are_refused(tmp_path: Path, name: str) -> None:
    """Numbers of a NetCDF that an attribute scales are no heights: they were a thousandfold."""
    with h5py.File(tmp_path / "a.nc", "w") as file:
        file["z"] = np.round(1e3 * ROUGH).astype("i2")
        file["z"].attrs[name] = 1e-3
    with pytest.raises(pl.ConfigError, match=f"has z packed by its attribute {name}"):
        pl.indenter("heights", path=tmp_path / "a.nc", unit="1 um")
    with h5py.File(tmp_path / "a.nc", "a") as file:
        del file["z"].attrs[name]
        file["z"].attrs["_FillValue"] = file["z"][:1, 0]
    with pytest.raises(pl.ConfigError, match="holds 1 NaN or infinite heights"):
        pl.indenter("heights", path=tmp_path / "a.nc", unit="1 um")


@pytest.mark.parametrize("digits", [1, 2, 3])
def test_commas_that_are_both_are_refused(tmp_path: Path, digits: int) -> None:
    """Rows such as 12,5,13,7 were taken for four heights, which need not be steep."""
    text = "\n".join(",".join(f"{10 * h:.{digits}f}".replace(".", ",") for h in r) for r in ROUGH.T)
    (tmp_path / "a.txt").write_text(text, encoding="utf-8")
    with pytest.raises(pl.ConfigError, match="may separate its columns and its decimals"):
        pl.indenter("topography", path=tmp_path / "a.txt", **SCALE)
    whole = np.round(1e2 * ROUGH)
    np.savetxt(tmp_path / "a.txt", whole.T, fmt="%d", delimiter=",")
    scan = pl.indenter("topography", path=tmp_path / "a.txt", level="none", **SCALE)
    profile = scan.profile(*GRID.coordinates())
    assert profile == pytest.approx(1e-9 * (whole - whole.max()), abs=1e-12)


def test_a_minus_of_typographers_is_one(tmp_path: Path) -> None:
    """Some programs write one."""
    _text(path := tmp_path / "a.txt", ROUGH)
    minus = path.read_text(encoding="utf-8").replace("-", "\N{MINUS SIGN}")
    (tmp_path / "b.txt").write_text(minus.replace("e\N{MINUS SIGN}", "e-"), encoding="utf-8")
    profiles = [
        pl.indenter("topography", path=tmp_path / f"{name}.txt", **SCALE).profile(
            *GRID.coordinates()
        )
        for name in "ab"
    ]
    assert np.array_equal(profiles[0], profiles[1])


# Formats and kinds


@FEW
@given(rows=st.integers(2, 40), seed=st.integers(0, 99), aspect=st.sampled_from([1.0, 2.5]))
def test_three_columns_under_a_size_are_a_matrix(rows: int, seed: int, aspect: float) -> None:
    """Heights of 3 × n points, square or not, are not taken for points x, y, z."""
    heights = np.random.default_rng(seed).normal(size=(rows, 3)).round(2 if seed % 2 else 9)
    size = f"# Width: 3.0 um\n# Height: {rows * aspect} um\n# Value units: nm\n"
    body = "\n".join(" ".join(map(repr, row)) for row in heights.tolist())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.txt"
        path.write_text(f"# Channel: Height\n{size}{body}\n")
        scan = pl.indenter("topography", path=path, level="none")
    profile = scan.profile(
        *pl.Grid(points=[3, rows], size=[3e-6, rows * aspect * 1e-6]).coordinates()
    )
    assert profile == pytest.approx(1e-9 * (heights - heights.max()).T, abs=1e-20)


def _hdf5(path: Path, **arrays: Any) -> None:
    with h5py.File(path, "w") as file:
        for name, values in arrays.items():
            file[name.replace("_", "/")] = values


Z_UNIT = b"si_unit_z\0oGwySIUnit\0\x0b\0\0\0unitstr\0s"


def _x3p(path: Path, old: bytes, new: bytes) -> None:
    with zipfile.ZipFile(X3P) as whole, zipfile.ZipFile(path, "w") as changed:
        for name in whole.namelist():
            content = whole.read(name)
            changed.writestr(name, content.replace(old, new) if name == "main.xml" else content)


NO_HEIGHTS: dict[str, tuple[str, Callable[[Path], object], str]] = {
    "3-D": (
        "a.h5",
        lambda p: _hdf5(p, z=np.zeros((1, 4, 6))),
        r"'z' of shape \(1, 4, 6\), float64; save",
    ),
    "groups": (
        "a.h5",
        lambda p: _hdf5(p, g_t=np.zeros(3), g_n="x"),
        r"'g/n' .*'g/t' of shape \(3,",
    ),
    "nothing": ("a.h5", lambda p: _hdf5(p), "but nothing; save"),
    "current": (
        "a.gwy",
        lambda p: p.write_bytes(GWY.read_bytes().replace(Z_UNIT + b"m", Z_UNIT + b"V")),
        "no image of heights, but 'Height' in V",
    ),
    "little": (
        "a.tif",
        lambda p: p.write_bytes(b"II*\0" + bytes(60)),
        "TIFF image without a scale",
    ),
    "big": ("a.tiff", lambda p: p.write_bytes(b"MM\0+" + bytes(60)), "TIFF image without a scale"),
    "2020": (
        "a.x3p",
        lambda p: _x3p(p, b"ISO5436 - 2000", b"ISO25178-72:2017/DAM1"),
        "revision 'ISO25178-72:2017/DAM1' with heights in a binary .*'ISO5436 - 2000', heights in",
    ),
    "text": ("a.x3p", lambda p: _x3p(p, b"PointDataLink", b"DataList"), "with heights in text"),
    "profile": ("a.x3p", lambda p: _x3p(p, b">SUR<", b">PRF<"), r"read: areal \(SUR\)"),
}


@pytest.mark.parametrize("kind", NO_HEIGHTS)
def test_a_file_without_heights_is_told_what_it_holds(kind: str, tmp_path: Path) -> None:
    """A sound file without heights that can be read is not called damaged for what it holds."""
    name, write, message = NO_HEIGHTS[kind]
    write(tmp_path / name)
    with pytest.raises(pl.ConfigError, match=rf"^path: .*{name} .*{message}"):
        pl.indenter("topography", path=tmp_path / name)


def test_a_mask_of_gwyddion_is_told_as_one(tmp_path: Path) -> None:
    """Gwyddion marks grains, or anything, by masks: what is masked need not be missing."""
    from SurfaceTopography import Topography

    heights = np.ma.masked_greater(1e-9 * ROUGH, 1e-9)
    Topography(heights, (9e-6, 7e-6), unit="m").to_gwy(str(tmp_path / "a.gwy"))
    scan = pl.indenter("topography", path=tmp_path / "a.gwy")
    with pytest.raises(pl.ConfigError, match="are marked by the mask of the file, or missing, and"):
        scan.profile(*GRID.coordinates())


def test_a_current_is_no_height(tmp_path: Path) -> None:
    """Gwyddion writes A for the ampere, not for the ångström."""
    content = GWY.read_bytes().replace(Z_UNIT + b"m", Z_UNIT + b"A")
    (tmp_path / "a.gwy").write_bytes(content)
    with pytest.raises(
        pl.ConfigError, match=r"^channel: 'Height' of .*a\.gwy is in A, not heights"
    ):
        pl.indenter("topography", path=tmp_path / "a.gwy")


CUTS: dict[str, Callable[[Any], Any]] = {
    "half": lambda a: a[: len(a) // 2],
    "middle": lambda a: a[4:12],
    "reversed": lambda a: a[::-1],
    "picked": lambda a: a[[0, 1, 2, 3, 8, 9, 10, 11]],
}


def _netcdf(
    path: Path,
    cut: Callable[[Any], Any],
    axis: int,
    order: str = "xy",
    shape: tuple[int, int] = (16, 12),
) -> None:
    """Write a part of a map as SurfaceTopography writes the whole."""
    heights = 0.1 * np.random.default_rng(1).standard_normal(shape)
    heights = np.moveaxis(cut(np.moveaxis(heights, axis, 0)), 0, axis)
    with netcdf_file(path, "w", version=2) as file:
        for name, n, number, length in zip("xy", heights.shape, shape, (8.0, 6.0), strict=True):
            file.createDimension(name, n)
            points = file.createVariable(name, "f8", (name,))
            whole = np.arange(number) / number * length
            points[:] = cut(whole) if "xy"[axis] == name else whole
            points.length, points.unit, points.periodic = length, "um", 1
        values = file.createVariable("heights", "f8", tuple(order))
        values[:] = heights if order == "xy" else heights.T
        values.unit = "um"


@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("axis", [0, 1])
def test_a_part_of_a_netcdf_map_is_not_stretched(cut: str, axis: int, tmp_path: Path) -> None:
    """A part that states the size of the whole is refused; each second point has that size."""
    path = tmp_path / "a.nc"
    _netcdf(path, CUTS[cut], axis)
    with pytest.raises(pl.ConfigError, match=r"^path: .*a\.nc is a part of a map, or turned"):
        pl.indenter("topography", path=path)
    _netcdf(path, lambda a: a[:-1], axis, shape=(160, 120))
    with pytest.raises(pl.ConfigError, match="is a part of a map"):
        pl.indenter("topography", path=path)
    _netcdf(path, lambda a: a[::2], axis)
    scan = pl.indenter("topography", path=path)
    points = [16, 12]
    points[axis] //= 2
    profile = scan.profile(*pl.Grid(points=points, size=["8 um", "6 um"]).coordinates())
    assert profile.max() == pytest.approx(0, abs=1e-20)


def test_a_netcdf_map_of_other_kinds_is_told(tmp_path: Path) -> None:
    """Heights along y, x are not taken for x, y; `heights` says how to read a classic NetCDF."""
    path = tmp_path / "a.nc"
    _netcdf(path, lambda a: a, 0, "yx")
    with pytest.raises(pl.ConfigError, match=r"part of a map, or turned.*transpose heights"):
        pl.indenter("topography", path=path)
    with pytest.raises(pl.ConfigError, match=r"a\.nc .*classic NetCDF as type = 'topography'"):
        pl.indenter("heights", path=path, unit="1 um")


# Hostile files


def _bomb_x3p(path: Path) -> None:
    _x3p(path, b"", b"")
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("bindata/more.bin", bytes(3_000_000))


def _bomb_xml(path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("main.xml", b"<a>" + b"<b/>" * 50_000 + b"</a>")


def _bomb_mat(path: Path) -> None:
    savemat(path, {"z": np.zeros((1000, 300)), "s": {"n": 1}}, do_compression=True)


def _bomb_mat73(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("z", (1000, 300), "f8", chunks=(100, 300), compression="gzip")


@pytest.mark.parametrize(
    ("kind", "name", "write"),
    [
        ("topography", "a.x3p", _bomb_x3p),
        ("topography", "a.x3p", _bomb_xml),
        ("heights", "a.mat", _bomb_mat),
        ("heights", "a.mat", _bomb_mat73),
    ],
)
def test_what_an_archive_unpacks_to_is_added_up_first(
    kind: str,
    name: str,
    write: Callable[[Path], object],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A small file that states more than the memory is refused before it is unpacked."""
    path = tmp_path / name
    write(path)
    monkeypatch.setattr(memory, "available", lambda: 2e6)
    tracemalloc.start()
    try:
        with pytest.raises(pl.ConfigError, match=rf"{name} .*unpacks to.* GB, and 0\.002 GB are"):
            pl.indenter(kind, path=path, **({"unit": "1 um"} if kind == "heights" else {}))
        assert tracemalloc.get_traced_memory()[1] < 2e6
    finally:
        tracemalloc.stop()


def _virtual(path: Path) -> None:
    layout = h5py.VirtualLayout((9, 7), "f8")
    layout[:] = h5py.VirtualSource(str(path.with_name("other.h5")), "z", (9, 7))
    with h5py.File(path, "w") as file:
        file.create_virtual_dataset("z", layout)


def _external(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("z", (9, 7), "f8", external=[(str(path.with_name("raw")), 0, 504)])


@pytest.mark.parametrize("write", [_virtual, _external])
@pytest.mark.parametrize(
    ("kind", "name"), [("heights", "a.h5"), ("heights", "a.mat"), ("topography", "a.h5")]
)
def test_heights_outside_of_their_file_are_refused(
    write: Callable[[Path], None], kind: str, name: str, tmp_path: Path
) -> None:
    """The hash of a file does not cover what is in other files."""
    _hdf5(tmp_path / "other.h5", z=ROUGH)
    (tmp_path / "raw").write_bytes(ROUGH.tobytes())
    write(tmp_path / name)
    scale = SCALE if kind == "topography" else {"unit": "1 nm"}
    with pytest.raises(pl.ConfigError, match=rf"^path: .*{name} .*takes /?z from other files"):
        pl.indenter(kind, path=tmp_path / name, **scale)


@pytest.mark.parametrize("name", ["a.h5", "a.mat"])
def test_a_tree_that_leads_to_itself_is_walked_once(name: str, tmp_path: Path) -> None:
    """Links in circles, forty of two ways each, and a cell of itself are no endless trees."""
    with h5py.File(tmp_path / name, "w") as file:
        file["z"] = ROUGH.T if name == "a.mat" else ROUGH
        group = file
        for _ in range(40):
            below = group.create_group("a")
            group["b"] = below
            below["root"] = file["/"]
            group = below
        if name == "a.mat":
            cell = file.create_dataset("c", (1,), h5py.ref_dtype)
            cell[0] = cell.ref
    punch = pl.indenter("heights", path=tmp_path / name, unit="1 m")
    assert np.array_equal(punch.profile(*GRID.coordinates()), ROUGH - ROUGH.max())


@FEW
@given(
    row=st.sampled_from(["1 ", "1.234567 ", "nan ", "1,", ",", "1;", "-1.5e-09\t", "#a", "ab cd "]),
    columns=st.sampled_from([1, 30, 3000]),
)
def test_text_takes_no_more_memory_than_is_reckoned(row: str, columns: int) -> None:
    """Rows of numbers, of separators, of comments and of words, however long."""
    text = (row * columns + "\n") * (20_000 // columns)
    reckoned: list[float] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(memory, "available", lambda: 0.0)
        patch.setattr(memory, "shortage", lambda needed, _: reckoned.append(needed))
        with pytest.raises(pl.ConfigError):
            read_tables(text, Path("a.txt"))
    tracemalloc.start()
    try:
        read_tables(text, Path("a.txt"))
        assert tracemalloc.get_traced_memory()[1] < reckoned[0]
    finally:
        tracemalloc.stop()


RUBBISH = bytes(range(256)) * 8


@pytest.mark.parametrize("kind", ["heights", "topography"])
@pytest.mark.parametrize("name", ["a.npy", "a.txt", "a.h5", "a.mat", "a.nc", "a.x3p", "a.gwy"])
def test_an_error_of_reading_names_the_file(kind: str, name: str, tmp_path: Path) -> None:
    """Rubbish, a reader that raises anything, and a hash: one line with the name of the file."""
    (tmp_path / name).write_bytes(RUBBISH)
    with pytest.raises(pl.ConfigError, match=name) as caught:
        pl.indenter(kind, path=tmp_path / name, **SCALE if kind == "topography" else {"unit": 1.0})
    assert "\n" not in str(caught.value)
    _text(tmp_path / "b.txt", ROUGH)
    fields = (SCALE if kind == "topography" else {"unit": 1.0}) | {"sha256": "0"}
    with pytest.raises(pl.ConfigError, match=r"^sha256: .*b\.txt"):
        pl.indenter(kind, path=tmp_path / "b.txt", **fields)
