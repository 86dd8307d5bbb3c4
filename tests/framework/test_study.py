"""Studies carried out: the table, what is repeated and what is not, and what goes wrong."""

import itertools
import json
import os
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
import tomli_w
import xarray as xr

import pellicle as pl
from pellicle import memory
from pellicle.components import Monitor
from pellicle.results import StoredRuns, storage
from pellicle.results.dimensions import with_paths
from pellicle.show.sentences import reasons
from pellicle.studies import runner as study_module
from pellicle.studies.table import StudyTable, write
from pellicle_plugins.executors.execution import Serial
from pellicle_plugins.executors.processes import Processes
from tests import tables_of_runs
from tests.command import call

RUN = tables_of_runs.RUN | {"title": "Study"}

# Whatever the cells are worth, the numbers are to be the same.
pytestmark = pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
TENSION, RADIUS = "kernel.tension", "indenter.radius"
NUMBERS = ("depth", "force", "contact_area", "residual_contact", "iterations", "converged")


def tension_of(problem: pl.Problem) -> float:
    """Return the tension [N/m] of the skin."""
    q = np.array([1e12])
    return float(round(1 / (problem.operator.symbol(q, 0 * q) * q**2).item(), 6))


class Counting(pl.Solver):
    """Counts what it solves; fails where it is told to."""

    type: Literal["counting"] = "counting"
    solved: ClassVar[list[tuple[float, float]]] = []
    fails_at: ClassVar[Callable[[pl.Problem], Exception | None]] = lambda problem: None

    def solve(self, problem: pl.Problem, start: pl.State | None, monitor: Monitor) -> pl.Solution:
        if (error := type(self).fails_at(problem)) is not None:
            raise error
        self.solved.append((tension_of(problem), problem.value))
        return pl.solver("active_set").solve(problem, start, monitor)


@pytest.fixture(autouse=True)
def _nothing_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Counting, "solved", [])


def study(vary: dict[str, Any] | None = None, **others: Any) -> pl.Study:
    """Return a study whose solver counts."""
    run = RUN | {"solver": Counting()} | others
    return pl.Study(run=run, vary=vary or {TENSION: [0.0, 0.5], RADIUS: [1e-3, 2e-3]})


def carry_out(plan: pl.Study, directory: Path | None = None, **options: Any) -> xr.Dataset:
    """Return the table of a study, silently."""
    return pl.run_study(plan, directory, progress=False, threads=1, **options)


def same_numbers(one: xr.Dataset, other: xr.Dataset) -> None:
    """Fail unless two tables agree bit for bit, but for the time that the steps took."""
    for name in (*NUMBERS, "status", "run"):
        xr.testing.assert_equal(one[name], other[name])


@pytest.fixture(scope="module")
def undisturbed() -> xr.Dataset:
    """Return the table of a study that nothing happened to."""
    return carry_out(study())


def break_at(monkeypatch: pytest.MonkeyPatch, tension: float, depth: float) -> None:
    """Have one step of the runs of one tension fail."""

    def fails(problem: pl.Problem) -> Exception | None:
        here = tension_of(problem) == tension and problem.value == depth
        return ZeroDivisionError("struck by lightning") if here else None

    monkeypatch.setattr(Counting, "fails_at", staticmethod(fails))


def test_table_is_that_of_its_runs() -> None:
    """Each entry of the table is what the run on its own gives."""
    plan = study()
    table = carry_out(plan)
    assert dict(table.sizes) == {"kernel_tension": 2, "indenter_radius": 2, "step": 3}
    for point in plan.points:
        alone = pl.run(point.run, progress=False, threads=1).dataset
        row = table.isel(kernel_tension=point.position[0], indenter_radius=point.position[1])
        assert row[TENSION] == point.run.kernel.model_dump()["tension"]
        for name in NUMBERS:
            assert (row[name].values == alone[name].values).all()
        assert row["run"].item() == point.run.identity[:16]
    assert table[TENSION].attrs["units"] == "N/m"
    assert table["force"].attrs["units"] == "N"
    recorded = json.loads(table.attrs["configuration"]) | {"solver": {"type": "active_set"}}
    assert pl.Study.from_json(json.dumps(recorded)) == study(solver={"type": "active_set"})


def test_a_parameter_is_selected_by_a_name_or_its_path(tmp_path: Path) -> None:
    """Dimensions have names of Python, also in the file; a dotted path still finds its values."""
    zipped = [{RADIUS: [1e-3, 2e-3], "grid.size": [4e-4, 8e-4]}]
    plan = pl.Study(run=RUN, vary={TENSION: [0.0, 1.0]}, zip=zipped)
    table = carry_out(plan, tmp_path)
    assert table["force"].dims == ("kernel_tension", "indenter_radius", "step")
    chosen = table.sel(kernel_tension=1.0, grid_size=8e-4)
    assert chosen["run"].item() == table["run"].values[1, 1]
    assert table.sel({TENSION: 1.0})["run"].values.tolist() == table["run"].values[1].tolist()
    assert table[RADIUS].values.tolist() == table["indenter_radius"].values.tolist()
    assert table["grid_size"].attrs["parameter"] == "grid.size"
    assert table["kernel_tension"].attrs["units"] == "N/m"
    with xr.open_dataset(tmp_path / "study.h5", engine="h5netcdf") as stored:
        assert stored["force"].dims == table["force"].dims
        assert stored.sel(kernel_tension=1.0).sizes == {"indenter_radius": 2, "step": 3}
    assert StoredRuns.of_study(table, tmp_path).table["force"].dims == (TENSION, RADIUS, "step")


def test_files(tmp_path: Path) -> None:
    """The folder holds a result for each run, the table, and no trace of the work."""
    table = carry_out(study(), tmp_path)
    names = {f"{name}.h5" for name in table["run"].values.ravel()}
    assert {path.name for path in (tmp_path / "runs").iterdir()} == names
    visible = {path.name for path in tmp_path.iterdir() if path.name[0] != "."}
    assert visible == {"runs", "study.h5", "study.csv"}
    with xr.open_dataset(tmp_path / "study.h5", engine="h5netcdf") as stored:
        same_numbers(stored.load(), table)
    lines = (tmp_path / "study.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + table["force"].size
    assert lines[0].startswith(
        "run,kernel.tension [N/m],indenter.radius [m],step,depth [m],force [N]"
    )
    assert float(lines[-1].split(",")[5]) == table["force"].values.ravel()[-1]


def test_finished_study_repeats_nothing(tmp_path: Path) -> None:
    """A finished study solves nothing again, and says the same."""
    table = carry_out(study(), tmp_path)
    assert len(Counting.solved) == table["force"].size
    Counting.solved.clear()
    same_numbers(carry_out(study(), tmp_path), table)
    assert Counting.solved == []


def test_changed_axis_runs_only_the_new_points(tmp_path: Path) -> None:
    """Another value, another order or a finer axis repeats no run that is there."""
    carry_out(study({TENSION: [0.0, 0.5]}), tmp_path)
    Counting.solved.clear()
    table = carry_out(study({TENSION: [1.0, 0.5, 0.0]}), tmp_path)
    assert {tension for tension, _ in Counting.solved} == {1.0}
    assert table["converged"].values.all()
    assert table[TENSION].values.tolist() == [1.0, 0.5, 0.0]


def test_failing_run_stops_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that fails has its reason in the table, and is all that is tried again."""
    break_at(monkeypatch, 0.5, 1e-5)
    with pytest.warns(pl.ConvergenceWarning, match="of 3 runs 1 failed; see status"):
        table = carry_out(study({TENSION: [0.0, 0.5, 1.0]}), tmp_path, overwrite=True)
    bad = table.sel({TENSION: 0.5})
    assert bad["status"].values.tolist() == [
        "converged",
        *["failed: ZeroDivisionError: struck by lightning"] * 2,
    ]
    assert np.isfinite(bad["force"].values).tolist() == [True, False, False]
    assert bad["converged"].values.tolist() == [True, False, False]
    assert table.sel({TENSION: [0.0, 1.0]})["converged"].values.all()
    shown = call("show", tmp_path, code=1)
    assert "struck by lightning" in shown.stderr
    monkeypatch.undo()
    monkeypatch.setattr(Counting, "solved", [])
    again = carry_out(study({TENSION: [0.0, 0.5, 1.0]}), tmp_path)
    # Its first step was there.
    assert Counting.solved == [(0.5, 1e-5), (0.5, 1.5e-5)]
    same_numbers(again, carry_out(study({TENSION: [0.0, 0.5, 1.0]})))


def test_a_failure_after_an_unconverged_step_has_its_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A run that did not converge and later failed is told with both reasons."""
    break_at(monkeypatch, 0.0, 7e-5)
    deep = {"depth": ["5 um", "60 um", "70 um"]}
    with pytest.warns(pl.ConvergenceWarning, match="of 1 runs 1 failed, 1 did not converge"):
        table = carry_out(study({TENSION: [0.0]}, loading=deep))
    edge, failure = reasons(with_paths(table))
    assert "reaches the edge" in edge
    assert "failed: ZeroDivisionError: struck by lightning" in failure


def test_runs_of_unequal_length() -> None:
    """Runs with fewer steps have none in the rest of the table, and lack nothing."""
    table = carry_out(study({"loading.depth": [["10 um"], ["10 um", "15 um"]]}))
    assert table["status"].values.tolist() == [["converged", ""], ["converged", "converged"]]
    assert np.isnan(table["force"].values[0, 1])


def test_what_runs_warn_of_is_said_once(tmp_path: Path) -> None:
    """Warnings of all runs come as one line each, with how many are too coarse."""
    ramp = np.add.outer(np.linspace(0, 1, 16), np.linspace(0, 1, 16))
    plan = study(
        grid={"points": 16, "size": "0.4 mm", "boundary": "periodic"},
        indenter=pl.indenter("heights", values=ramp, unit="1 um"),
        loading={"depth": "1 pm"},
        vary={TENSION: [0.0, 0.5]},
    )
    with warnings.catch_warnings(record=True) as records:
        warnings.simplefilter("always")
        pl.run_study(plan, tmp_path, progress=False)
    coarse, along_x, along_y = sorted(str(entry.message) for entry in records)
    name = "surface tension 0 mN/m (file "
    assert coarse.startswith(f"of 2 runs, in 2 the cells are too coarse for this contact; {name}")
    assert "step 1: converged, but" in coarse
    assert along_x.startswith("the surface is not periodic along x")
    assert along_y.startswith("the surface is not periodic along y")


def test_corrections_that_vary() -> None:
    """An area and a fraction that only some runs have are NaN in the others."""
    table = carry_out(study({"corrections": [[], [{"type": "yastrebov"}]]}))
    area = table["contact_area_yastrebov"].values
    assert np.isnan(area[0]).all()
    assert (area[1] > 0).all()
    size = json.loads(table.attrs["first_run"])["grid"]["size"]
    fraction = table["contact_fraction_yastrebov"].values
    np.testing.assert_allclose(fraction[1] * np.prod(size), area[1], rtol=1e-15)
    assert np.isnan(fraction[0]).all()


# In mid-run, between two runs, and before the last step of all.
@pytest.mark.slow
@pytest.mark.parametrize("after", [2, 6, 11])
def test_interrupted(
    after: int, undisturbed: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C keeps every finished step, in runs and table, and the same command goes on."""
    presses = iter(range(100))

    def press(problem: pl.Problem) -> None:
        if next(presses) == after:
            raise KeyboardInterrupt

    monkeypatch.setattr(Counting, "fails_at", staticmethod(press))
    with pytest.raises(KeyboardInterrupt):
        carry_out(study(), tmp_path)
    kept, _ = study_module.read(tmp_path)
    assert np.isfinite(kept["force"].values).sum() == after
    assert (kept["status"] == "not run").sum() == kept["force"].size - after
    assert len(Counting.solved) == after
    table = carry_out(study(), tmp_path)
    assert len(Counting.solved) == kept["force"].size
    same_numbers(table, undisturbed)


def test_a_study_is_not_loaded_as_a_result(tmp_path: Path) -> None:
    """What `load` is given is called a study, finished or not, with what reads it."""
    plan = study()
    write(StudyTable(plan).dataset(), tmp_path)
    for path in (tmp_path, tmp_path / "study.h5"):
        with pytest.raises(pl.StorageError, match=r"table of a study, not.*run_study.*runs/"):
            pl.load(path)


# From none to nearly all of the files that a study leaves.
@pytest.mark.parametrize("files", [0, 3, 13])
def test_full_disk(files: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that fills up ends the study with a message; what was finished is whole and counts."""
    plain, written = os.fsync, itertools.count()

    def fsync(descriptor: int) -> None:
        if next(written) >= files:
            raise OSError(28, "No space left on device")
        plain(descriptor)

    monkeypatch.setattr("os.fsync", fsync)
    with pytest.raises(pl.StorageError, match=r"study\..*No space left on device.*another folder"):
        carry_out(study(), tmp_path)
    before = len(Counting.solved)
    results = {path.name: storage.read(path) for path in (tmp_path / "runs").glob("*.h5")}
    steps = sum(data.sizes["step"] for data in results.values())
    # No more than the step whose file did not fit is lost.
    assert before - steps <= 1
    assert not list(tmp_path.rglob(".*.part"))
    monkeypatch.undo()
    monkeypatch.setattr(Counting, "solved", [])
    table = carry_out(study(), tmp_path)
    assert len(Counting.solved) == table["force"].size - steps
    assert table["converged"].values.all()


def test_folder_that_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A read-only folder is named before anything is solved."""

    def refuse(*arguments: object, **options: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    with pytest.raises(pl.StorageError, match=r"cannot be written \(Permission denied\)"):
        carry_out(study(), tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(pl.StorageError, match="cannot be written"):
        carry_out(study(), tmp_path / "file" / "folder")
    assert Counting.solved == []


@pytest.mark.slow
def test_damaged_run_file(tmp_path: Path) -> None:
    """A damaged result fails its own run, with what to do, and is left as it is."""
    table = carry_out(study(), tmp_path)
    path = tmp_path / "runs" / f"{table['run'].values[1, 0]}.h5"
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    Counting.solved.clear()
    with pytest.warns(pl.ConvergenceWarning, match="of 4 runs 1 failed"):
        again = carry_out(study(), tmp_path)
    assert Counting.solved == []
    status = again["status"].values[1, 0, 0]
    assert status.startswith("failed: ")
    assert "not a readable result file" in status
    assert "--overwrite" in status
    assert path.read_bytes() == content[: len(content) // 2]
    path.unlink()
    same_numbers(carry_out(study(), tmp_path), table)
    assert len(Counting.solved) == 3


def test_foreign_table(tmp_path: Path) -> None:
    """A file in the place of the table that is none is not replaced unless it may be."""
    (tmp_path / "study.h5").write_text("mine")
    with pytest.raises(pl.StorageError, match=r"study\.h5: not a readable.*--overwrite"):
        carry_out(study(), tmp_path)
    assert (tmp_path / "study.h5").read_text() == "mine"
    assert Counting.solved == []
    carry_out(study(), tmp_path, overwrite=True)


def test_left_overs_of_the_dead_are_swept(tmp_path: Path) -> None:
    """Half-written files of a process that was killed go when their file is written anew."""
    part = tmp_path / ".study.h5.elsewhere.1.part"
    part.touch()
    carry_out(study(), tmp_path)
    assert not part.exists()


class Listing(pl.Output):
    """Names each run that it is called for."""

    type: Literal["listing"] = "listing"
    scope: ClassVar[Literal["run", "study", "both"]] = "run"

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        path = Path(f"{stem}.txt")
        path.write_text(f"{runs.table['force'].max().item()}", encoding="utf-8")
        return (path,)


class Summary(Listing):
    """Leaves one file for the study, and for a run that stands alone."""

    type: Literal["summary"] = "summary"  # type: ignore[assignment]
    scope: ClassVar[Literal["run", "study", "both"]] = "both"


class OfStudies(Listing):
    """Leaves one file for a study only."""

    type: Literal["of_studies"] = "of_studies"  # type: ignore[assignment]
    scope: ClassVar[Literal["run", "study", "both"]] = "study"


def test_outputs_of_runs_and_of_the_study(tmp_path: Path) -> None:
    """An output of scope run is called by each run, any other once."""
    outputs = [Listing(), Summary(), OfStudies()]
    table = carry_out(study(outputs=outputs), tmp_path)
    texts = {path.name for path in tmp_path.rglob("*.txt")}
    names = {f"{name}-listing.txt" for name in table["run"].values.ravel()}
    assert texts == {"study-summary.txt", "study-of_studies.txt", *names}
    highest = float((tmp_path / "study-summary.txt").read_text())
    assert highest == table["force"].max().item()
    pl.run(RUN | {"outputs": outputs}, directory=tmp_path / "run", progress=False)
    texts = {path.name for path in (tmp_path / "run").glob("*.txt")}
    assert texts == {"study-listing.txt", "study-summary.txt"}


def test_studies_in_threads_leave_warnings_to_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a process warns of after studies that ran at the same time is shown."""
    shown: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        monkeypatch.setattr(warnings, "showwarning", lambda message, *_: shown.append(str(message)))
        first, second = (study_module._recorded_warnings() for _ in range(2))
        first.__enter__()
        second.__enter__()
        first.__exit__(None, None, None)
        second.__exit__(None, None, None)
        warnings.warn("to be seen", stacklevel=1)
        assert shown == ["to be seen"]
        monkeypatch.undo()


TWELVE = {TENSION: np.linspace(0.0, 1.1, 12).tolist()}


LONG, SHORT = [5.0] * 12, [0.05] * 12


@pytest.mark.parametrize(
    ("here", "pace", "others"),
    [
        (1, LONG, {}),
        (12, SHORT, {}),
        (4, [*SHORT[:3], *LONG[3:]], {}),
        (12, LONG, {"cores": 1}),
        (12, LONG, {"threads": 2}),
        (12, LONG, {"room": 3e8}),
        (12, LONG, {"parent": object()}),
        (12, LONG, {"executor": {"type": "serial"}}),
        (0, SHORT, {"executor": {"type": "processes"}}),
    ],
)
def test_long_runs_go_to_processes(
    here: int,
    pace: list[float],
    others: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Runs that would take more than 10 s here are shared, unless that gains nothing."""
    clock, shared = 0.0, []

    def processes(self: Processes, work: Any, tasks: list[Any], report: Any) -> Iterator[Any]:
        shared.extend(tasks)
        return Serial().map(work, tasks, report)

    def solve(task: study_module.RunTask, say: Any, threads: int | None) -> xr.Dataset:
        nonlocal clock
        clock += pace[task.index[0]]
        return solved.copy()

    solved = pl.run(RUN, progress=False).dataset.drop_dims(["x", "y"]).assign_attrs(warnings=[])
    monkeypatch.setattr(study_module, "solve", solve)
    monkeypatch.setattr(study_module, "time", SimpleNamespace(monotonic=lambda: clock))
    monkeypatch.setattr(Processes, "map", processes)
    monkeypatch.setattr("pellicle.runs.runner.available_cores", lambda: others.get("cores", 2))
    monkeypatch.setattr(memory, "available", lambda: others.get("room", 1e10))
    monkeypatch.setattr(study_module, "parent_process", lambda: others.get("parent"))
    table = pl.run_study(
        pl.Study(run=RUN, vary=TWELVE, executor=others.get("executor")),
        threads=others.get("threads"),
    )
    assert table["converged"].all()
    assert len(shared) == 12 - here
    told = capfd.readouterr().err.count("go to processes")
    assert told == (len(shared) > 0 and "executor" not in others)


@pytest.mark.parametrize("part", [[], ["--part", "1/1"]])
@pytest.mark.parametrize("given", [[], ["--threads", "3"]])
def test_threads_that_are_given_are_those_of_the_executor(
    part: list[str], given: list[str], cli: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It places runs by the number of threads that they take."""
    threads = []

    def processes(self: Processes, work: Any, tasks: list[Any], report: Any) -> Iterator[Any]:
        threads.append((self.threads, work.keywords["threads"]))
        return Serial().map(work, tasks, report)

    monkeypatch.setattr(Processes, "map", processes)
    study = {"vary": {TENSION: [0.1, 0.5]}, "executor": {"type": "processes", "threads": 2}}
    Path("s.toml").write_text(tomli_w.dumps(RUN | {"study": study}), encoding="utf-8")
    cli("run", "s.toml", "--quiet", *given, *part)
    assert {*threads} == {(3, 3) if given else (2, 2)}


def test_an_unfinished_table_is_completed_as_it_is_read(tmp_path: Path) -> None:
    """Steps that a kill left out of the table, and those in tails, are read from the runs."""
    plan = pl.Study(run=RUN, vary={TENSION: [0.1, 0.5]}, derived={"twice": "2 * depth"})
    whole = carry_out(plan, tmp_path)
    date = xr.load_dataset(tmp_path / "study.h5", engine="h5netcdf").attrs["date"]
    StudyTable(plan).write(tmp_path, at_once=True)
    first, second = sorted((tmp_path / "runs").glob("*.h5"))
    steps = [pl.load(first).dataset.isel(step=[index]) for index in range(2)]
    names = [name for name, column in steps[0].data_vars.items() if "step" in column.dims]
    storage.write(steps[0][names], first)
    storage.append(steps[1][names], first)
    second.unlink()
    table, folder = study_module.read(tmp_path)
    assert folder == tmp_path
    done = (table["status_code"].values == "CONVERGED").sum(axis=-1)
    assert sorted(done.tolist()) == [0, 2]
    at = int(done.argmax())
    for name in ("force", "depth", "twice"):
        np.testing.assert_array_equal(table[name].values[at, :2], whole[name].values[at, :2])
    assert table.attrs["date"] >= date
