"""Curves from files, the command, and what is said of input that cannot be fitted or is hostile."""

import json
import os
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.files.choice import read
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.columns import Calibration
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.files.sources import gather
from pellicle_fit.files.tree import read_tree
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.command import Cli
from tests.plugins.fit.test_many import save

MODULUS, TENSION, RADIUS, POINT = 5e3, 7.5e-3, 10e-6, 1e-6
pytestmark = pytest.mark.usefixtures("no_rivals")
OPTIONS = ("--indenter", "paraboloid", "--radius", "10 um")


def _curve(points: int = 300) -> tuple[Array, Array]:
    depth = np.linspace(-1e-6, 3e-6, points)
    paraboloid = Paraboloid(radius=RADIUS)
    force = MODULUS * paraboloid.force_curve(depth, 2 * TENSION / MODULUS).force
    noise = np.random.default_rng(4).standard_normal(points)
    return depth + POINT, force + 0.005 * force.max() * noise


def _holds(estimate: dict[str, Any], truth: float) -> bool:
    return bool(estimate["low"] <= truth <= estimate["high"])


@pytest.mark.parametrize("dwell", [1, 20])
def test_rows_at_the_turn_belong_to_the_pass_that_has_them(dwell: int) -> None:
    """Of rows at the greatest position the first ends the approach, the last begins the retract."""
    position, force = _curve()
    relaxed = 0.9 * force[::-1]
    dwelling = np.full(dwell, position[-1]), np.full(dwell, relaxed[0])
    both = np.r_[position, dwelling[0], position[-2::-1]], np.r_[force, dwelling[1], relaxed[1:]]
    assert np.array_equal(clean(Measurement(*both)).force, force)
    assert np.array_equal(clean(Measurement(*both), "retract").force, relaxed)


def test_hdf5_and_depth(cli: Cli) -> None:
    """An HDF5 file with units is read; depth holds the contact point at 0."""
    position, force = _curve()
    with h5py.File("curve.h5", "w") as file:
        for name, values, unit in (("depth", position - POINT, "m"), ("force", force * 1e9, "nN")):
            file[name] = values
            file[name].attrs["units"] = unit
    report = json.loads(cli("curve.h5", *OPTIONS, "--json").stdout)
    assert report["parameters"]["contact_point"]["held"]
    assert report["parameters"]["contact_point"]["value"] == 0
    assert _holds(report["tension"], TENSION)


def test_result_of_a_run_is_a_curve(cli: Cli) -> None:
    """The file that ``pellicle run`` leaves can be fitted as it is."""
    run = pl.Run(
        grid={"points": 48, "size": "0.2 mm", "boundary": "free"},
        kernel={"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": 0.1},
        indenter={"type": "paraboloid", "radius": "1 mm"},
        loading={"depth": np.linspace(0.2e-6, 5e-6, 12).tolist()},
    )
    pl.run(run, progress=False).save("run.h5")
    report = json.loads(cli("run.h5", "-i", "paraboloid", "--radius", "1 mm", "--json").stdout)
    assert report["reduced_modulus"]["value"] == pytest.approx(1e4, rel=0.02)
    assert report["tension"]["value"] == pytest.approx(0.1, rel=0.02)


def test_baseline(cli: Cli) -> None:
    """An offset is pointed out; with offset and slope fitted the truth comes back."""
    position, force = _curve()
    drift = 3e-9 + 2e-3 * (position - position[0])
    save(Path("curve.csv"), position, force + drift)
    plain = json.loads(cli("curve.csv", *OPTIONS, "--json").stdout)
    assert "--baseline" in plain["next"][0]["do"]
    report = json.loads(cli("curve.csv", *OPTIONS, "--baseline", "slope", "--json").stdout)
    for name, truth in (
        ("reduced_modulus", MODULUS),
        ("tension", TENSION),
        ("offset", 3e-9),
        ("slope", 2e-3),
    ):
        assert _holds({**report["parameters"], **report}[name], truth)


def test_wild_rows_are_left_out(cli: Cli) -> None:
    """Rows without a number, and the way back, are left out and counted."""
    position, force = _curve()
    force[::10] = np.nan
    save(Path("curve.csv"), np.append(position, position[::-1]), np.append(force, force[::-1]))
    report = json.loads(cli("curve.csv", *OPTIONS, "--json").stdout)
    assert report["curves"][0]["points"] == pytest.approx(270, abs=2)
    assert any("60 of 600 rows hold no finite number" in message for message in report["messages"])
    assert any("are the approach" in message for message in report["messages"])
    assert _holds(report["tension"], TENSION)


def test_ten_points() -> None:
    """Ten points are fitted, with an interval as wide as an unseen tension makes it."""
    position, force = _curve(10)
    fit = pl.fit(position, force, indenter="paraboloid", radius=RADIUS)
    assert any("only 10 points" in message for message in fit.messages)
    assert _holds(vars(fit.if_present["reduced_modulus"]), MODULUS)


@pytest.mark.parametrize("indenter", ["paraboloid", "sphere"])
def test_wrong_radius_is_noticed(indenter: str) -> None:
    """A radius smaller by a thousand is doubted; the contact of a sphere ends at its equator."""
    fit = pl.fit(*_curve(), indenter=indenter, radius=RADIUS / 1000)
    assert fit.advice.startswith("check radius and units")
    for radius in (1e-40, 1e8):
        with pytest.raises(pl.ConfigError, match=r"indenter.radius: is .*; check the units"):
            pl.fit(*_curve(), indenter=indenter, radius=radius, rivals=["adhesion"])


SHUFFLED = np.random.default_rng(0).permutation(300)
BAD: list[tuple[str, Callable[[Array, Array], tuple[Array, Array]]]] = [
    ("this is a retract", lambda z, f: (z[::-1], f[::-1])),
    ("negative stiffness", lambda z, f: (z, -f)),
    ("negative stiffness", lambda z, f: (-z, f)),
    ("sticks over most of it", lambda z, f: (z, f.max() * (2.0 * (z > z[-4]) - (z > z[-30])))),
    ("no contact in the curve", lambda z, f: (z, 1e-9 * np.random.default_rng(1).random(z.size))),
    ("no contact in the curve", lambda z, f: (z, 0 * f)),
    ("give a curve that moves", lambda z, f: (np.full_like(z, 1e-6), f)),
    ("several curves", lambda z, f: (np.tile(z, 3), np.tile(f, 3))),
    ("rows out of order", lambda z, f: (z[SHUFFLED], f[SHUFFLED])),
    ("at least 8", lambda z, f: (z[-5:], f[-5:])),
    ("at least 8", lambda z, f: (z, np.nan * f)),
    ("one curve at a time", lambda z, f: (np.tile(z, (2, 1)), f)),
    ("a list of real numbers", lambda z, f: (z, 1j * f)),  # type: ignore[list-item, return-value]
    ("has 299 values and position 300", lambda z, f: (z, f[1:])),
    ("position: is 4e.294 m in row 300; a fit needs values up to", lambda z, f: (1e300 * z, f)),
    ("position: varies by 4e-306 m; a fit needs", lambda z, f: (1e-300 * z, f)),
    ("force: is -1e.31 N in row 8", lambda z, f: (z, np.where(np.arange(z.size) == 7, -1e31, f))),
    ("force: varies by .*e-167 N.*check the unit", lambda z, f: (z, 1e-160 * f)),
    ("not a list of real numbers", lambda z, f: ([10**400] * 300, f)),  # type: ignore[list-item, return-value]
]


def test_masked_rows_are_left_out() -> None:
    """What a mask covers is no measured value, such as the marks of a NetCDF file."""
    position = np.linspace(-1e-6, 1e-6, 100)
    force = np.maximum(position, 0.0) ** 1.5
    masked = np.ma.masked_array(np.where(position > 0.9e-6, -32768.0, force), position > 0.9e-6)
    curve = clean(Measurement(position, masked))
    assert np.array_equal(curve.force, force[:95])
    assert "5 of 100 rows hold no finite number and were left out" in curve.messages


@pytest.mark.parametrize(("words", "change"), BAD)
def test_bad_curves(words: str, change: Callable[[Array, Array], tuple[Array, Array]]) -> None:
    """A curve that cannot be fitted is refused in words."""
    with pytest.raises(pl.ConfigError, match=words):
        clean(Measurement(*change(*_curve())))


def test_retract_on_request() -> None:
    """A retract is fitted if asked for, with a caution."""
    position, force = _curve()
    options: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS, "segment": "retract"}
    fit = pl.fit(position[::-1], force[::-1], **options)
    assert _holds(vars(fit.tension), TENSION)
    assert any("adhered" in message for message in fit.messages)
    with pytest.raises(pl.ConfigError, match="into the solid: this is an approach, and"):
        pl.fit(position, force, **options)


def test_each_folder_of_a_tree_is_entered_once(tmp_path: Path) -> None:
    """Forty folders with two ways to each, and all ways back: its curve is read, and soon."""
    path = tmp_path / "curves.h5"
    depth, force = np.linspace(0, 1e-6, 20), np.linspace(0, 1e-9, 20)
    with h5py.File(path, "w") as file:
        file["depth"], file["force"] = depth, force
        group = file
        for _ in range(40):
            below = group.create_group("a")
            group["b"] = below
            below["back"] = file["/"]
            group = below
        group["depth"], group["force"] = depth, force
    curves, heads = read_tree(path, {})[:2]
    assert len(curves) == 1
    assert len(heads) == 4


def _linked(file: h5py.File) -> None:
    file["force"] = h5py.SoftLink("/force")


def _typed(file: h5py.File) -> None:
    file["force"] = np.dtype("f8")


def _claiming(file: h5py.File) -> None:
    file.create_dataset("force", (10**12,), chunks=(1000,), dtype="f8")
    file.create_dataset("position", (10**12,), chunks=(1000,), dtype="f8")


@pytest.mark.parametrize("ending", ["h5", "mat"])
@pytest.mark.parametrize("fill", [_linked, _typed, _claiming])
def test_hostile_trees(tmp_path: Path, fill: Callable[[h5py.File], None], ending: str) -> None:
    """Each is refused in words, without memory for what it claims."""
    path = tmp_path / f"a.{ending}"
    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
        if "position" not in file:
            file["position"] = np.arange(9.0)
    with pytest.raises(pl.PellicleError, match=r"a\.(h5|mat)"):
        [reader() for reader in read(path).values()]


def test_a_text_needs_no_more_memory_than_there_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its cells take more than its bytes do."""
    path = tmp_path / "a.csv"
    path.write_text("position [um],force [nN]\n" + "1,2\n" * 1000)
    monkeypatch.setattr("pellicle.memory.available", lambda: 1e6)
    assert read(path)
    for limit in (1e5, 1e4):
        monkeypatch.setattr("pellicle.memory.available", lambda limit=limit: limit)
        with pytest.raises(pl.ConfigError, match=r"a\.csv as a text needs about"):
            read(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="has no pipes")
def test_pipes_devices_and_long_names(tmp_path: Path) -> None:
    """What never ends is not read."""
    os.mkfifo(tmp_path / "a.csv")
    (tmp_path / "b.csv").symlink_to("/dev/zero")
    sources = [*gather(tmp_path, Calibration(), {}), *gather("x" * 300 + ".csv", Calibration(), {})]
    texts = [str(source.curve) for source in sources]
    assert ["is a pipe or a device; give a file" in text for text in texts] == [True, True, False]
    assert "cannot be read" in texts[2]


def test_an_archive_without_curves(tmp_path: Path) -> None:
    """It has folders only."""
    path = tmp_path / "a.jpk-force"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("segments/", b"")
        archive.writestr("header.properties", b"")
    with pytest.raises(pl.StorageError, match="afmformats cannot read it"):
        read(path, Calibration(spring_constant=1.0, sensitivity=1e-7))
