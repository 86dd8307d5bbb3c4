"""The record of a fit: what went in, bytes that are equal however it is started, the fit again."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot

import pellicle as pl
from tests.command import Cli, call
from tests.pictures import drawn_width

TOML = """
curves = ["Bead 1 µ.csv"]
poissons_ratio = 0.5
baseline = "offset"
model = ["tension"]
rivals = ["power_law", ["offset", "slope"]]
uncertainty = { sensitivity = "5 %" }
spring_constant = "0.1 N/m"
sensitivity = "50 nm/V"
columns = "Z = extension um, D = deflection V"
[indenter]
type = "sphere"
radius = "5 um"
"""
FILE = Path("Bead 1 µ.csv")
OPTIONS = (
    *("--indenter", "sphere", "--radius", "5 um", "--poissons-ratio", "0.5"),
    *("--baseline", "offset", "--spring-constant", "0.1 N/m", "--sensitivity", "50 nm/V"),
    *("--model", "tension", "--rivals", "power_law", "--rivals", "offset,slope"),
    *("--uncertainty", "sensitivity=5 %"),
    *("--columns", "D = deflection V,Z=extension um"),
)
ARGUMENTS: dict[str, Any] = {
    "indenter": "sphere",
    "radius": "5 um",
    "poissons_ratio": 0.5,
    "baseline": "offset",
    "model": ["tension"],
    "rivals": ["power_law", ("offset", "slope")],
    "uncertainty": {"sensitivity": 0.05},
    "spring_constant": "0.1 N/m",
    "sensitivity": "50 nm/V",
    "columns": {"Z": "extension um", "D": "deflection V"},
}


def measure(path: Path, seed: int = 0, length: float = 5e-6) -> None:
    """Write extension [um] and deflection [V] of a bead on 2 kPa under 5 mN/m, s = 5 µm.

    Without tension no rival of one is fitted, which takes most of the time.
    """
    depth = np.linspace(-0.4e-6, 1.5e-6, 80)
    sphere = pl.indenter("sphere", radius=5e-6)
    force = 2e3 * sphere.force_curve(depth, length).force  # type: ignore[attr-defined]
    force += 0.005 * force.max() * np.random.default_rng(seed).standard_normal(depth.size)
    rows = np.column_stack([(depth + force / 0.1) * 1e6, force / 0.1 / 50e-9])
    np.savetxt(path, rows, delimiter=",", header="Z,D", comments="", fmt="%.12g")


def timeless(text: str) -> str:
    """Return JSON without date and wall time, every other byte as it is."""
    return re.sub(r',\n *"(date|wall_time)": [^,\n]*', "", text)


@pytest.mark.slow
def test_three_ways_give_the_same_bytes(cli: Cli) -> None:
    """Configuration, options and Python leave the same JSON but for date and wall time."""
    measure(FILE)
    Path("bead.toml").write_text(TOML, encoding="utf-8")
    printed = cli("bead.toml", "--json").stdout
    assert '"date": "' in printed
    assert '"wall_time": ' in printed
    text = timeless(printed)
    assert text == timeless(cli(str(FILE), *OPTIONS, "-o", "out", "--json").stdout)
    assert text == timeless(pl.fit(FILE, **ARGUMENTS).to_json())
    assert text == timeless(Path("out/Bead 1 µ-fit.json").read_text(encoding="ascii"))
    # Arrays have the same numbers; only their origin differs.
    (curve,) = pl.read_curves(
        FILE, **{k: ARGUMENTS[k] for k in ("columns", "sensitivity")}, spring_constant="0.1 N/m"
    ).values()
    options = {k: v for k, v in ARGUMENTS.items() if k not in ("columns", "sensitivity")}
    arrays, other = pl.fit(curve.position, curve.force, **options).to_dict(), json.loads(text)
    for found in (arrays, other):
        for key in ("date", "wall_time", "configuration"):
            found.pop(key, None)
        for key in ("data", "name"):
            del found["curves"][0][key]
    assert arrays == other


@pytest.mark.slow
def test_record(cli: Cli) -> None:
    """JSON has file, hash, columns, calibration, segment, baseline, versions and options."""
    measure(FILE)
    content = json.loads(cli(str(FILE), *OPTIONS, "--rivals", "none", "--json").stdout)
    assert content["curves"][0]["data"] == {
        "file": str(FILE),
        "curve": None,
        "sha256": hashlib.sha256(FILE.read_bytes()).hexdigest(),
        "columns": {"extension": "Z [um]", "deflection": "D [V]"},
        "sensitivity": 50e-9,
        "library": None,
        "spring_constant": 0.1,
        "segment": "approach",
        "baseline": "offset",
        "poissons_ratio": 0.5,
    }
    assert content["versions"]["pellicle"] == pl.__version__
    assert content["versions"]["numpy"] == np.__version__
    assert "scipy" in content["versions"]
    assert pl.FitConfig(**content["configuration"]) == pl.FitConfig.merged(curves=FILE, **ARGUMENTS)


@pytest.mark.slow
def test_record_of_many(cli: Cli) -> None:
    """The tables have the same of every curve, and the page has it too."""
    Path("beads").mkdir()
    for number in range(2):
        measure(Path(f"beads/{number}.csv"), number, length=0.0)
    options = [*OPTIONS, "--set", "rivals=[]"]
    cli("beads", *options, "-o", "out")
    with xr.open_dataset("out/fits.h5", engine="h5netcdf") as table:
        digests = [hashlib.sha256(Path(f"beads/{n}.csv").read_bytes()).hexdigest() for n in "01"]
        assert table["sha256"].values.tolist() == digests
        assert table["spring_constant"].values.tolist() == [0.1, 0.1]
        assert table["spring_constant"].attrs["units"] == "N/m"
        assert json.loads(table.attrs["configuration"])["indenter"]["radius"] == 5e-6
        assert f"pellicle {pl.__version__}" in table.attrs["versions"]
    with Path("out/fits.csv").open(encoding="utf-8", newline="") as file:
        row = next(csv.DictReader(file))
    assert row["file"] == os.path.join("beads", "0.csv")
    assert row["sensitivity [m/V]"] == "5e-08"
    assert row["columns"] == "extension = Z [um]; deflection = D [V]"
    configuration = json.loads(row["configuration"])
    assert configuration["baseline"] == "offset"
    # A list of all files in each row would grow as their number squared.
    assert "curves" not in configuration
    # Fits that are kept from an earlier call have the record of the files as they are now.
    Path("beads/0.csv").rename("beads/9.csv")
    cli("beads", *options, "-o", "out")
    rows = json.loads(Path("out/fits.json").read_text(encoding="utf-8"))["curves"]
    assert [row["curves"][0]["data"]["file"] for row in rows] == [
        str(Path("beads") / name) for name in ("1.csv", "9.csv")
    ]
    again = cli("out/fits.json", "--json").stdout
    assert [row["tension"] for row in json.loads(again)["curves"]] == [r["tension"] for r in rows]


@pytest.mark.slow
@pytest.mark.usefixtures("no_rivals")
def test_read_curves_and_draw_them(tmp_path: Path) -> None:
    """Curves are read by name, drawn, fitted; one that cannot be read is warned of."""
    measure(tmp_path / "a.csv")
    (tmp_path / "b.csv").write_text("position [um]\n1\n", encoding="utf-8")
    reading = {"columns": ARGUMENTS["columns"], "spring_constant": 0.1, "sensitivity": 50e-9}
    with pytest.warns(UserWarning, match=r"b\.csv: has 'position \[um\]'; missing"):
        curves = pl.read_curves(tmp_path, **reading)
    ((name, curve),) = curves.items()
    assert name == str(tmp_path / "a.csv")
    axes = curve.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("position [µm]", "force [nN]")
    line = axes.get_lines()[0]
    assert line.get_ydata() == pytest.approx(curve.force * 1e9)
    figure = pl.fit(curve.position, curve.force, indenter="sphere", radius=5e-6).plot()
    figure.savefig(tmp_path / "fit.png")
    assert drawn_width(tmp_path / "fit.png") > 0.5
    pyplot.close("all")
    with pytest.raises(pl.ConfigError, match="missing: one column 'Z'"):
        pl.read_curves(tmp_path / "b.csv", **reading)


@pytest.mark.usefixtures("no_rivals")
def test_the_folder_of_one_fit_is_shown_and_drawn(cli: Cli) -> None:
    """It shows what was printed; a curve that has changed is not drawn as if it had not."""
    measure(FILE)
    printed = cli(str(FILE), *OPTIONS, "-o", "out")
    told, _, files = printed.stdout.partition("wrote ")
    assert "out/Bead 1 µ-fit.h5" in files

    assert call("show", "out").stdout == told
    assert " Pa (" in call("show", "out", "--si").stdout
    content = Path("out/Bead 1 µ-fit.json").read_text(encoding="ascii")
    assert call("show", "out", "--json").stdout == content
    call("plot", "out", "-o", "again", "--format", "svg")
    assert Path("again/Bead 1 µ-fit.svg").is_file()
    with FILE.open("a") as file:
        file.write("9,9\n")
    assert "has changed since it was fitted" in call("plot", "out", code=2).stderr
