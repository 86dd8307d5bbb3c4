"""What goes wrong at work, or with arguments, is told once and in words."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle_plugins.outputs.csv import Csv
from tests.command import call

RUN: dict[str, Any] = {
    "grid": {"points": 16, "size": "0.4 mm"},
    "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": "20 um"},
}


class Raising(pl.Output):
    """Looks for what is not there."""

    type: Literal["raising"] = "raising"

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        """Fail."""
        return (Path(runs.table["nothing"].item()),)


def test_an_output_that_raises(tmp_path: Path) -> None:
    """The exception is its own, with a note; the outputs after it leave their files."""
    configuration = pl.Run(
        **RUN, outputs=[Raising(), pl.registry().make(pl.Output, {"type": "csv"})]
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
        pl.Run(**RUN, outputs=[{"type": "csv"}]).to_toml(), encoding="utf-8"
    )
    done = call("run", tmp_path / "a.toml", "-o", tmp_path / "a", code=2)
    assert "error: output 'csv' failed: ValueError: boom\n" in done.output


def test_coarse_steps_are_told_once(tmp_path: Path) -> None:
    """The table marks them, and one line says why."""
    configuration = pl.Run(**RUN | {"loading": {"depth": ["1 nm", "2 nm", "20 um"]}}, outputs=[])
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
        pl.run(RUN | {"study": {"vary": {"indenter.radius": [1, 2]}}}, progress=False)
    study: Any = pl.Study(run=RUN, vary={"indenter.radius": [1, 2]})
    with pytest.raises(pl.ConfigError, match=r"^Study.* is not a Run; give one, a table"):
        pl.run(study, progress=False)
    single: Any = study.points[0].run
    with pytest.raises(pl.ConfigError, match=r"^Run.* is not a Study; give one, a table"):
        pl.run_study(single, progress=False)
    with pytest.raises(pl.StorageError, match="is a folder that holds no result yet; run it first"):
        pl.load(tmp_path)


def test_any_title_makes_a_file_name(tmp_path: Path) -> None:
    """A title longer than a file name may be is cut, also in letters of several bytes."""
    pl.run(RUN | {"title": "张力膜" * 80, "outputs": []}, directory=tmp_path, progress=False)
    (file,) = tmp_path.iterdir()
    assert pl.load(file).dataset.attrs["title"] == "张力膜" * 80
    assert file.name == f"{'张力膜' * 13}张.h5"
