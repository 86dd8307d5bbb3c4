"""A file that cannot be read or written: one message that names it and says what to do."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.results import storage
from tests.framework.bad_input.command_line import Cli, says

TOML_FILES = {
    "syntax": (
        b"title = 'a'\n[grid]\npoints = \n",
        ["not valid TOML", "at line 3, column 10", "correct it there"],
    ),
    "key twice": (b"a = 1\na = 2\n", ["not valid TOML", "A key is given twice", "at line 2"]),
    "table twice": (
        b"[grid]\na = 1\n[b]\n[grid]\nb = 2\n",
        ["[grid] is there already", "line 4", "leave one [grid], with the keys of both"],
    ),
    "dotted table twice": (b"[a]\nb.c = 1\n[a.b]\n", ["leave one [a.b]"]),
    "unit without quotes": (
        b"[grid]\npoints = 3\nsize = 1 mm  # of the gel\n",
        ['values with a unit, stand in quotes: "1 mm"', "line 3, column 10"],
    ),
    "word without quotes": (b"type = sphere\n", ['stand in quotes: "sphere"', "line 1"]),
    "unit without quotes in a list": (b'a = ["1 mm", 2 mm]\n', ['stand in quotes: "2 mm"']),
    "unit without quotes in a ramp": (
        b"depth = {start = 1 um, stop = 2 um, num = 3}\n",
        ['stand in quotes: "1 um"'],
    ),
    "Python's true": (b"a = True\n", ["True is true in TOML"]),
    "number with a comma": (b"a = 1,5\n", ["line 1, column 6", "correct it there"]),
    "configuration of a fit": (
        b"curves = ['a.csv']\nindenter.type = 'sphere'\n",
        ["curves: makes this the configuration of a fit", "`pellicle fit`"],
    ),
    "end of file": (b"a = 1\nb = [", ["not valid TOML", "at line 2, the end of the file"]),
    "encoding": (b"title = '\xff\xfe'", ["not a text file", "give a TOML file in UTF-8"]),
    "binary": (b"\x00\x01", ["not valid TOML", "at line 1"]),
    "nested beyond reason": (b"a = " + b"[" * 100_000, ["not valid TOML"]),
    "empty": (b"", ["grid: is missing", "kernel: is missing", "indenter", "loading"]),
}


@pytest.mark.parametrize(("content", "words"), TOML_FILES.values(), ids=TOML_FILES)
def test_toml_file(cli: Cli, content: bytes, words: list[str]) -> None:
    """A file that is no TOML is named with line and column."""
    Path("bad.toml").write_bytes(content)
    outcome = cli("run", "bad.toml")
    assert outcome.exit_code == 2
    says(outcome.message, *words)


def test_fit_of_a_run(cli: Cli) -> None:
    """A run file given to `pellicle fit` is refused in one line that names the right command."""
    outcome = cli("fit", "start.toml")
    assert outcome.exit_code == 2
    assert outcome.message.count("\n") == 1
    says(outcome.message, "loading: makes this a run", "`pellicle run`")


@pytest.mark.parametrize("name", ["missing.toml", "."])
def test_no_toml_file(cli: Cli, name: str) -> None:
    """A missing file, or a folder, is named, and the command that makes a file."""
    outcome = cli("run", name)
    assert outcome.exit_code == 2
    says(outcome.message, f"{name}: ", "give a TOML file (`pellicle new` writes one)")


def _write_hdf5(path: Path, **arrays: object) -> None:
    with h5py.File(path, "w") as file:
        for name, values in arrays.items():
            file[name] = values


def _npy(values: np.ndarray) -> bytes:
    file = BytesIO()
    np.save(file, values)
    return file.getvalue()


def _write_npz(path: Path) -> None:
    with path.open("wb") as file:
        np.savez(file, GOOD)


def _write_huge_npy(path: Path) -> None:
    with path.open("wb") as file:
        header = {"descr": "<f8", "fortran_order": False, "shape": (10**9, 10**9)}
        np.lib.format.write_array_header_1_0(file, header)


GOOD = np.zeros((16, 16))
NAN = np.where(np.eye(16) > 0, np.nan, 0.0)
HEIGHTS: dict[str, tuple[str, Callable[[Path], object], list[str]]] = {
    "missing": ("h.npy", lambda path: None, ["indenter.path", "h.npy: no such file; give"]),
    "folder": ("h.npy", lambda path: path.mkdir(), ["indenter.path", "no such file"]),
    "empty": ("h.npy", lambda path: path.touch(), ["indenter.path", "h.npy is empty"]),
    "junk npy": ("h.npy", lambda path: path.write_bytes(b"junk junk"), ["not an .npy file"]),
    "pickled": (
        "h.npy",
        lambda path: np.save(path, np.array([[{}]], dtype=object), allow_pickle=True),
        ["indenter.path", "is pickled", "allow_pickle=False"],
    ),
    "a pickle": (
        "h.npy",
        lambda path: path.write_bytes(pickle.dumps(GOOD)),
        ["indenter.path", "is pickled"],
    ),
    "truncated npy": (
        "h.npy",
        lambda path: path.write_bytes(_npy(GOOD)[:-99]),
        ["indenter.path", "cannot be read as npy", "2-D array"],
    ),
    "npy that claims an exabyte": ("h.npy", _write_huge_npy, ["cannot be read as npy"]),
    "npz": (
        "h.npy",
        _write_npz,
        ["not an .npy file"],
    ),
    "NaN": ("h.npy", lambda path: np.save(path, NAN), ["holds 16 NaN or infinite", "fill or crop"]),
    "complex": ("h.npy", lambda path: np.save(path, GOOD * 1j), ["holds complex", "real numbers"]),
    "bool": ("h.npy", lambda path: np.save(path, GOOD > 0), ["holds bool", "real numbers"]),
    "1-D": ("h.npy", lambda path: np.save(path, GOOD[0]), ["is of shape (16,)", "2-D array"]),
    "no cells": ("h.npy", lambda path: np.save(path, GOOD[:0]), ["is of shape (0, 16)"]),
    "wrong shape": (
        "h.npy",
        lambda path: np.save(path, GOOD[:8]),
        ["indenter.path", "(8, 16)", "(16, 16)", "grid.points = [8, 16] and grid.size to match"],
    ),
    "junk text": (
        "h.txt",
        lambda path: path.write_text("one two\nthree"),
        ["indenter.path", "cannot be read as text", "'one'"],
    ),
    "blank text": ("h.csv", lambda path: path.write_text("# a\n\n"), ["it holds no numbers"]),
    "ragged text": ("h.txt", lambda path: path.write_text("1 2\n3"), ["cannot be read as text"]),
    "complex text": ("h.txt", lambda path: path.write_text("1+2j 2"), ["'1+2j'"]),
    "NaN text": ("h.txt", lambda path: path.write_text("1 nan"), ["holds 1 NaN or infinite"]),
    "binary text": ("h.txt", lambda path: path.write_bytes(b"\xff\xfe1"), ["cannot be read as"]),
    "junk HDF5": (
        "h.h5",
        lambda path: path.write_text("junk"),
        ["indenter.path", "cannot be read as hdf5"],
    ),
    "empty HDF5": ("h.h5", _write_hdf5, ["indenter.path", "it holds no array"]),
    "several arrays": (
        "h.h5",
        lambda path: _write_hdf5(path, top=GOOD, bottom=GOOD),
        ["indenter.dataset", "more than one array", "give one of: bottom, top"],
    ),
    "text in HDF5": ("h.h5", lambda path: _write_hdf5(path, a="x"), ["give real numbers"]),
}


@pytest.mark.parametrize(("name", "make", "words"), HEIGHTS.values(), ids=HEIGHTS)
def test_height_files(
    refuse: Callable[..., str], name: str, make: Callable[[Path], object], words: list[str]
) -> None:
    """A file of heights that cannot be used is named with what is wrong with it."""
    make(Path(name))
    says(refuse(f"indenter={{type='heights', path='{name}', unit='1 um'}}"), name, *words)


def test_height_dataset_that_is_not_there(refuse: Callable[..., str]) -> None:
    """A wrong name of an array in an HDF5 file is answered with the names that are there."""
    _write_hdf5(Path("h.h5"), top=GOOD)
    message = refuse("indenter={type='heights', path='h.h5', unit=1, dataset='bottom'}")
    says(message, "indenter.dataset", "no array 'bottom'", "give one of: top")


def test_rows_and_columns_exchanged(refuse: Callable[..., str]) -> None:
    """A scan in rows along x is not transposed in silence by another number of cells."""
    np.savetxt("h.csv", np.zeros((2, 3)), delimiter=";")
    message = refuse("grid.points=[3, 2]", "indenter={type='heights', path='h.csv', unit=1}")
    says(message, "is of shape (2, 3), [along x, along y]", "the grid of shape (3, 2)")
    says(message, "if its rows are lines along x", "transpose it or use type = 'topography'")


def test_height_hash_of_other_heights(refuse: Callable[..., str]) -> None:
    """Heights that are no longer those of the recorded hash are refused."""
    np.save("h.npy", GOOD)
    message = refuse("indenter={type='heights', path='h.npy', unit=1, sha256='abc'}")
    says(message, "indenter.sha256: abc is not the hash", "have changed", "remove sha256")


@pytest.mark.parametrize("type_", ["hdf5", "csv", "figures"])
def test_output_folder_that_cannot_be_written(
    cli: Cli, monkeypatch: pytest.MonkeyPatch, type_: str
) -> None:
    """A file where the output folder should be is found out before anything is solved."""
    Path("out").write_text("in the way", encoding="utf-8")

    def fail(*arguments: object) -> None:
        raise AssertionError("solved in vain")

    monkeypatch.setattr("pellicle.runs.steps.solve_step", fail)
    outputs = f"outputs=[{{type='{type_}'}}]"
    outcome = cli("run", "start.toml", "-o", "out", "--set", outputs)
    assert outcome.exit_code == 2
    says(outcome.message, "out/start", "cannot be written", "choose another folder")
    assert Path("out").read_text(encoding="utf-8") == "in the way"


def test_disk_that_fills_up(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """A write that fails in a later step is no traceback and costs no earlier step."""
    save, room = storage._save, [1]

    def fail(content: BytesIO, path: Path) -> None:
        if not room:
            raise OSError(28, "No space left on device")
        room.pop()
        save(content, path)

    monkeypatch.setattr(storage, "_save", fail)
    outcome = cli("run", "start.toml", "-o", "out")
    assert outcome.exit_code == 2
    says(outcome.message, "out/start.h5: cannot be written (No space left on device)")
    assert pl.load("out/start.h5").dataset.sizes["step"] == 1


def test_result_of_another_configuration(cli: Cli) -> None:
    """A result is replaced by that of another configuration only when asked."""
    assert cli("run", "start.toml", "-o", "out").exit_code == 0
    before = Path("out/start.h5").read_bytes()
    other = ["run", "start.toml", "-o", "out", "--set", "loading.depth='5 um'"]
    outcome = cli(*other)
    assert outcome.exit_code == 2
    says(outcome.message, "out/start.h5 holds the result of another configuration", "--overwrite")
    assert Path("out/start.h5").read_bytes() == before
    assert cli(*other, "--overwrite").exit_code == 0
    assert pl.load("out/start.h5").dataset["depth"].values == pytest.approx([5e-6])


def test_junk_where_the_result_should_go(cli: Cli) -> None:
    """A file that is no result is not replaced unasked."""
    Path("out").mkdir()
    Path("out/start.h5").write_text("someone's", encoding="utf-8")
    outcome = cli("run", "start.toml", "-o", "out")
    assert outcome.exit_code == 2
    says(outcome.message, "out/start.h5: not a readable result file", "--overwrite")
    assert Path("out/start.h5").read_text(encoding="utf-8") == "someone's"


def _damaged(path: Path) -> None:
    dataset = xr.Dataset({"pressure": (("step", "x", "y"), np.ones((1, 8, 8)))})
    storage.write(dataset.assign_attrs(configuration="{}", versions="pellicle 0"), path)
    path.write_bytes(path.read_bytes()[:-500])


RESULTS: dict[str, tuple[Callable[[Path], object], list[str]]] = {
    "missing": (lambda path: None, ["r.h5: no such file"]),
    "folder": (lambda path: path.mkdir(), ["r.h5: is a folder that holds no result yet"]),
    "empty": (lambda path: path.touch(), ["r.h5: not a readable result file"]),
    "junk": (
        lambda path: path.write_text("junk"),
        ["r.h5: not a readable result file (it is not an HDF5 file); give an .h5 file"],
    ),
    "damaged": (_damaged, ["r.h5: not a readable result file"]),
    "other HDF5": (lambda path: _write_hdf5(path, a=GOOD), ["r.h5: not a"]),
    "other NetCDF": (
        lambda path: xr.Dataset({"a": ("x", [1.0])}).to_netcdf(path, engine="h5netcdf"),
        ["r.h5: not a result of pellicle"],
    ),
    "another schema version": (
        lambda path: xr.Dataset(
            attrs={"schema_version": 99, "configuration": "{}", "versions": "pellicle 9.0"}
        ).to_netcdf(path, engine="h5netcdf"),
        ["r.h5: schema version 99, and this pellicle reads 1", "pellicle 9.0", "run it again"],
    ),
    "a schema version that is none": (
        lambda path: xr.Dataset(
            attrs={"schema_version": "x", "configuration": "{}", "versions": "pellicle 9.0"}
        ).to_netcdf(path, engine="h5netcdf"),
        ["r.h5: schema version x"],
    ),
}


@pytest.mark.parametrize("command", ["show", "plot"])
@pytest.mark.parametrize(("make", "words"), RESULTS.values(), ids=RESULTS)
def test_result_files(
    cli: Cli, command: str, make: Callable[[Path], object], words: list[str]
) -> None:
    """Commands that read a result say what is wrong with a file that is none."""
    make(Path("r.h5"))
    outcome = cli(command, "r.h5")
    assert outcome.exit_code == 2
    says(outcome.message, *words)


def test_table_beside_the_result(cli: Cli) -> None:
    """The text of a result, given in its place, is answered with the name of the result."""
    for name in ("r.csv", "r.h5"):
        Path(name).write_text("force [N]\n1\n", encoding="utf-8")
    says(cli("show", "r.csv").message, "it is not an HDF5 file", "give r.h5 that pellicle wrote")


def test_figures_that_cannot_be_written(cli: Cli) -> None:
    """A file in place of the folder for figures is named."""
    assert cli("run", "start.toml", "-o", "out", "--quiet").exit_code == 0
    outcome = cli("plot", "out/start.h5", "-o", "start.toml")
    assert outcome.exit_code == 2
    says(outcome.message, "start.toml/start-pressure.png: cannot be written", "another folder")
