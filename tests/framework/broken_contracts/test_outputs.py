"""Outputs that break their contract at work are refused by name, before a result is wrong."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import pytest

import pellicle as pl
from tests.framework.broken_contracts.short_run import base, run, study

HalfSpace: Any = base("kernel", "half_space")


class Output(pl.Output):
    """Output that breaks its contract."""

    type: Literal["liar"] = "liar"

    def write(self, runs: Any, stem: Any) -> Any:
        """Write nothing."""
        return ()


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a folder of the test: outputs without a directory go to the current one."""
    monkeypatch.chdir(tmp_path)


def writes_pressure(data: Any) -> None:
    """Write to the pressure."""
    data["pressure"].values[...] = 0


def writes_status(data: Any) -> None:
    """Write to the text of the status."""
    data["status"].values[...] = "perfect"


def writes_coordinates(data: Any) -> None:
    """Write to the coordinates of the cells."""
    data["x"].values[...] = 0


def replaces_force(data: Any) -> None:
    """Replace a variable."""
    data["force"] = data["force"] * 2


def replaces_attributes(data: Any) -> None:
    """Replace the attributes, of the whole and of a variable."""
    data.attrs["configuration"] = "{}"
    data["force"].attrs["units"] = "kN"


CHANGES = [
    writes_pressure,
    writes_status,
    writes_coordinates,
    replaces_force,
    replaces_attributes,
]


@pytest.mark.parametrize("method", ["step", "write"])
@pytest.mark.parametrize("change", CHANGES)
def test_an_output_cannot_change_the_result(change: Any, method: str, tmp_path: Path) -> None:
    """What an output writes into its data reaches neither the result nor the outputs after it."""

    class Changing(Output):
        """Changes what it is given."""

        def step(self, record: Any, stem: Any) -> None:
            """Change a step."""
            if method == "step":
                change(record)

        def write(self, runs: Any, stem: Any) -> Any:
            """Change the result."""
            if method == "write":
                change(runs.open())
            return ()

    untouched = run().dataset
    configuration = pl.Run.from_json(untouched.attrs["configuration"])
    changed = configuration.model_copy(update={"outputs": (Changing(),)})
    refused = pytest.raises(pl.PluginError, match="output 'liar' changes what it is given")
    # Whether coordinates can be written to, and are copies then, depends on the version of pandas.
    with refused if change is writes_pressure else suppress(pl.PluginError):
        pl.run(changed, directory=tmp_path, progress=False, threads=1)
    (file,) = tmp_path.glob("*.h5")
    kept = pl.load(file).dataset
    for name in ("pressure", "status", "force"):
        np.testing.assert_array_equal(kept[name], untouched[name][: kept.sizes["step"]])
    np.testing.assert_array_equal(kept["x"], untouched["x"])
    assert kept["force"].attrs["units"] == "N"
    assert "half_space" in kept.attrs["configuration"]


def test_the_result_may_be_changed_by_its_owner() -> None:
    """Only outputs are given read-only arrays: a user may write into a result."""
    dataset = run(outputs=[Output()]).dataset
    dataset["pressure"].values[...] = 1
    assert (dataset["pressure"] == 1).all()


@pytest.mark.parametrize("returned", [None, "file.txt", ("file.txt",), 3, [None]])
def test_files_that_are_none_are_refused(returned: Any) -> None:
    """What write() returns are paths."""

    class Untrue(Output):
        """Names no files."""

        def write(self, runs: Any, stem: Any) -> Any:
            """Return anything but files."""
            return returned

    with pytest.raises(
        pl.PluginError, match=r"'liar': write\(runs, stem\) returned .* pathlib.Path"
    ):
        run(outputs=[Untrue()])


@pytest.mark.parametrize("name", ["other.txt", "../run-liar.txt", "run.txt"])
def test_files_of_another_stem_are_refused(name: str) -> None:
    """A file that does not begin with the stem may be that of another output or run."""

    class Astray(Output):
        """Returns a file that is not its own."""

        def write(self, runs: Any, stem: Any) -> Any:
            """Return a file of another name."""
            return (stem.parent / name,)

    with pytest.raises(pl.PluginError, match=r"returned .*; its files have to begin with the stem"):
        run(outputs=[Astray()])


@pytest.mark.parametrize("returned", [".txt", None, (1,)])
def test_suffixes_that_are_none_are_refused(returned: Any) -> None:
    """One text is not a tuple of texts: two outputs could replace each other's files unnoticed."""

    class Untrue(Output):
        """Forgets a comma."""

        @property
        def suffixes(self) -> Any:
            """Anything but a tuple of text."""
            return returned

    with pytest.raises(pl.PluginError, match=r"output 'liar': suffixes is"):
        run(outputs=[Untrue(), {"type": "csv"}])


@pytest.mark.parametrize("change", CHANGES[:1])
def test_an_output_cannot_change_the_table_of_a_study(change: Any, tmp_path: Path) -> None:
    """The table that run_study returns is that of the runs, whatever an output does to its own."""

    class Changing(Output):
        """Changes the table."""

        def write(self, runs: Any, stem: Any) -> Any:
            """Write to the forces."""
            runs.table["force"].values[...] = 0
            return ()

    with pytest.raises(pl.PluginError, match="output 'liar' changes what it is given"):
        pl.run_study(study(outputs=[Changing()]), tmp_path, progress=False, threads=1)


def test_each_output_gets_data_of_its_own(tmp_path: Path) -> None:
    """What one output leaves out or replaces in its dataset, the next one still has."""

    class Dropping(Output):
        """Drops the pressure and renames the run."""

        def write(self, runs: Any, stem: Any) -> Any:
            """Change the dataset itself, not its arrays."""
            del runs.open()["pressure"]
            runs.open().attrs["title"] = "another"
            return ()

    class Looking(pl.Output):
        """Looks at what it is given."""

        type: Literal["looking"] = "looking"
        seen: ClassVar[list[Any]] = []

        def write(self, runs: Any, stem: Any) -> Any:
            """Keep what is there."""
            data = runs.open()
            self.seen.append(("pressure" in data, data.attrs["title"]))
            return ()

    run(title="ours", outputs=[Dropping(), Looking()])
    assert Looking.seen == [(True, "ours")]


def test_a_file_system_that_is_read_only_is_no_lie() -> None:
    """What an output raises because it cannot write is not taken for a change of its data."""

    class Unlucky(Output):
        """Cannot write."""

        def write(self, runs: Any, stem: Any) -> Any:
            """Raise what the system raises."""
            raise OSError("the volume is read-only")

    with pytest.raises(OSError, match="the volume is read-only") as error:
        run(outputs=[Unlucky()])
    assert error.value.__notes__[0].startswith("output 'liar' failed")
