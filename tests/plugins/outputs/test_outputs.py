"""The files of each output."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.runs import solve as solving
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
        """Keep the number of the step."""
        self.seen.append((record["step"].item(), stem.name))

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        """Write nothing."""
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
