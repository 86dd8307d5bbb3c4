"""The files of each output, and what that of the adhesive curve leaves behind."""

import json
import re
from math import isnan, pi
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.errors import ConfigError
from pellicle.results import StoredRuns
from pellicle.runs import solve as solving
from pellicle_plugins.outputs.adhesive_curve import AdhesiveCurve
from tests.plugins.outputs.shared import PUNCH, bead, rows

EVERYTHING: list[dict[str, Any]] = [
    {"type": "csv"},
    {"type": "figures"},
    {"type": "maps"},
    {"type": "maps", "formats": ["svg", "pdf"]},
    {"type": "maps", "name": "nothing", "field": "1 / (0 * depth + 0 * pressure)"},
    {"type": "curves", "log": ["x", "y"]},
    *({"type": type_} for type_ in ("profiles", "patches", "spectrum")),
    *({"type": type_} for type_ in ("distributions", "vtk", "html")),
]
WITH_NUMBERS = "curves", "profiles", "patches", "spectrum", "distributions"
FIGURES = {f"-{name}.png" for name in ("pressure", "profile", "force_depth", "area_force")}
OF_RUNS = {".h5", ".csv", ".pvd", "-0001.vts", "-0002.vts"}
NAMES = {
    *OF_RUNS,
    *(".html", "-maps.png", "-maps.svg", "-maps.pdf", "-nothing.png"),
    *(f"-{type_}.{suffix}" for type_ in WITH_NUMBERS for suffix in ("png", "csv")),
}


def _run(outputs: list[Any] | None, **changes: Any) -> pl.Run:
    corrections = [{"type": "yastrebov"}]
    return pl.Run(**bead(title="Two Steps", corrections=corrections, outputs=outputs, **changes))


def test_csv(tmp_path: Path) -> None:
    """The table has units in its header and the numbers of the last run in one row a step."""
    for _ in range(2):
        result = pl.run(_run([{"type": "csv"}]), directory=tmp_path, progress=False)
    table = rows(tmp_path / "two-steps.csv")
    assert [row["step"] for row in table] == ["1", "2"]
    for header in ("depth [m]", "force [N]", "contact_area [m2]", "contact_area_yastrebov [m2]"):
        name = header.partition(" ")[0]
        assert [float(row[header]) for row in table] == list(result.dataset[name].values)
    assert [row["status"] for row in table] == ["converged", "converged"]
    assert [row["converged"] for row in table] == ["True", "True"]
    assert {"mean_pressure [Pa]", "contact_fraction", "iterations", "wall_time [s]"} <= {*table[0]}


@pytest.mark.slow
def test_names_of_files_of_a_study(tmp_path: Path) -> None:
    """The table and the figures lie in the folder of a study, what shows single runs in runs."""
    study = pl.Study(run=_run(EVERYTHING), vary={"indenter.radius": [1e-3, 2e-3]})
    table = pl.run_study(study, tmp_path, progress=False)
    names = {path.name.removeprefix("study") for path in tmp_path.glob("study*")}
    of_study = NAMES - OF_RUNS | {".h5", ".csv"}
    assert names == of_study | {"-force.png", "-contact_area.png"}
    runs = {path.name for path in (tmp_path / "runs").iterdir()}
    assert runs == {f"{run}{suffix}" for run in table["run"].values for suffix in OF_RUNS}


@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
@pytest.mark.parametrize(
    "changes",
    [
        {"loading": {"depth": [0, 0]}},
        *(
            pytest.param(changes | {"indenter": PUNCH}, marks=pytest.mark.slow)
            for changes in (
                {"grid": {"points": [1, 8], "size": "0.4 mm", "boundary": "periodic"}},
                {"grid": {"points": 1, "size": "0.1 mm"}},
                {},
            )
        ),
    ],
    ids=["no contact", "one cell across", "a single cell", "punch with nothing beside it"],
)
def test_odd_results(tmp_path: Path, changes: dict[str, Any]) -> None:
    """Results without contact, width or finite gaps, and maps of nothing finite, are drawn too."""
    pl.run(_run(EVERYTHING, **changes), directory=tmp_path, progress=False)
    names = {path.name.removeprefix("two-steps") for path in tmp_path.iterdir()}
    assert names == NAMES | FIGURES
    has_spectrum = changes.get("indenter") is not PUNCH
    assert has_spectrum == bool(rows(tmp_path / "two-steps-spectrum.csv", series="indenter"))
    page = (tmp_path / "two-steps.html").read_text(encoding="utf-8")
    (maps,) = re.findall(r'<script [^>]*class="maps">(.*?)</script>', page, re.DOTALL)
    for field in json.loads(maps)["frames"][0]["fields"]:
        assert np.isfinite([field["low"], field["high"]]).all()


def test_any_run_leaves_its_result(tmp_path: Path) -> None:
    """The file holds the very result that the run returned, whichever outputs are named."""
    for number, outputs in enumerate(([], [{"type": "csv"}])):
        folder = tmp_path / str(number)
        result = pl.run(_run(outputs), directory=folder, progress=False)
        names = {path.suffix for path in folder.iterdir()}
        assert names == {".h5", *(f".{one['type']}" for one in outputs)}
        xr.testing.assert_identical(pl.load(folder / "two-steps.h5").dataset, result.dataset)


class Recording(pl.Output):
    """Keeps the steps that it is given, and how many the result on the disk has then."""

    type: Literal["recording"] = "recording"
    seen: ClassVar[list[tuple[int, str]]] = []

    def step(self, record: xr.Dataset, stem: Path) -> None:
        self.seen.append((record["step"].item(), stem.name))

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        return ()


def test_steps_come_once_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Outputs have each finished step while the next is solved; a later process repeats them."""
    solve, counts, seen = solving.solve_step, list[int](), Recording.seen

    def look_and_solve(*arguments: Any) -> Any:
        path = tmp_path / "two-steps.h5"
        counts.append(pl.load(path).dataset.sizes["step"] if path.exists() else 0)
        if len(counts) == 2:
            raise KeyboardInterrupt
        return solve(*arguments)

    run = _run([Recording(), {"type": "csv"}])
    with monkeypatch.context() as context:
        context.setattr(solving, "solve_step", look_and_solve)
        with pytest.raises(KeyboardInterrupt):
            pl.run(run, directory=tmp_path, progress=False)
    assert counts == [0, 1]
    assert len(rows(tmp_path / "two-steps.csv")) == 1
    assert seen == [(1, "two-steps-recording")]
    seen.clear()
    pl.run(run, directory=tmp_path, progress=False)
    assert [number for number, _ in seen] == [1, 2]


def test_library_writes_nothing_unasked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A library call without a folder or outputs leaves no file."""
    monkeypatch.chdir(tmp_path)
    choices: tuple[list[dict[str, Any]] | None, ...] = (None, [])
    for outputs in choices:
        pl.run(_run(outputs), progress=False)
    assert list(tmp_path.iterdir()) == []


def test_steps_of_a_longer_run_do_not_stay(tmp_path: Path) -> None:
    """Files of steps that a run does not have would belong to the one that it replaces."""
    other = tmp_path / "s-0003-0001.vts"
    other.touch()
    for depths in (["10 um", "12 um"], ["14 um"]):
        run = bead(title="s", outputs=[{"type": "vtk"}], loading={"depth": depths})
        pl.run(run, directory=tmp_path, progress=False, overwrite=True)
    assert {*tmp_path.glob("*.vts")} == {tmp_path / "s-0001.vts", other}


WORK = 0.5e-3
OUTPUT = {"type": "adhesive_curve", "work_of_adhesion": "0.5 mJ/m^2"}
DEPTHS = {"start": "2 um", "stop": "28 um", "num": 9, "spacing": "log"}
BEAD = bead(
    title="bead",
    grid={"points": 48, "size": "180 um"},
    kernel={"type": "tensed_membrane", "reduced_modulus": "1 kPa", "tension": 0.0},
    indenter={"type": "paraboloid", "radius": "0.2 mm"},
    loading={"depth": DEPTHS, "stiffness": True},
    outputs=[OUTPUT],
)
FORCE = pi * WORK * 0.2e-3
"""πwR [N]."""


def ran(folder: Path, **changed: Any) -> tuple[list[dict[str, str]], list[dict[str, str]]]:
    """Run the bead with changed parts; return the rows of the curve and of its summary."""
    configuration = BEAD | {key: {**BEAD[key], **value} for key, value in changed.items()}
    pl.run(configuration, directory=folder, progress=False, threads=1)
    names = "bead-adhesive_curve.csv", "bead-adhesive_curve-summary.csv"
    return rows(folder / names[0]), rows(folder / names[1])


def test_summary_and_curve_are_those_of_the_bead(tmp_path: Path) -> None:
    """On a grid of 48 cells pull-off is right to 0.03 πwR, and the lowest force of the curve."""
    curve, (summary,) = ran(tmp_path)
    assert summary["status"].startswith("contact radius in cells: pull-off 11.0, last at fixed")
    # The slope of a paraboloid at the rim is a/R.
    assert "slope of the indenter at the rim: no load 0.3" in summary["status"]
    pull_off = float(summary["pull_off_force [N]"])
    assert pull_off == pytest.approx(-1.5 * FORCE, abs=0.03 * FORCE)
    assert min(float(row["force [N]"]) for row in curve) == pytest.approx(pull_off, rel=1e-4)
    radius = (9 * pi * WORK * 0.2e-3**2 / 2 / 1e3) ** (1 / 3)
    assert float(summary["zero_load_radius [m]"]) == pytest.approx(radius, rel=0.01)
    assert (tmp_path / "bead-adhesive_curve.png").exists()


@pytest.mark.slow
def test_a_study_has_a_curve_for_each_value(tmp_path: Path) -> None:
    """Tension weakens pull-off, from 1.5 πwR towards πwR."""
    output = OUTPUT | {"by": "kernel.tension", "label": "{1e3 * kernel.tension}"}
    study = {"vary": {"kernel.tension": ["0 N/m", "20 mN/m"]}}
    configuration = BEAD | {"outputs": [output], "study": study}
    pl.run_study(configuration, directory=tmp_path, progress=False)
    summary = rows(tmp_path / "study-adhesive_curve-summary.csv")
    pulls = [-float(row["pull_off_force [N]"]) / FORCE for row in summary]
    assert [row["curve"] for row in summary] == ["0", "20"]
    assert 1.5 > pulls[0] - 0.03 > pulls[1] > 1
    assert {row["curve"] for row in rows(tmp_path / "study-adhesive_curve.csv")} == {"0", "20"}


def test_what_the_path_does_not_contain_is_unknown(tmp_path: Path) -> None:
    """A deep path has no pull-off, and its status says which radii it has."""
    deep = {"start": "20 um", "stop": "28 um", "num": 8}
    _, (summary,) = ran(tmp_path, loading={"depth": deep})
    assert isnan(float(summary["pull_off_force [N]"]))
    assert "pull-off" in summary["status"]
    assert "those of the path" in summary["status"]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"loading": {"depth": ["5 um", "10 um"], "stiffness": True}}, "2 steps.*at least 8"),
        (
            {"indenter": {"type": "sphere", "radius": "0.2 mm", "flat_radius": "20 um"}},
            "flat end of radius 1.98e-05 m holds .* begin at a smaller depth",
        ),
        (
            {"indenter": {"type": "quadric", "radius_x": "0.2 mm", "radius_y": "0.25 mm"}},
            "not a circle",
        ),
    ],
)
def test_why_there_is_no_curve_is_told_in_the_files(
    changed: dict[str, Any], message: str, tmp_path: Path
) -> None:
    """Interrupted runs have their files too, and the theory is for circles."""
    pl.run(BEAD | changed, directory=tmp_path, progress=False, threads=1)
    assert rows(tmp_path / "bead-adhesive_curve.csv") == []
    (summary,) = rows(tmp_path / "bead-adhesive_curve-summary.csv")
    assert re.search(message, summary["status"])


def test_a_path_with_adhesion_is_refused() -> None:
    """Adhesion would count twice."""
    result = pl.run(BEAD | {"loading": {"depth": "5 um"}, "outputs": []}, progress=False).dataset
    output = AdhesiveCurve(work_of_adhesion=WORK)
    with pytest.raises(ConfigError, match="interaction"):
        output.write(StoredRuns.of_run(result.assign_attrs(adheres=1)), Path("unwritten"))
