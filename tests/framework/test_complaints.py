"""What goes wrong at work, or would write one file twice, is told once and in words."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle.components import Output
from pellicle.components.installed import registry
from pellicle.config.file_names import refuse_shared_files
from pellicle_plugins.outputs.csv import Csv
from tests.command import call
from tests.tables_of_runs import half_space, paraboloid, pressing

RUN: dict[str, Any] = pressing(16, "1 mm", half_space("10 kPa"), paraboloid("1 mm"), depth="10 um")


class Silent(pl.Output):
    """Writes nothing, and might write files of these ends."""

    type: Literal["silent"] = "silent"
    ends: tuple[str, ...] = ("*",)

    @property
    def suffixes(self) -> tuple[str, ...]:
        return self.ends

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        return ()


class Named(Silent):
    """Has a name, by which its stem differs."""

    name: str = ""


class Plain(Silent):
    """Has the stem of the run."""

    shares_stem: ClassVar[bool] = True
    scope: ClassVar[Literal["run", "study", "both"]] = "run"


class OfStudies(Plain):
    """Shows studies too."""

    scope: ClassVar[Literal["run", "study", "both"]] = "both"


def make_output(type_: str, **fields: Any) -> Output:
    """Return a built-in output."""
    return registry().make(Output, {"type": type_, **fields})


@pytest.mark.parametrize(
    ("outputs", "message"),
    [
        (
            [make_output("maps", name="pressure"), make_output("figures")],
            r"^outputs\.1\.type: 'figures' would write NAME-pressure\.png, a file of outputs\.0 "
            r"\('maps'\); give it another name if it can have one, or leave it out$",
        ),
        (
            [make_output("figures"), make_output("curves", name="force")],
            r"^outputs\.1\.type: 'curves' would write NAME-force\.png, a file of outputs\.0",
        ),
        (
            [make_output("csv"), make_output("maps"), Plain(ends=("-more.txt", ".csv"))],
            r"^outputs\.2\.type: 'silent' would write NAME\.csv, a file of outputs\.0 \('csv'\)",
        ),
        (
            [make_output("curves", name="a", formats=["svg"]), make_output("profiles", name="A")],
            r"^outputs\.1\.type: 'profiles' would write NAME-a\.csv, a file of outputs\.0",
        ),
        (
            [Named(name="a"), Named(), Named(name="a")],
            r"^outputs\.2\.type: .* NAME-a\*, a file of outputs\.0",
        ),
    ],
)
def test_outputs_of_one_file_are_refused(outputs: list[Output], message: str) -> None:
    """The message has both outputs and the file."""
    with pytest.raises(pl.ConfigError, match=message):
        pl.Run(**RUN, outputs=outputs)


def test_outputs_that_share_no_file() -> None:
    """Every built-in output stands beside all others, and one type twice by name or by format."""
    fields = {"adhesive_curve": {"work_of_adhesion": 1.0}}
    every = [
        make_output(type_, **fields.get(type_, {})) for type_ in registry().components["output"]
    ]
    refuse_shared_files(
        [*every, make_output("maps", name="gap"), make_output("maps", formats=["pdf"]), Silent()]
    )


def test_the_table_of_a_study_is_not_replaced() -> None:
    """An output that may stand in a run is refused in a study whose own table it would replace."""
    run = RUN | {"outputs": [make_output("figures"), OfStudies(ends=(".csv",))]}
    pl.Run(**run)
    message = r"outputs\.1\.type: 'silent' would write NAME\.csv, a file of the table of the study"
    with pytest.raises(pl.ConfigError, match=message):
        pl.Study(run=run, vary={"indenter.radius": [1e-3, 2e-3]})


@pytest.mark.parametrize("end", [".h5", "*"])
def test_the_result_of_a_run_is_not_replaced(end: str) -> None:
    """Every run has a result file, so no output may write one of its name."""
    message = r"outputs\.1\.type: 'silent' would write NAME\.h5, a file of the result; give it"
    with pytest.raises(pl.ConfigError, match=message):
        pl.Run(**RUN, outputs=[make_output("figures"), Plain(ends=(end,))])


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (".csv", ".csv", True),
        ("-0003.vts", "-*.vts", True),
        ("-Gap.png", "-gap.png", True),
        ("-gap.csv", ".csv", False),
        ("-0003.vtk", "-*.vts", False),
    ],
)
def test_suffixes_are_compared(one: str, other: str, same: bool) -> None:
    """By the whole suffix, with * for anything and whatever the case."""
    outputs = [Plain(ends=(end,)) for end in (one, other)]
    with pytest.raises(pl.ConfigError, match="leave it out") if same else nullcontext():
        refuse_shared_files(outputs)


COARSE: dict[str, Any] = pressing(
    16, "0.4 mm", half_space("10 kPa"), paraboloid("1 mm"), depth="20 um"
)


class Raising(pl.Output):
    """Looks for what is not there."""

    type: Literal["raising"] = "raising"

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        return (Path(runs.table["nothing"].item()),)


def test_an_output_that_raises(tmp_path: Path) -> None:
    """The exception is its own, with a note; the outputs after it leave their files."""
    configuration = pl.Run(
        **COARSE, outputs=[Raising(), pl.registry().make(pl.Output, {"type": "csv"})]
    )
    with pytest.raises(KeyError) as caught:
        pl.run(configuration, directory=tmp_path, progress=False)
    (note,) = caught.value.__notes__
    assert note.startswith(f"output 'raising' failed ({__file__}, line ")
    assert pl.load(tmp_path / "run.h5").converged
    assert (tmp_path / "run.csv").is_file()


def test_the_command_has_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """There is no traceback on the command line."""

    def fail(*_: object) -> None:
        raise ValueError("boom")

    monkeypatch.setattr(Csv, "write", fail)
    (tmp_path / "a.toml").write_text(
        pl.Run(**COARSE, outputs=[{"type": "csv"}]).to_toml(), encoding="utf-8"
    )
    done = call("run", tmp_path / "a.toml", "-o", tmp_path / "a", code=2)
    assert "error: output 'csv' failed: ValueError: boom\n" in done.output


def test_coarse_steps_are_told_once(tmp_path: Path) -> None:
    """The table marks them, and one line says why."""
    configuration = pl.Run(**COARSE | {"loading": {"depth": ["1 nm", "2 nm", "20 um"]}}, outputs=[])
    (tmp_path / "a.toml").write_text(configuration.to_toml(), encoding="utf-8")
    done = call("run", tmp_path / "a.toml", "-o", tmp_path / "a")
    assert [line.split()[-1] for line in done.output.splitlines()[1:4]] == [
        "coarse",
        "coarse",
        "converged",
    ]
    assert done.output.count("too coarse for this contact") == 1
    assert "warning: step 1 and 1 more: converged, but the cells are too coarse" in done.output


def test_arguments_that_are_something_else(tmp_path: Path) -> None:
    """A type, a table, a study and a folder are answered with what is wanted."""
    kernel, grid = pl.kernel("half_space", reduced_modulus=1e4), pl.Grid(points=2, size=1.0)
    with pytest.raises(
        pl.ConfigError, match=r"kernel: 'half_space' is not a kernel; .*pellicle\.ker"
    ):
        pl.displacement([[1, 0], [0, 0]], kernel="half_space", grid=grid)  # type: ignore[arg-type]
    with pytest.raises(
        pl.ConfigError, match=r"grid: \{'points': 2\} is not a grid; .*pellicle\.Grid"
    ):
        pl.displacement([[1, 0], [0, 0]], kernel=kernel, grid={"points": 2})  # type: ignore[arg-type]
    masked = np.ma.masked_array(np.ones((2, 2)), [[True, False], [False, False]])
    with pytest.raises(pl.ConfigError, match="pressure: holds NaN, infinite or masked values"):
        pl.displacement(masked, kernel=kernel, grid=grid)
    with pytest.raises(pl.ConfigError, match="study: makes this a study: use run_study"):
        pl.run(COARSE | {"study": {"vary": {"indenter.radius": [1, 2]}}}, progress=False)
    study: Any = pl.Study(run=COARSE, vary={"indenter.radius": [1, 2]})
    with pytest.raises(pl.ConfigError, match=r"^Study.* is not a Run; give one, a table"):
        pl.run(study, progress=False)
    single: Any = study.points[0].run
    with pytest.raises(pl.ConfigError, match=r"^Run.* is not a Study; give one, a table"):
        pl.run_study(single, progress=False)
    with pytest.raises(pl.StorageError, match="is a folder that holds no result yet; run it first"):
        pl.load(tmp_path)


def test_any_title_makes_a_file_name(tmp_path: Path) -> None:
    """A title longer than a file name may be is cut, also in letters of several bytes."""
    pl.run(COARSE | {"title": "张力膜" * 80, "outputs": []}, directory=tmp_path, progress=False)
    (file,) = tmp_path.iterdir()
    assert pl.load(file).dataset.attrs["title"] == "张力膜" * 80
    assert file.name == f"{'张力膜' * 13}张.h5"
