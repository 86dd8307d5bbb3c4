"""Folders and files of many curves: one row each, whatever becomes of the others."""

import json
import pickle
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components import AnyTask, Executor, Outcome, Report, Say
from pellicle.plugins.registry import Registry
from pellicle_fit.many import fit_sources
from pellicle_fit.population.fits import ManyFits, summary
from pellicle_fit.population.row import Row
from pellicle_fit.report.population import distributions
from pellicle_fit.report.tables import groups
from pellicle_fit.words.population import sentences_of_population
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.command import Cli
from tests.plugins.fit.conftest import ends_of

MODULUS, LENGTH, RADIUS = 5e3, 3e-6, 10e-6
HEADER = "position [um],force [nN]"
OPTIONS = ("-i", "paraboloid", "--radius", "10 um", "--rivals", "none")
ALONE: dict[str, Any] = {"rivals": (), "progress": False}
BEAD: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS}
HERTZ = BEAD | ALONE | {"fix": {"tension": 0}}


def curve(seed: int, *, radius: float = RADIUS, points: int = 60) -> tuple[Array, Array]:
    """Return position and force under a paraboloid."""
    depth = np.linspace(-0.1, 0.3, points) * radius
    bead = Paraboloid(radius=radius)
    force = MODULUS * bead.force_curve(depth, LENGTH).force
    noise = np.random.default_rng(seed).standard_normal(points)
    return depth + 1e-6, force + 0.005 * force.max() * noise


def save(path: Path, position: Array, force: Array, header: str = HEADER) -> None:
    """Write a table."""
    path.parent.mkdir(exist_ok=True)
    rows = np.column_stack([position * 1e6, force * 1e9])
    np.savetxt(path, rows, delimiter=",", header=header, comments="")


def folder(tmp_path: Path) -> Path:
    """Return a folder of two curves that can be fitted and of four that cannot."""
    day = tmp_path / "day"
    position, force = curve(1)
    save(day / "a.csv", position, force)
    save(day / "b.csv", *curve(2))
    save(day / "c.csv", position, force, "position [um],force [V]")
    save(day / "d.csv", position[::-1], force[::-1])
    save(day / "e.csv", position, 1e-3 * force.max() * np.sin(1e9 * position))
    save(day / "f.csv", np.tile(position, 3), np.tile(force, 3))
    (day / "notes.md").write_text("not a curve", encoding="utf-8")
    return day


@pytest.mark.slow
def test_folder(cli: Cli, tmp_path: Path) -> None:
    """A row for each file; those that cannot be fitted say why, and the exit code does."""
    folder(tmp_path)
    result = cli("day", *OPTIONS, "--fix", "tension=0", "-o", "out", "--report", code=1)
    assert "4 of 6 curves could not be fitted" in result.stderr
    rows = json.loads(Path("out/fits.json").read_text(encoding="utf-8"))["curves"]
    assert [Path(row["curve"]).name for row in rows] == [f"{letter}.csv" for letter in "abcdef"]
    statuses = [row["status"] for row in rows]
    assert statuses[:2] == ["fitted", "fitted"]
    reasons = ["--sensitivity", "this is a retract", "no contact", "several curves"]
    for status, words in zip(statuses[2:], reasons, strict=True):
        assert status.startswith("failed: ")
        assert words in status
        assert words in result.stderr
    with xr.open_dataset("out/fits.h5", engine="h5netcdf") as table:
        assert table["reduced_modulus"].attrs["units"] == "Pa"
        assert np.isfinite(table["reduced_modulus"].values).tolist() == [True] * 2 + [False] * 4
        assert (table["reduced_modulus_low"] < table["reduced_modulus"])[:2].all()
    lines = Path("out/fits.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("curve,status,reduced_modulus [Pa],reduced_modulus_low [Pa],")
    assert len(lines) == 7
    page = Path("out/fits.html").read_text(encoding="utf-8")
    for words in ("2 of 6 curves were fitted", "10 µm", "no contact", "svg+xml"):
        assert words in page
    assert page.count(">failed</td>") == 4


@pytest.mark.slow
def test_what_is_done_is_kept(cli: Cli, tmp_path: Path) -> None:
    """The same command goes on; another question is asked anew."""
    for seed, name in enumerate(("a", "b")):
        save(tmp_path / "day" / f"{name}.csv", *curve(seed))
    common = ("day", *OPTIONS, "--fix", "tension=0", "-o", "out")
    assert "done before" not in cli(*common).output
    save(tmp_path / "day" / "c.csv", *curve(5))
    again = cli(*common)
    assert "2 of 3 fits were done before" in again.output
    assert "done before" not in cli(*common, "--baseline", "offset").output
    assert len(list(Path("out/curves").iterdir())) == 6


@pytest.mark.parametrize(
    "damage",
    [
        *(b"", b"{}", b"[]", b"3", b"null", b"{", b"\xff\xfe" * 9, b"[" * 100_000),
        (b'"points": 60', b'"points": "x"'),
        (b'"points": 60', b'"points": 61'),
        (b'"curves"', b'"curve"'),
        (b'"sketch"', b'"picture"'),
    ],
)
def test_a_kept_fit_that_was_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, damage: bytes | tuple[bytes, bytes]
) -> None:
    """A file that is no fit, or not the one that was kept, is named, and its curve fitted again."""
    monkeypatch.setattr("pellicle_fit.report.population.save_population", lambda *_: ())
    config = pl.FitConfig.merged(**BEAD, rivals=(), fix={"tension": 0})

    def fits() -> ManyFits:
        return fit_sources(config, config.sources({"a": curve(1)}), tmp_path, progress=False)

    first = fits()
    (path,) = (tmp_path / "curves").glob("*.json")
    kept = path.read_bytes()
    assert json.loads(kept)["reduced_modulus"] == first.rows[0].fit.data["reduced_modulus"]
    assert json.loads(kept)["explanations"]
    assert "explanations" not in first.rows[0].fit.data
    assert first.rows[0].to_dict()["kept"] == f"curves/{path.name}"
    path.write_bytes(damage if isinstance(damage, bytes) else kept.replace(*damage))
    assert path.read_bytes() != kept
    again = fits()
    assert again.rows[0].to_dict() == first.rows[0].to_dict()
    assert again.resumed == 0
    note = f"{path} is not the fit that pellicle kept: a is fitted again"
    assert again.notes == [note, *first.notes]
    assert path.read_bytes() == kept
    assert (fits().resumed, fits().notes) == (1, first.notes)


@pytest.mark.parametrize(
    ("uncertainty", "options", "share"),
    [
        ({"spring_constant": 0.1}, {}, 0.1),
        ({"spring_constant": "35 %"}, {}, 0.35),
        ({"radius": 0.1}, {}, 0.05),
        ({"spring_constant": 0.1, "radius": 0.1}, {}, np.hypot(0.1, 0.05)),
        ({"spring_constant": 0.1, "radius": 0.1}, {"radius": [RADIUS] * 2}, 0.1),
        ({"radius": 0.1}, {"diameter": [2 * RADIUS] * 2}, 0.0),
    ],
)
def test_an_error_that_curves_share_stands_beside_the_median(
    uncertainty: dict[str, Any], options: dict[str, Any], share: float
) -> None:
    """F ∝ k E* R^½: only what each file has of its own is in its interval, as in that of a fit."""
    bead: Any = Paraboloid(radius=RADIUS)
    position = curve(0)[0]
    force = MODULUS * bead.force_curve(position - 1e-6, 0.0).force
    noise = 0.005 * force.max() * np.random.default_rng(0).standard_normal((2, force.size))
    curves = {f"{n}": (position, force + one) for n, one in enumerate(noise)}
    hertz: dict[str, Any] = BEAD | {"rivals": (), "fix": {"tension": 0}}

    def fits(**more: Any) -> list[Row]:
        config = pl.FitConfig.merged(**(hertz | more))
        return fit_sources(config, config.sources(curves), None, progress=False).rows

    exact, weighed = fits(), fits(uncertainty=uncertainty, **options)
    for one, other in zip(exact, weighed, strict=True):
        known, found = (row.fit.estimates()["reduced_modulus"] for row in (one, other))
        assert found.value == pytest.approx(known.value, rel=1e-6)
        assert ends_of(found)[1] > 1.05 * ends_of(known)[1] if options else found == known
    (line,) = summary(weighed)
    expected = 1.96 * share * line["median"]
    assert line.get("common_error", 0.0) == pytest.approx(expected, rel=1e-3)
    assert ("beside the medians" in sentences_of_population(weighed)[-1]) == (share > 0)
    assert (groups(weighed).columns[-1].read()[0] == "common error") == (share > 0)
    guides = [one.legend for one in distributions(weighed)[0].series if one.legend]
    assert guides == ["95 % of the common error"] * bool(share)


def test_a_row_is_that_of_the_chosen_explanation() -> None:
    """The row of a curve is what `fit` says of it, here beside an offset that it needs."""
    position, force = curve(1)
    shifted = {"a": (position, force + 0.05 * force.max())}
    table = pl.fit_many(shifted, **BEAD, rivals=["offset"], progress=False)
    alone = pl.fit(*shifted["a"], **BEAD, rivals=["offset"])
    for name, estimate in alone.estimates().items():
        assert table[name].item() == pytest.approx(estimate.value, rel=1e-6)
        for end, value in (("low", estimate.low), ("high", estimate.high)):
            expected = np.nan if value is None else value
            assert table[f"{name}_{end}"].item() == pytest.approx(expected, nan_ok=True)
    assert "an offset was needed" in str(alone.data["remarks"])
    assert str(table["verdict"].item()) == alone.verdict.value
    assert table["comparison"].item() == alone.comparison


def test_another_version_of_a_plugin_is_another_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is kept of an indenter is not that of its next version; that of an executor is."""
    releases: dict[type, str] = {Paraboloid: "1", Keeps: "1"}

    def versions(self: object, used: Collection[type]) -> dict[str, str]:
        """Return the releases of the distributions of components."""
        return {kind.__name__: releases[kind] for kind in releases if kind in used}

    def fits() -> int:
        """Fit a curve, and return how many fits are kept."""
        pl.fit_many({"a": curve(1)}, directory=tmp_path, executor=Keeps(), **HERTZ)
        return len(list((tmp_path / "curves").iterdir()))

    monkeypatch.setattr(Registry, "versions", versions)
    monkeypatch.setattr("pellicle_fit.report.population.save_population", lambda *_: ())
    assert fits() == 1
    releases[Keeps] = "2"
    assert fits() == 1
    releases[Paraboloid] = "2"
    assert fits() == 2


class Stiffer:
    """A paraboloid on which forces are a multiple of the true ones."""

    depth_limit = np.inf

    def __init__(self, factor: float) -> None:
        self.factor = factor

    def force_curve(self, depth: Array, length: float) -> pl.ForceCurve:
        curve = Paraboloid(radius=RADIUS).force_curve(depth, length)
        return pl.ForceCurve(*(self.factor * values for values in curve))


@pytest.mark.slow
def test_each_change_is_another_fit(tmp_path: Path) -> None:
    """Radius, indenter and model make another fit of the same curve; an executor does not."""
    common: dict[str, Any] = ALONE | {"fix": {"tension": 0}, "directory": tmp_path}
    moduli = set()
    for options in (
        BEAD,
        BEAD | {"executor": Keeps()},
        BEAD | {"radius": 2 * RADIUS},
        BEAD | {"radius": [3 * RADIUS]},
        BEAD | {"fix": {"tension": 1e-3}},
        {"indenter": Stiffer(2.0)},
        {"indenter": Stiffer(5.0)},
    ):
        table = pl.fit_many({"a": curve(1)}, **common | options)
        moduli.add(table["reduced_modulus"].item())
    assert len(moduli) == len(list((tmp_path / "curves").iterdir())) == 6


class Keeps(Executor):
    """Carries out what was pickled, as another process would."""

    type: Literal["keeps"] = "keeps"

    def map(
        self,
        work: Callable[[AnyTask, Say], Outcome],
        tasks: Sequence[AnyTask],
        report: Report[AnyTask],
    ) -> Iterator[tuple[AnyTask, Outcome | Exception]]:
        for task in reversed(tasks):
            assert task.memory > 0
            copy, moved = pickle.loads(pickle.dumps((work, task)))
            yield task, pickle.loads(pickle.dumps(copy(moved, lambda _: None)))


def test_simulated_before_the_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """What has to be simulated is so by the executor of the fits, which take it along."""
    executors = []

    def simulated(indenter: pl.Indenter, *_: Any, **settings: Any) -> pl.Indenter:
        executors.append(settings["executor"])
        return indenter

    monkeypatch.setattr("pellicle_fit.problem.simulated_curve", simulated)
    curves = {str(seed): curve(seed) for seed in range(2)}
    solid = {"kernel": "tensed_membrane", "executor": Keeps()}
    copy, here = (pl.fit_many(curves, **HERTZ | own) for own in (solid, {}))
    assert executors == [Keeps(), Keeps()]
    xr.testing.assert_identical(copy, here)


def test_radius_of_each(cli: Cli) -> None:
    """Each file has its own radius."""
    for radius in (5, 20):
        save(Path(f"{radius}.csv"), *curve(radius, radius=radius * 1e-6, points=200))
    files = "5.csv", "20.csv", "--radius", "5 um", "--radius", "20 um"
    printed = cli(*files, "-i", "paraboloid", "--rivals", "none", "--json").stdout
    for row in json.loads(printed)["curves"]:
        assert row["reduced_modulus"]["low"] < MODULUS < row["reduced_modulus"]["high"]
