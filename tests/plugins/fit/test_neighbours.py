"""In a folder, curves spare each other comparisons, and parts are fitted under locks, all alike."""

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.runs.lock import lock_files
from pellicle_fit.representatives import kind_of, neighbours, order_of
from pellicle_fit.selection.neighbour import RULED_OUT, Neighbour
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.command import Cli, run_parts
from tests.plugins.fit.test_many import OPTIONS, curve, save

COUNT, OTHER = 18, 6
"""Curves of the folder, and the one of another solid."""
BEAD: dict[str, Any] = {
    "indenter": "paraboloid",
    "radius": 5e-6,
    "progress": False,
    "rivals": ("cone", "brush"),
}


def measured() -> dict[str, Any]:
    """Return curves under a tension, with offsets of their own, and one that is adhesive."""
    random, curves = np.random.default_rng(4), {}
    depth = np.linspace(-0.5e-6, 1e-6, 100)
    for number in range(COUNT):
        force = 2e3 * Paraboloid(radius=5e-6).force_curve(depth, 3e-6).force
        if number == OTHER:
            force = np.where(depth > 0, 5e3 * depth, 0.0) * 1e-3
        force = random.uniform(0.9, 1.1) * force
        force = force + 0.002 * force.max() * random.standard_normal(depth.size)
        curves[str(number)] = depth + random.uniform(0, 3e-6), force
    return curves


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> tuple[xr.Dataset, xr.Dataset, Path]:
    """Return the table with every rival, that without those ruled out, and its folder."""
    folder = tmp_path_factory.mktemp("fits")
    curves = measured()
    whole = pl.fit_many(curves, every_rival=True, **BEAD)
    return whole, pl.fit_many(curves, directory=folder, **BEAD), folder


def test_answers_are_the_same(tables: tuple[xr.Dataset, xr.Dataset, Path]) -> None:
    """Verdicts are those of all comparisons, and ends of intervals to 0.05 of a half-width."""
    whole, spared, _ = tables
    assert whole["verdict"].values.tolist() == spared["verdict"].values.tolist()
    half = (whole["reduced_modulus_high"] - whole["reduced_modulus_low"]).values / 2
    for name in ("reduced_modulus", "reduced_modulus_low", "reduced_modulus_high"):
        there = np.isfinite(half)
        off = (spared[name].values - whole[name].values)[there] / half[there]
        assert np.max(np.abs(off)) < 0.05


def test_rows_say_what_was_not_weighed(tables: tuple[xr.Dataset, xr.Dataset, Path]) -> None:
    """One in 16 is compared with everything, as is what differs from those beside it."""
    whole, spared, _ = tables
    assert not any(whole["not_weighed"].values)
    told = spared["not_weighed"].values
    full = [number for number in range(COUNT) if not told[number]]
    order = np.argsort(order_of([*measured().values()]), kind="stable")
    assert {OTHER, *order[::16].tolist()} <= set(full)
    assert len(full) <= 5
    assert all("cone" in text.split("; ") for text in told[told != ""])


def test_an_interrupted_folder_goes_on_alike(tables: tuple[xr.Dataset, xr.Dataset, Path]) -> None:
    """What was fitted before speaks for what is new as it did."""
    _, spared, folder = tables
    kept = sorted((folder / "curves").glob("*.json"))
    for path in kept[::3]:
        path.unlink()
    again = pl.fit_many(measured(), directory=folder, **BEAD)
    xr.testing.assert_identical(spared.drop_attrs(), again.drop_attrs())


def test_which_curves_speak_for_others() -> None:
    """Of each kind one in 16, the nearest first; of few curves all are compared in full."""
    assert neighbours(["a"] * 7) == [[]] * 7
    found = neighbours(["a", "b"] * 18)
    assert [i for i, near in enumerate(found) if not near] == [0, 1, 32, 33]
    assert found[4] == [0, 32]
    assert found[31] == [33, 1]
    assert found[34] == [32]
    assert RULED_OUT > 12


def test_each_material_of_a_map_speaks_for_itself() -> None:
    """Curves of one stiffness and shape come together, wherever they were measured."""
    depth, random = np.linspace(-0.5, 1.0, 300), np.random.default_rng(3)
    rise = np.maximum(depth, 0.0)
    materials = rise**1.5, rise**1.2, 3 * rise**1.5
    noise = 0.01 * random.normal(size=(96, 300))
    curves = [
        (depth + i, random.uniform(0.9, 1.1) * materials[i % 3] + noise[i]) for i in range(96)
    ]
    order = order_of(curves)
    runs = [number % 3 for number in np.argsort(order)]
    assert sum(a != b for a, b in pairwise(runs)) == 2
    near = neighbours(["map"] * 96, order)
    mixed = [i for i, of in enumerate(near) if of and not any(j % 3 == i % 3 for j in of)]
    assert not mixed
    # Of a detector out of its range nearly all forces are the largest.
    saturated = np.where(np.arange(depth.size) < 3, 0.0, 1e-9)
    flat = [(depth, 0 * depth), (depth[:0], depth[:0]), (depth, saturated)]
    assert order_of(flat).tolist() == [0.0, 0.0, 0.0]


def test_what_makes_a_kind() -> None:
    """Numbers that differ little, and all else alike."""
    bead = {"type": "sphere", "radius": 5e-6}
    assert kind_of("", bead, 0.05) == kind_of("", bead | {"radius": 5.1e-6}, 0.051)
    assert kind_of("", bead, 0.05) != kind_of("", bead | {"radius": 50e-6}, 0.05)
    assert kind_of("", bead, 0.05) != kind_of("", bead, None)
    assert kind_of("", bead, 0.05) != kind_of("day", bead, 0.05)


def test_noise_alone_makes_no_curve_another() -> None:
    """A check that fails by the noise alone contradicts no model, so that the curve speaks."""
    plain = {"effects": [], "delta_aic": 0.0, "tied": True, "parameters": {}}
    fit = {"verdict": "no sign", "explanations": [plain], "baseline": []}
    fit["curves"] = [{"failed_checks": [{"code": "slow"}]}]
    assert Neighbour.of_dict(fit).has(frozenset(), is_described=True)
    assert not Neighbour.of_dict(fit | {"verdict": "no model describes"}).has(frozenset(), True)


ALIKE = 20
TIMES = ("wall_time", "date", "checksum")


def fill(folder: Path, count: int) -> Path:
    """Write curves that are alike, and one that cannot be read; return their folder."""
    for number in range(count):
        save(folder / f"{number:02}.csv", *curve(number))
    (folder / "zz.csv").write_text("position [um],force [nN]\n1,2\n", encoding="utf-8")
    return folder


def fits_in(folder: Path) -> Any:
    """Return what a folder holds of fits, without times."""

    def kept(value: Any) -> Any:
        if isinstance(value, dict):
            return {name: kept(entry) for name, entry in value.items() if name not in TIMES}
        return [*map(kept, value)] if isinstance(value, list) else value

    return kept(json.loads((folder / "fits.json").read_text(encoding="utf-8")))


def test_parts_are_as_one(cli: Cli, tmp_path: Path) -> None:
    """The last of three parts writes the table; curves that speak for others come first."""
    fill(tmp_path / "day", ALIKE)
    cli("day", *OPTIONS, "-o", "whole", code=1)
    assert "curves left:" in cli("day", *OPTIONS, "-o", "out", "--part", "3/3").output
    assert not (tmp_path / "out" / "fits.h5").exists()
    left = json.loads(cli("day", *OPTIONS, "-o", "out", "--part", "2/3", "--json", "-q").stdout)
    assert left["left"]
    assert not left["failed"]
    last = cli("day", *OPTIONS, "-o", "out", "--part", "1/3", code=1)
    assert "1 of 21 curves could not be fitted" in last.stderr
    assert fits_in(tmp_path / "out") == fits_in(tmp_path / "whole")
    assert not list(tmp_path.rglob("*.lock"))


def test_curves_of_another_process_are_left_to_it(cli: Cli, tmp_path: Path) -> None:
    """Any part passes over locked curves; a later call fits those whose holder ended."""
    fill(tmp_path / "day", 3)
    kept = tmp_path / "out" / "curves"
    cli("day/00.csv", "day/02.csv", *OPTIONS, "-o", "out")
    (last, *_) = kept.glob("*.json")
    last.unlink()
    with lock_files(kept, last.stem):
        held = cli("day", *OPTIONS, "-o", "out", "--part", "any")
    assert "another process fits it" in held.stderr
    assert "curves left: 1" in held.stdout
    cli("day", *OPTIONS, "-o", "out", "--part", "any", code=1)
    assert (tmp_path / "out" / "fits.h5").is_file()


def test_part_is_refused(cli: Cli, tmp_path: Path) -> None:
    """Parts need a folder, and several curves that are fitted on their own."""
    fill(tmp_path / "day", 2)
    assert "name it (-o DIR)" in cli("day", *OPTIONS, "--part", "any", code=2).stderr
    for given in (["day/00.csv"], ["day", "--pool"]):
        refused = cli(*given, *OPTIONS, "-o", "out", "--part", "1/2", code=2)
        assert "has no parts" in refused.stderr


@pytest.mark.slow
def test_parts_with_kills(tmp_path: Path) -> None:
    """Of ten parts on two processes some are killed; the fits are those of one process."""
    fill(tmp_path / "day", ALIKE)
    (tmp_path / "day" / "zz.csv").unlink()
    killed = run_parts(["fit", "day", *OPTIONS, "-o", "out", "--quiet"], 10, tmp_path, kills=6)
    assert killed > 1
    pl.fit_many(
        tmp_path / "day",
        directory=tmp_path / "whole",
        indenter="paraboloid",
        radius="10 um",
        rivals=(),
        progress=False,
    )
    own, other = (fits_in(tmp_path / name)["curves"] for name in ("out", "whole"))
    for fit in (*own, *other):
        fit.pop("curve"), fit.pop("curves")
    assert own == other
