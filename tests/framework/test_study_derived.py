"""Derived columns of a study: in its table, in both files, and in the list of its runs."""

from __future__ import annotations

import csv
import tomllib
from pathlib import Path

import numpy as np
import xarray as xr

import pellicle as pl
from tests.command import call
from tests.small_run import run_file

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
