"""Every bad input: one message that names field, value, what is allowed and what to do."""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import pellicle as pl
from pellicle import memory
from pellicle.cli import app
from pellicle.results import storage

START = """
title = "bad input"
[grid]
points = 16
size = "0.4472 mm"
boundary = "free"
[kernel]
type = "tensed_membrane"
reduced_modulus = "10 kPa"
tension = "1 N/m"
[indenter]
type = "paraboloid"
radius = "1 mm"
[loading]
depth = ["10 um", "20 um"]
[solver]
type = "conjugate_gradient"
tolerance = 1e-6
[[corrections]]
type = "yastrebov"
[[outputs]]
type = "hdf5"
"""


@dataclass(frozen=True)
class Outcome:
    """What the command line did."""

    exit_code: int
    stdout: str
    message: str
    """All of stderr."""


Cli = Callable[..., Outcome]


@pytest.fixture
def cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Cli:
    """Return a function that calls the command line in an empty folder."""
    monkeypatch.chdir(tmp_path)
    Path("start.toml").write_text(START, encoding="utf-8")

    def call(*arguments: object) -> Outcome:
        result = CliRunner().invoke(app, [str(argument) for argument in arguments])
        # Anything but an exit would be a traceback on the user's screen.
        assert result.exception is None or isinstance(result.exception, SystemExit)
        assert "Traceback" not in result.output
        return Outcome(result.exit_code, result.stdout, result.stderr)

    return call


@pytest.fixture
def refuse(cli: Cli) -> Callable[..., str]:
    """Return a function that runs the start file with changes that must be refused."""

    def call(*changes: str) -> str:
        options = [part for change in changes for part in ("--set", change)]
        outcome = cli("run", "start.toml", "-o", "out", *options)
        assert outcome.exit_code == 2
        assert outcome.stdout == ""
        assert not Path("out").exists()
        return outcome.message

    return call


def says(message: str, *words: str) -> None:
    """Check that a message holds all words and none of pydantic's."""
    for word in words:
        assert word in message, f"{word!r} is not in: {message}"
    assert "Input should" not in message
    assert "validation" not in message


KEYS_AND_TYPES = {
    "unknown key": (
        "kernel.tensoin=1",
        ["kernel.tensoin: is not a field here", "did you mean 'tension'?", "reduced_modulus"],
    ),
    "unknown table": (
        "kernal.type='half_space'",
        ["kernal: is not a field here", "did you mean 'kernel'?", "indenter"],
    ),
    "key that Python knows": ("self=1", ["self: is not a field here", "kernel"]),
    "unknown type": (
        "kernel.type='tensed_membran'",
        ["kernel.type: 'tensed_membran' is no kernel", "did you mean 'tensed_membrane'?"],
    ),
    "unknown type in a list": (
        "corrections.0.type='yastrebo'",
        ["corrections.0.type: 'yastrebo' is no correction", "did you mean 'yastrebov'?"],
    ),
    "no type": ("kernel={}", ["kernel: has no type", "half_space, tensed_membrane"]),
    "type is no text": ("kernel.type=1", ["kernel.type: 1 is no kernel", "half_space"]),
    "choice": (
        "grid.boundary='perodic'",
        ["grid.boundary: 'perodic' is not allowed", "did you mean 'periodic'?", "free, periodic"],
    ),
    "choice in a list": (
        "outputs=[{type='figures', formats=['bmp']}]",
        ["outputs.0.formats.0: 'bmp' is not allowed", "pdf, png, svg"],
    ),
    "one output twice": (
        "outputs=[{type='hdf5'}, {type='csv'}, {type='hdf5'}]",
        ["outputs.2.type: 'hdf5' would write NAME.h5, as outputs.0 ('hdf5')", "leave one out"],
    ),
    "two outputs of one name": (
        "outputs=[{type='maps', name='a'}, {type='maps', name='b'}, {type='maps', name='a'}]",
        ["outputs.2.name: 'maps' would write NAME-a.png, as outputs.0", "give it another name"],
    ),
    "two outputs without a name": (
        "outputs=[{type='maps', field='gap'}, {type='maps', name='maps'}]",
        ["outputs.1.name: 'maps' would write NAME-maps.png, as outputs.0 ('maps') does"],
    ),
    "text wanted": ("title=1", ["title: 1 is not allowed; give text in quotes"]),
    "whole number wanted": (
        "solver.max_iterations='many'",
        ["solver.max_iterations: 'many' is not allowed; give a whole number"],
    ),
    "fraction of an iteration": (
        "solver.max_iterations=1.5",
        ["solver.max_iterations: 1.5 is not allowed; give a whole number"],
    ),
    "no iterations": ("solver.max_iterations=0", ["solver.max_iterations: 0", "give a value > 0"]),
    "negative seed": (
        "indenter={type='self_affine',rms_height=1,hurst=1,cutoff_wavelength=1,seed=-1}",
        ["indenter.seed: -1 is not allowed; give a value ≥ 0"],
    ),
    "file name wanted": (
        "indenter={type='heights', unit=1, path=1}",
        ["indenter.path: 1 is not allowed; give the name of a file"],
    ),
    "value where a table is wanted": ("loading=3", ["loading: 3 is not allowed; give a table"]),
    "value where a component is wanted": ("kernel=1", ["kernel: 1 is not a table", "half_space"]),
    "table where a list is wanted": (
        "corrections={type='yastrebov'}",
        ["corrections: {'type': 'yastrebov'} is not allowed; give a list"],
    ),
    "table where a quantity is wanted": (
        "kernel.tension={value=1}",
        ["kernel.tension: {'value': 1} is not a number", "'50 mN/m'"],
    ),
    "table where text is wanted": ("title={a=1}", ["title: {'a': 1}", "give text in quotes"]),
    "missing table": ("grid={}", ["grid.points: is missing", "grid.size: is missing", "[m]"]),
    "two moduli": (
        "kernel.youngs_modulus=1",
        ["kernel: reduced_modulus and youngs_modulus are both given", "give reduced_modulus alone"],
    ),
    "half a modulus": (
        "kernel={type='half_space', youngs_modulus=1}",
        ["kernel: no modulus", "give reduced_modulus, or both youngs_modulus and poissons_ratio"],
    ),
}


@pytest.mark.parametrize(("change", "words"), KEYS_AND_TYPES.values(), ids=KEYS_AND_TYPES)
def test_keys_and_types(refuse: Callable[..., str], change: str, words: list[str]) -> None:
    """A key or value of the wrong kind is named with what is allowed in its place."""
    says(refuse(change), *words)


QUANTITIES = {
    "grid.size": ("0 m", ["> 0 m", "'10 um'"]),
    "kernel.reduced_modulus": ("0 Pa", ["> 0 Pa", "'10 kPa'"]),
    "kernel.tension": ("-1 N/m", ["≥ 0 N/m", "'50 mN/m'"]),
    "indenter.radius": ("-1 mm", ["> 0 m", "'10 um'"]),
    "loading.depth": ("-1 um", ["≥ 0 m", "'10 um'"]),
}


@pytest.mark.parametrize(("field", "case"), QUANTITIES.items(), ids=QUANTITIES)
@pytest.mark.parametrize("bad", ["senseless", "nan", "inf", "-inf", "nan with a unit"])
def test_values_that_make_no_sense(
    refuse: Callable[..., str], field: str, case: tuple[str, list[str]], bad: str
) -> None:
    """NaN, infinity, and a negative or zero value where it means nothing are refused."""
    senseless, words = case
    unit = senseless.split()[1]
    value = {"senseless": f"'{senseless}'", "nan with a unit": f"'nan {unit}'"}.get(bad, bad)
    says(refuse(f"{field}={value}"), f"{field}: {value}", *words)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("force=-1", ["loading.force: -1 is not allowed", "≥ 0 N"]),
        ("force='1 m'", ["loading.force: '1 m' measures [length]", "'2 uN'"]),
        ("force=nan", ["loading.force: nan is not finite"]),
        ("mean_pressure=-1", ["loading.mean_pressure: -1 is not allowed", "≥ 0 Pa"]),
        ("mean_pressure=inf", ["loading.mean_pressure: inf is not finite"]),
    ],
)
def test_forces_and_pressures_that_make_no_sense(
    refuse: Callable[..., str], table: str, words: list[str]
) -> None:
    """Force and mean pressure are checked as depth is."""
    says(refuse("grid.boundary='periodic'", f"loading={{{table}}}"), *words)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("solver.tolerance=0", ["solver.tolerance: 0 is not allowed", "≥ 1e-13 and < 1"]),
        ("solver.tolerance='1 m'", ["solver.tolerance: '1 m' has a unit", "a plain number"]),
        (
            "kernel={type='half_space',youngs_modulus=1,poissons_ratio=0.6}",
            ["kernel.poissons_ratio: 0.6 is not allowed", "> -1 and ≤ 0.5"],
        ),
        (
            "indenter={type='cone',half_angle='95 degree'}",
            ["indenter.half_angle: '95 degree' is not allowed", "< 1.5708 rad", "'70 degree'"],
        ),
        (
            "indenter={type='self_affine',rms_height=1,hurst=1.1,cutoff_wavelength=1}",
            ["indenter.hurst: 1.1 is not allowed", "≥ 0 and ≤ 1"],
        ),
        (f"grid.size={'9' * 400}", ["grid.size: 999", "is not finite"]),
    ],
)
def test_numbers_out_of_bounds(refuse: Callable[..., str], change: str, words: list[str]) -> None:
    """Angles, ratios and pure numbers state their bounds."""
    says(refuse(change), *words)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("'1 m'", ["'1 m' measures [length], not [mass] / [time] ** 2"]),
        ("'1 mN/n'", ["'1 mN/n' has no unit that is known ('mN/n')"]),
        ("'1 N/'", ["'1 N/' has no unit that is known ('N/')"]),
        ("'1'", ["'1' is text without a unit"]),
        ("'N/m'", ["'N/m' is not a number with a unit"]),
        ("''", ["'' is not a number with a unit"]),
        ("true", ["True is not a number"]),
        ("[1]", ["[1] is not a number"]),
    ],
)
def test_units(refuse: Callable[..., str], value: str, words: list[str]) -> None:
    """A wrong or missing unit is answered with the right one and an example."""
    message = refuse(f"kernel.tension={value}")
    says(message, f"kernel.tension: {words[0]}", "≥ 0 N/m", "such as '50 mN/m'")
    # In a shell a bare number is text, too.
    assert ("or a bare number in N/m" in message) is ("without a unit" not in words[0])


LOADINGS = {
    "two": (
        "loading={depth='1 um', force='1 uN'}",
        ["loading: prescribes depth and force", "give exactly one of depth, force, mean_pressure"],
    ),
    "none": ("loading={}", ["loading: prescribes nothing", "give exactly one of"]),
    "empty list": ("loading.depth=[]", ["loading.depth: is empty", "give at least one load step"]),
    "bad entry": ("loading.depth=['1 um', 'x']", ["loading.depth.1: 'x' is not a number"]),
    "half a ramp": (
        "loading.depth={start=0, stop=1}",
        ["loading.depth: a ramp that has start, stop", "give start, stop and num"],
    ),
    "ramp of one": (
        "loading.depth={start=0, stop=1, num=1}",
        ["loading.depth.num: 1 is not allowed", "whole number of values, 2 to"],
    ),
    "ramp without end": (
        "loading.depth={start=0, stop=1, num=1_000_000_000_000}",
        ["loading.depth.num: 1000000000000 is not allowed", "2 to 1000000"],
    ),
    "ramp with a wrong word": (
        "loading.depth={start=0, stop=1, num=3, backwards=true}",
        ["loading.depth: a ramp that has start, stop, num, backwards", "back = true"],
    ),
    "ramp back by number": (
        "loading.depth={start=0, stop=1, num=3, back=1}",
        ["loading.depth.back: 1 is not allowed", "give true or false"],
    ),
    "log ramp from zero": (
        "loading.depth={start=0, stop=1, num=3, spacing='log'}",
        ['loading.depth: spacing = "log" needs start and stop ≠ 0'],
    ),
    "area over the domain": (
        "loading={contact_area=['0.1 mm**2', '1 mm**2']}",
        ["loading.contact_area.1: 1e-06 m2 is more than the domain has, 1.9998", "give less"],
    ),
    "area below what touches first": (
        "loading={contact_radius='1 um'}",
        ["loading.contact_radius.0: 1e-06 m is less than the 4 cells", "use more points"],
    ),
    "area in another unit": (
        "loading={contact_area='1 mm'}",
        ["loading.contact_area: '1 mm' measures", "'0.01 mm**2'"],
    ),
    "mean plane of an endless indenter": (
        "loading={mean_plane_depth='1 um'}",
        ["loading.mean_plane_depth: is not defined", "prescribe depth"],
    ),
    "ramp in another unit": (
        "loading.depth={start='1 um', stop='1 N', num=3}",
        ["loading.depth.stop: '1 N' measures", "not [length]"],
    ),
    "mean pressure on a free boundary": (
        "loading={mean_pressure='1 kPa'}",
        ["loading.mean_pressure: ", 'grid.boundary = "free"', "prescribe force or depth", "period"],
    ),
    "no formats": (
        "outputs=[{type='figures', formats=[]}]",
        ["outputs.0.formats: [] is not allowed; give a list of 1 or more"],
    ),
}


@pytest.mark.parametrize(("change", "words"), LOADINGS.values(), ids=LOADINGS)
def test_loading(refuse: Callable[..., str], change: str, words: list[str]) -> None:
    """Load steps that cannot be meant are refused with the forms that can."""
    says(refuse(change), *words)


PUNCH = "indenter={type='flat_punch', radius='0.1 mm'}"


@pytest.mark.parametrize(
    ("loading", "words"),
    [
        ("contact_area='0.1 mm**2'", ["contact_area.0: 1e-07 m2 is more than the indenter has"]),
        (
            "contact_radius='0.1 mm'",
            ["contact_radius.0: 0.0001 m is not", "flat", "prescribe depth"],
        ),
        ("mean_plane_depth='1 um'", ["mean_plane_depth: is not defined", "prescribe depth"]),
    ],
)
def test_loading_of_a_punch(refuse: Callable[..., str], loading: str, words: list[str]) -> None:
    """A flat punch has one area, whatever the load, and no mean plane."""
    says(refuse(PUNCH, f"loading={{{loading}}}"), *words)


def test_depth_before_first_touch(refuse: Callable[..., str]) -> None:
    """The mean plane may be that high, but no higher, for the lowest point to touch."""
    changes = ["grid.boundary='periodic'", "loading={mean_plane_depth=['-10 um', '-1 mm']}"]
    words = "-0.001 m is before first touch", "give -1.66006e-05 m", "or more"
    says(refuse(*changes), "loading.mean_plane_depth.1", *words)


def test_depth_beyond_full_contact(refuse: Callable[..., str]) -> None:
    """On a periodic grid, no load reaches a depth below the indenter's mean plane."""
    message = refuse("grid.boundary='periodic'", "loading.depth=['1 um', '1 mm']")
    says(message, "loading.depth.1: 0.001 m is beyond full contact", "mean plane", "give less")


def test_area_of_few_cells(cli: Cli) -> None:
    """An area that no number of whole cells comes near to is marked, one they nearly have said."""
    loading = "loading={contact_area=['4.7e-9 m**2', '4.6e-8 m**2']}"
    outcome = cli("run", "start.toml", "-o", "out", "--set", loading)
    assert outcome.exit_code == 1
    says(outcome.message, "step 1 did not converge: the contact area misses", "use more points")
    says(outcome.message, "step 2: converged; the contact area misses", "nearer number of whole")
    kept = pl.load("out/start.h5").dataset
    assert kept["converged"].values.tolist() == [False, True]


@pytest.mark.parametrize(
    ("loading", "boundary", "named"),
    [
        ("{depth='1 mm'}", "free", "loading.depth = 0.001 m"),
        ("{force='1 N'}", "free", "loading.force = 1 N"),
        ("{contact_area='0.19 mm**2'}", "free", "loading.contact_area = 1.9e-07 m2"),
        ("{mean_pressure='1 MPa'}", "periodic", "loading.mean_pressure = 1e+06 Pa"),
    ],
)
def test_contact_reaches_the_edge(cli: Cli, loading: str, boundary: str, named: str) -> None:
    """A load beyond the domain's reach leaves a result that is marked, and exit code 1."""
    changes = ["--set", f"loading={loading}", "--set", f"grid.boundary='{boundary}'"]
    outcome = cli("run", "start.toml", "-o", "out", *changes)
    assert outcome.exit_code == 1
    says(outcome.message, "step 1 did not converge", "reaches the edge", named)
    says(outcome.message, "enlarge grid.size = 0.0004472 × 0.0004472 m or prescribe less")
    kept = pl.load("out/start.h5").dataset
    assert not kept["converged"].item()
    assert "reaches the edge" in kept["status"].item()
    assert "NOT CONVERGED" in outcome.stdout


POINTS = {
    "none": ("0", ["grid.points: 0 is not allowed", "a whole number of cells ≥ 1"]),
    "negative": ("-1", ["grid.points: -1 is not allowed"]),
    "fraction": ("[16.5, 16]", ["grid.points.0: 16.5 is not allowed"]),
    "text": ("'16'", ["grid.points: '16' is not allowed"]),
    "one of two": ("[16]", ["grid.points.1: is missing", "[along x, along y]"]),
    "three": ("[1, 2, 3]", ["grid.points: [1, 2, 3]", "give a list of 2 or fewer"]),
    "too many": ("10_000_000", ["grid.points: 10000000 × 10000000 with 2 steps", "use fewer"]),
    "absurd": (f"1{'0' * 400}", ["grid.points: 1000", "needs about inf GB", "use fewer"]),
    "more digits than Python reads": ("9" * 5000, ["grid.points: '999", "is not allowed"]),
}


@pytest.mark.parametrize(("points", "words"), POINTS.values(), ids=POINTS)
def test_points(refuse: Callable[..., str], points: str, words: list[str]) -> None:
    """Numbers of cells that are senseless or do not fit in memory are refused before starting."""
    message = refuse(f"grid.points={points}")
    says(message, *words)
    assert len(message) < 400


def test_memory_is_estimated_before_starting(
    refuse: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A grid that needs more than there is left is refused with both numbers."""
    monkeypatch.setattr(memory, "available", lambda: 5e4)
    says(refuse(), "grid.points: 16 × 16 with 2 steps needs about", "5e-05 GB are available")


def test_memory_that_runs_out_all_the_same(
    refuse: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """An allocation that fails in spite of the estimate is no traceback."""

    def fail(*arguments: object) -> None:
        raise MemoryError

    monkeypatch.setattr("pellicle.runs.compose.make_operator", fail)
    says(refuse(), "grid.points: (16, 16) cells do not fit in memory; use fewer points")


def test_all_problems_at_once(refuse: Callable[..., str]) -> None:
    """Several problems are told together, a line each."""
    message = refuse("grid.points=0", "kernel.tension=-1", "loading={}", "kernel.colour=1")
    fields = [line.removeprefix("error: ").partition(":")[0] for line in message.splitlines()]
    assert sorted(fields) == ["grid.points", "kernel.colour", "kernel.tension", "loading"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("points", ["--set 'points' is not of the form a.b=value", "grid.points=128"]),
        ("=1", ["--set '=1' is not of the form a.b=value"]),
        ("grid..points=1", ["--set 'grid..points=1' is not of the form"]),
        ("title.text=1", ["title = 'bad input' is not a table", "replace it as a whole: title"]),
        ("grid.points.0=1", ["grid.points = 16 is not a table"]),
        ("corrections.1.type=1", ["corrections has no entry 1", "its 1, counted from 0"]),
        ("corrections.first.type=1", ["corrections has no entry first"]),
        ("mesh.points=1", ["mesh: is not a field here"]),
    ],
)
def test_set(refuse: Callable[..., str], change: str, words: list[str]) -> None:
    """An override that cannot be applied is quoted with the reason."""
    says(refuse(change), *words)


TOML_FILES = {
    "syntax": (
        b"title = 'a'\n[grid]\npoints = \n",
        ["not valid TOML", "at line 3, column 10", "correct it there"],
    ),
    "key twice": (b"a = 1\na = 2\n", ["not valid TOML", "at line 2"]),
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
    "junk npy": ("h.npy", lambda path: path.write_bytes(b"junk junk"), ["no .npy file"]),
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
        lambda path: (np.save(path, GOOD), path.write_bytes(path.read_bytes()[:-99])),
        ["indenter.path", "cannot be read as npy", "2-D array"],
    ),
    "npy that claims an exabyte": ("h.npy", _write_huge_npy, ["cannot be read as npy"]),
    "npz": (
        "h.npy",
        lambda path: (np.savez("h", GOOD), Path("h.npz").rename(path)),
        ["no .npy file"],
    ),
    "NaN": ("h.npy", lambda path: np.save(path, NAN), ["holds 16 NaN or infinite", "fill or crop"]),
    "complex": ("h.npy", lambda path: np.save(path, GOOD * 1j), ["holds complex", "real numbers"]),
    "bool": ("h.npy", lambda path: np.save(path, GOOD > 0), ["holds bool", "real numbers"]),
    "1-D": ("h.npy", lambda path: np.save(path, GOOD[0]), ["is of shape (16,)", "2-D array"]),
    "no cells": ("h.npy", lambda path: np.save(path, GOOD[:0]), ["is of shape (0, 16)"]),
    "wrong shape": (
        "h.npy",
        lambda path: np.save(path, GOOD[:8]),
        ["indenter.path", "(8, 16)", "(16, 16)", "grid.points = [8, 16]"],
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


def test_height_hash_of_other_heights(refuse: Callable[..., str]) -> None:
    """Heights that are no longer those of the recorded hash are refused."""
    np.save("h.npy", GOOD)
    message = refuse("indenter={type='heights', path='h.npy', unit=1, sha256='abc'}")
    says(message, "indenter.sha256: abc is not the hash", "have changed", "remove sha256")


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        (
            "cutoff_wavelength='30 um'",
            ["indenter.cutoff_wavelength: 3e-05 m cannot be resolved", "more grid.points"],
        ),
        (
            # So short that listing its modes would not fit in memory.
            "cutoff_wavelength='1 pm'",
            ["indenter.cutoff_wavelength: 1e-12 m cannot be resolved"],
        ),
        (
            "cutoff_wavelength='200 um', roll_off_wavelength='100 um'",
            ["indenter.roll_off_wavelength: 0.0001 m is shorter than cutoff_wavelength", "0.0002"],
        ),
        (
            "cutoff_wavelength='1 mm', roll_off_wavelength='2 mm'",
            ["indenter.roll_off_wavelength: no wavelength between", "widen the range"],
        ),
    ],
)
def test_spectrum(refuse: Callable[..., str], fields: str, words: list[str]) -> None:
    """A spectrum that the grid or the domain cannot hold is refused."""
    table = f"{{type='self_affine', rms_height='1 um', hurst=0.8, {fields}}}"
    says(refuse(f"indenter={table}"), *words)


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
    write, room = Path.write_bytes, [1]

    def fail(path: Path, data: bytes) -> int:
        if not room:
            raise OSError(28, "No space left on device")
        room.pop()
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", fail)
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
    "folder": (lambda path: path.mkdir(), ["r.h5: is a folder"]),
    "empty": (lambda path: path.touch(), ["r.h5: not a readable result file"]),
    "junk": (lambda path: path.write_text("junk"), ["r.h5: not a readable result file"]),
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


def test_figures_that_cannot_be_written(cli: Cli) -> None:
    """A file in place of the folder for figures is named."""
    assert cli("run", "start.toml", "-o", "out", "--quiet").exit_code == 0
    outcome = cli("plot", "out/start.h5", "-o", "start.toml")
    assert outcome.exit_code == 2
    says(outcome.message, "start.toml/start-pressure.png: cannot be written", "another folder")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "start.toml", "--threads", "0"], ["--threads"]),
        (["run", "start.toml", "--outptu", "x"], ["--outptu"]),
        (["run"], ["FILE"]),
        (["plot", "r.h5", "--format", "bmp"], ["bmp", "png", "svg", "pdf"]),
        (["rnu"], ["rnu"]),
    ],
)
def test_options(cli: Cli, arguments: list[str], words: list[str]) -> None:
    """A command or an option that does not exist is named."""
    outcome = cli(*arguments)
    assert outcome.exit_code == 2
    for word in words:
        assert word.lower() in outcome.message.lower()


# Where tests run in the background, their processes would ignore Ctrl-C.
LISTENING = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from pellicle.__main__ import main; main()"
)


@pytest.fixture
def long_run(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """Return a process that has written its first step and has many to go."""
    (tmp_path / "start.toml").write_text(START, encoding="utf-8")
    steps = "loading.depth={start='10 um', stop='20 um', num=20_000}"
    process = subprocess.Popen(
        [sys.executable, "-c", LISTENING, "run", "start.toml", "-o", "out", "--set", steps],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        patience = time.monotonic() + 60
        while not (tmp_path / "out/start.h5").exists():
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < patience, "no step in a minute"
            time.sleep(0.01)
        yield process
    finally:
        process.kill()
        process.communicate()


def test_interrupt(tmp_path: Path, long_run: subprocess.Popen[str]) -> None:
    """Ctrl-C leaves every finished step, says where, and exits with 130."""
    long_run.send_signal(signal.SIGINT)
    message = long_run.communicate(timeout=60)[1]
    assert long_run.returncode == 130
    says(message, "interrupted; what steps were finished are in out")
    assert "Traceback" not in message
    done = pl.load(tmp_path / "out/start.h5").dataset
    assert 1 <= done.sizes["step"] < 20_000
    assert done["converged"].values.all()
    shown = CliRunner().invoke(app, ["show", str(tmp_path / "out/start.h5")])
    assert f"interrupted: {done.sizes['step']} of 20000 steps" in shown.stderr
    assert shown.exit_code == 1


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_kill(tmp_path: Path, long_run: subprocess.Popen[str]) -> None:
    """A run that is killed leaves a whole file with every finished step."""
    long_run.kill()
    long_run.wait(timeout=60)
    path = tmp_path / "out/start.h5"
    with h5py.File(path) as file:
        assert file["pressure"].shape[1:] == (16, 16)
    with xr.open_dataset(path, engine="h5netcdf") as opened:
        assert opened.sizes["step"] >= 1
    assert (pl.load(path).dataset["force"].values > 0).all()
