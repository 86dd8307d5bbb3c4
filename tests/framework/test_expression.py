"""Dotted names, arithmetic over them, nothing but that, and the columns of studies it makes."""

import csv
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import pellicle as pl
from pellicle import ConfigError
from pellicle.schema.expression import evaluate, names_in
from pellicle.schema.model import get, walk
from tests.command import call
from tests.tables_of_runs import run_file

NAMES = {"kernel.tension": 0.5, "kernel.reduced_modulus": 1e4, "depth": 3.0, "grid.size.0": 2.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 * kernel.tension / kernel.reduced_modulus", 1e-4),
        ("-depth**2", -9.0),
        ("(-depth)**2", 9.0),
        ("2**-1", 0.5),
        ("1 - 2 - 3", -4.0),
        ("+1e3 - 1.5e-3 + .5", 1000.4985),
        ("sqrt(depth + 1) * pi", 2 * math.pi),
        ("log10(exp(log(100)))", 2.0),
        ("abs(-depth)", 3.0),
        ("grid.size.0**2", 4.0),
        ("  depth ", 3.0),
        ("1" + "+1" * 300, 301.0),
    ],
)
def test_is_arithmetic(text: str, value: float) -> None:
    """Precedence, functions, numbers and dotted names are as everywhere."""
    assert evaluate(text, NAMES) == pytest.approx(value, rel=1e-15)


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.floats(-3, 3))
def test_agrees_with_python(a: float, b: float, c: float) -> None:
    """Any numbers give what Python gives."""
    expected = -a + b * (a - c) / b**c
    assert evaluate("-a + x.b * (a - c) / x.b**c", {"a": a, "x.b": b, "c": c}) == expected


def test_broadcasts_by_dimension() -> None:
    """Variables of xarray meet by the names of their dimensions."""
    a = xr.DataArray([1.0, 2.0], dims="t")
    b = xr.DataArray([10.0, 20.0, 30.0], dims="seed")
    value = evaluate("a * b + 1", {"a": a, "b": b})
    assert value.dims == ("t", "seed")
    np.testing.assert_array_equal(value, [[11, 21, 31], [21, 41, 61]])


def test_undefined_values_are_not_a_number() -> None:
    """A division by zero or a root of what is negative spoils its own value only."""
    value = evaluate("sqrt(a) / b", {"a": np.array([4.0, -1.0, 1.0]), "b": np.array([1, 1, 0])})
    np.testing.assert_array_equal(value, [2.0, np.nan, np.inf])
    assert evaluate("1 / 0", {}) == np.inf


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "'' is not arithmetic"),
        ("depth if depth else 1", "is not arithmetic"),
        ("__import__('os')", "'__import__' in .* is not a function|not allowed"),
        ("'text'", "'text'.* is not allowed"),
        ("[depth]", r"'\[depth\]' in .* is not allowed"),
        ("(depth).real", r"^'\(depth\)\.real' in .* is not allowed"),
        ("depth // 2", "'depth // 2' in .* is not allowed"),
        ("(kernel.tension := 2)", "not allowed"),
        ("2j", "'2j' in .* is not allowed"),
        ("True", "'True' in"),
        ("sqrt", "'sqrt' in"),
        ("sqrt(depth)(2)", "is not allowed"),
        ("τ * 2", "'τ' in"),
        ("(" * 249 + "1" + ")" * 249, "not arithmetic"),
        ("~" * 499 + "1", "is not allowed"),
        *((text, "more than 300 operations") for text in ("1" + "+1" * 301, "-" * 100_000 + "1")),
        *((f"{text}1", "is not arithmetic") for text in ("~" * 100_000, "not " * 100_000)),
        *(
            (text, "is not arithmetic")
            for text in ("℘5", "depth * ℘0", "℮9", "ᢅ5", "e\u0301", "a·b", "depth # / 2")
        ),
        ("1" * 400, "cannot be evaluated|not arithmetic"),
    ],
)
def test_anything_else_is_refused(text: str, message: str) -> None:
    """What is not arithmetic is named, and what would be allowed."""
    with pytest.raises(ConfigError, match=message):
        evaluate(text, NAMES)


def test_names_that_are_needed() -> None:
    """Functions and constants are not among them, nor exponents of numbers."""
    assert names_in("sqrt(a.b) / pi + 1e3 * c") == {"a.b", "c"}


RUN = pl.Run(
    grid={"points": [8, 16], "size": "1 mm"},
    kernel=pl.kernel("coated", tension=0.1, substrate={"type": "half_space", "reduced_modulus": 1}),
    indenter=pl.indenter("sphere", radius=1e-3),
    loading={"depth": ["1 um", "2 um"]},
)
TABLE = {"study": {"vary": {"kernel.tension": [1, 2]}}, "parts": [{"a": None}]}


@pytest.mark.parametrize(
    ("at", "path", "value"),
    [
        (RUN, "grid.points.1", 16),
        (RUN, "grid.points.2", None),
        (RUN, "kernel.substrate.reduced_modulus", 1.0),
        (RUN, "kernel.nothing.more", None),
        (TABLE, "study.vary.kernel.tension", [1, 2]),
        (TABLE, "study.vary.kernel.tension.1", 2),
        (TABLE, "parts.x", None),
        (TABLE, "parts.0.a.b", None),
    ],
)
def test_get(at: object, path: str, value: Any) -> None:
    """A path leads through models, tables and lists, or to None."""
    assert get(at, path) == value


def test_walk_and_get_agree() -> None:
    """Every value that a walk yields is found at its path; fields come with what describes them."""
    walked = {path: (value, field) for path, value, field in walk(RUN)}
    assert all(get(RUN, path) == value for path, (value, _) in walked.items())
    assert {"grid.size.0", "kernel.substrate", "kernel.substrate.type", "solver.tolerance"} <= {
        *walked
    }
    assert walked["grid.size.1"][1] is walked["grid.size"][1]
    assert [path for path, _, _ in walk({"a": [1, {"b": 2}]})] == ["a", "a.0", "a.1", "a.1.b"]


FILE = run_file("""
[study.vary]
kernel.tension = ["0.5 N/m", "1 N/m"]
[study.derived]
s = "2 * kernel.tension / kernel.reduced_modulus"
pull = "force / (s * depth)"
missed = "1 - converged - -converged * 2"
""")


def test_derived_columns(tmp_path: Path) -> None:
    """They may name columns, the configuration and each other, and stand wherever runs do."""
    (tmp_path / "s.toml").write_text(FILE, encoding="utf-8")
    folder = tmp_path / "out"
    call("run", tmp_path / "s.toml", "-o", folder)
    table = xr.load_dataset(folder / "study.h5", engine="h5netcdf")
    s = 2 * table["kernel.tension"] / 1e4
    wanted = (table["force"] / (s * table["depth"])).values
    np.testing.assert_allclose(table["pull"], wanted, rtol=1e-14)
    assert table["pull"].attrs == {"long_name": "force / (s * depth)", "units": "Pa"}
    with (folder / "study.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    np.testing.assert_allclose(
        [float(row["pull [Pa]"]) for row in rows], wanted.ravel(), rtol=1e-14
    )
    assert {float(row["s [m]"]) for row in rows} == {1e-4, 2e-4}
    assert {float(row["missed"]) for row in rows} == {2.0}
    shown = call("show", folder)
    head, *lines = [line.split() for line in shown.output.splitlines()[3:]]
    assert head[-7:] == ["s", "[µm]", "pull", "[kPa]", "missed", "status", "file"]
    shown_pull = [float(line[-4]) for line in lines]
    np.testing.assert_allclose(shown_pull, wanted[:, -1] / 1e3, rtol=5.1e-4)


UNITS = {
    "force**2 * depth": "N2*m",
    "kernel.tension / grid.size.0": "Pa",
    "sqrt(contact_area) * (1 + 2)": "m",
    "contact_area * 2": "m2",
    "1 / contact_area**2": "m**-4",
    "depth / contact_radius": "1",
    "log(depth / contact_radius)": "1",
    # Terms of different units, and powers whose value varies, have none.
    "depth + force": "1",
    "1 + depth": "1",
    "depth ** (depth / contact_radius)": "1",
}


def test_units_of_derived_columns() -> None:
    """They follow from the units of variables and fields, by dimensional analysis."""
    content = tomllib.loads(FILE)
    content["study"]["derived"] = {f"column_{n}": text for n, text in enumerate(UNITS)}
    table = pl.run_study(pl.Study.from_mapping(content), progress=False)
    units = [table[f"column_{n}"].attrs["units"] for n in range(len(UNITS))]
    assert units == [*UNITS.values()]
