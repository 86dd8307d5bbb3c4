"""Heights from files and arrays."""

import hashlib
import pickle
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

import pellicle as pl
from tests.plugins.outputs.shared import bead

ROUGH = np.random.default_rng(5).normal(size=(8, 6))


def _profile(indenter: pl.Indenter, points: tuple[int, int] = (8, 6)) -> np.ndarray:
    return indenter.profile(*pl.Grid(points=points, size=1.0).coordinates())


def _write_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["group/rough"] = ROUGH


WRITERS: dict[str, Callable[[Path], object]] = {
    "a.npy": lambda path: np.save(path, ROUGH),
    "a.txt": lambda path: np.savetxt(path, ROUGH, fmt="%.17g", header="rough"),
    "a.dat": lambda path: np.savetxt(path, ROUGH, fmt="%.17g", delimiter="\t"),
    "a.csv": lambda path: np.savetxt(path, ROUGH, fmt="%.17g", delimiter=", "),
    "a.h5": _write_hdf5,
}


@pytest.mark.parametrize("name", WRITERS)
def test_file(tmp_path: Path, name: str) -> None:
    """Every format gives the heights below the highest, in the unit given, along x then y."""
    WRITERS[name](tmp_path / name)
    profile = _profile(pl.indenter("heights", path=tmp_path / name, unit="1 um"))
    assert profile == pytest.approx((ROUGH - ROUGH.max()) * 1e-6, rel=1e-14)
    assert profile.max() == 0


@pytest.mark.parametrize(
    ("above", "below"), [("# rough\n", ""), ("My scan, nm\n\nWidth: 8 um\n", "# end\n")]
)
def test_text_has_a_header(tmp_path: Path, above: str, below: str) -> None:
    """Words above the rows are no heights, as `topography` sees it too."""
    rows = "\n".join(" ".join(map(repr, row)) for row in ROUGH.tolist())
    (tmp_path / "a.txt").write_text(f"{above}{rows}  # last\n{below}")
    profile = _profile(pl.indenter("heights", path=tmp_path / "a.txt", unit="1 um"))
    assert profile == pytest.approx((ROUGH - ROUGH.max()) * 1e-6, rel=1e-14)


@pytest.mark.parametrize("begin", ["Wyko ASCII Data File Format 0 0 1", "aISO-1.0"])
def test_text_with_a_scale_of_its_own_is_a_topography(tmp_path: Path, begin: str) -> None:
    """Its numbers are not in the unit that is given."""
    (tmp_path / "a.txt").write_text(f"{begin}\n1 2 3\n4 5 6\n")
    with pytest.raises(pl.ConfigError, match=r"a scale of its own; read it as 'topography'"):
        pl.indenter("heights", path=tmp_path / "a.txt", unit="1 um")


def test_one_of_several_arrays(tmp_path: Path) -> None:
    """``dataset`` names the array in an HDF5 file of several."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["flat"], file["rough"] = np.zeros((8, 6)), ROUGH
    indenter = pl.indenter("heights", path=tmp_path / "a.h5", unit=1, dataset="rough")
    assert np.array_equal(_profile(indenter), ROUGH - ROUGH.max())


@pytest.mark.parametrize("dtype", ["<f4", ">f8", "<i2", "u1"])
def test_types_of_number(dtype: str) -> None:
    """Integers, single precision and foreign byte order are read as numbers."""
    values = (ROUGH * 10 + 50).astype(dtype)
    expected = values.astype(float) - float(values.max())
    assert np.array_equal(_profile(pl.indenter("heights", values=values, unit=1)), expected)


def test_array_is_recorded_by_its_hash() -> None:
    """An array in memory is recorded by the hash of its content, not by its values."""
    indenter = pl.indenter("heights", values=ROUGH, unit=1)
    assert indenter.model_dump()["sha256"] == hashlib.sha256(ROUGH.tobytes()).hexdigest()
    assert "values" not in indenter.model_dump()
    # The order in memory is no part of the content.
    assert pl.indenter("heights", values=np.asfortranarray(ROUGH), unit=1) == indenter
    assert pl.indenter("heights", values=ROUGH + 1e-9, unit=1) != indenter


def test_recorded_array_is_asked_for_again() -> None:
    """A configuration that only holds a hash says that the array must be given again."""
    indenter = pl.indenter("heights", values=ROUGH, unit=1)
    recorded = indenter.model_dump(exclude_none=True)
    with pytest.raises(pl.ConfigError, match=r"records only the hash .*give values again"):
        pl.indenter(recorded.pop("type"), **recorded)
    assert pl.indenter("heights", **recorded, values=ROUGH) == indenter
    with pytest.raises(pl.ConfigError, match="they have changed"):
        pl.indenter("heights", **recorded, values=ROUGH * 2)


def test_array_is_copied() -> None:
    """Changing the array afterwards, or a profile, does not change the indenter."""
    values = ROUGH.copy()
    indenter = pl.indenter("heights", values=values, unit=1)
    values[:] = 0
    _profile(indenter)[:] = -1
    assert np.array_equal(_profile(indenter), ROUGH - ROUGH.max())


def test_pickle_and_hash() -> None:
    """The indenter travels to another process with its heights, and can be a key."""
    indenter = pl.indenter("heights", values=ROUGH, unit=1)
    again = pickle.loads(pickle.dumps(indenter))
    assert again == indenter
    assert hash(again) == hash(indenter)
    assert np.array_equal(_profile(again), _profile(indenter))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (ROUGH[0], r"shape \(6,\); give a 2-D array .*; a profile along a line is of .*\[6, 1\]"),
        (np.ma.masked_greater(ROUGH, 1.0), r"holds \d+ masked, NaN or infinite heights"),
        (np.zeros((0, 3)), r"shape \(0, 3\)"),
        (ROUGH[None], r"shape \(1, 8, 6\)"),
        (ROUGH * 1j, "complex values; give real numbers"),
        (np.where(ROUGH > 0, np.inf, 0), "NaN or infinite heights"),
        ("junk", "give real numbers"),
        ([[1, None]], "give real numbers"),
        (csc_matrix(ROUGH), "give real numbers"),
    ],
)
def test_bad_array(values: object, message: str) -> None:
    """An array in memory is checked as a file is, and the message names the field."""
    with pytest.raises(pl.ConfigError, match=rf"values: the array .*{message}"):
        pl.indenter("heights", values=values, unit=1)


def test_file_or_array_but_not_both(tmp_path: Path) -> None:
    """Exactly one of a file and an array is given."""
    np.save(tmp_path / "a.npy", ROUGH)
    for given in ({}, {"path": tmp_path / "a.npy", "values": ROUGH}):
        with pytest.raises(pl.ConfigError, match="path: give either a file or"):
            pl.indenter("heights", unit=1, **given)


def _huge_npy(path: Path) -> None:
    """Write a header of 25000² cells, and next to nothing behind it."""
    shape = {"descr": "<f8", "fortran_order": False, "shape": (25_000, 25_000)}
    with path.open("wb") as file:
        np.lib.format.write_array_header_1_0(file, shape)
        file.write(bytes(1200))


def _huge_hdf5(path: Path) -> None:
    """Write a dataset of 25000² cells, none of which is there."""
    with h5py.File(path, "w") as file:
        file.create_dataset("z", (25_000, 25_000), "f8", chunks=(1000, 1000), compression="gzip")


def _wide_npy(path: Path) -> None:
    """Write 2000² cells that are there."""
    np.save(path, np.zeros((2000, 2000)))


@pytest.mark.parametrize(
    ("write", "name", "message"),
    [
        (_huge_hdf5, "a.h5", r"shape \(25000, 25000\), .*and the grid of shape \(8, 6\)"),
        (_huge_npy, "a.npy", r"mmap length is greater than file size"),
        (_wide_npy, "a.npy", r"shape \(2000, 2000\), .*and the grid of shape \(8, 6\)"),
    ],
)
def test_shapes_are_compared_before_memory_is_taken(
    write: Callable[[Path], None], name: str, message: str, tmp_path: Path
) -> None:
    """A file of another shape than the grid is refused by its header: its cells are not read."""
    write(tmp_path / name)
    part = {"type": "heights", "path": tmp_path / name, "unit": "1 um"}
    grid = {"points": [8, 6], "size": "1 mm"}
    tracemalloc.start()
    try:
        with pytest.raises(pl.ConfigError, match=rf"^indenter\.parts\.0\.path: .*{message}"):
            pl.Run(**bead(grid=grid, indenter={"type": "sum", "parts": [part]}))
        assert tracemalloc.get_traced_memory()[1] < 10e6
    finally:
        tracemalloc.stop()


def test_ends_with_the_domain() -> None:
    """Contact may reach the edge of the domain, where the heights end too."""
    grid = {"points": [8, 6], "size": ["8 um", "6 um"]}
    flat = pl.indenter("heights", values=np.zeros((8, 6)), unit=1)
    kernel = {"type": "half_space", "reduced_modulus": "10 kPa"}
    run = bead(grid=grid, kernel=kernel, indenter=flat, loading={"depth": "1 nm"})
    result = pl.run(run, progress=False)
    assert result.dataset["contact"].values.all()
    assert result.converged


def test_matlab_file(tmp_path: Path) -> None:
    """A matrix of a MATLAB file is chosen by its name, or by being the only one."""
    path, heights = tmp_path / "surface.mat", np.arange(12.0).reshape(3, 4)
    savemat(path, {"z": heights, "note": {"by": "me"}})
    punch = pl.indenter("heights", path=path, unit="1 um")
    x, y = np.zeros((3, 1)), np.zeros((1, 4))
    assert np.array_equal(punch.profile(x, y), (heights - 11) * 1e-6)
    savemat(path, {"z": heights, "w": heights})
    with pytest.raises(pl.ConfigError, match="more than one array; give one of: z, w"):
        pl.indenter("heights", path=path, unit="1 um")
