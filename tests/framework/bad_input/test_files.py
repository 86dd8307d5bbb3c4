"""A file that cannot be written: found out early, and nothing that exists is lost."""

from __future__ import annotations

from pathlib import Path

import pytest

import pellicle as pl
from tests.command import Cli
from tests.framework.bad_input.command_line import says


@pytest.mark.parametrize("type_", ["csv", "figures"])
def test_output_folder_that_cannot_be_written(
    cli: Cli, monkeypatch: pytest.MonkeyPatch, type_: str
) -> None:
    """A file where the output folder should be is found out before anything is solved."""
    Path("out").write_text("in the way", encoding="utf-8")

    def fail(*arguments: object) -> None:
        raise AssertionError("solved in vain")

    monkeypatch.setattr("pellicle.runs.solve.solve_step", fail)
    outputs = f"outputs=[{{type='{type_}'}}]"
    outcome = cli("run", "start.toml", "-o", "out", "--set", outputs, code=2)
    says(outcome.stderr, "out/start", "cannot be written", "choose another folder")
    assert Path("out").read_text(encoding="utf-8") == "in the way"


def test_result_of_another_configuration(cli: Cli) -> None:
    """A result is replaced by that of another configuration only when asked."""
    cli("run", "start.toml", "-o", "out")
    before = Path("out/start.h5").read_bytes()
    other = ["run", "start.toml", "-o", "out", "--set", "loading.depth='5 um'"]
    outcome = cli(*other, code=2)
    says(outcome.stderr, "out/start.h5 holds the result of another configuration", "--overwrite")
    assert Path("out/start.h5").read_bytes() == before
    cli(*other, "--overwrite")
    assert pl.load("out/start.h5").dataset["depth"].values == pytest.approx([5e-6])


def test_figures_that_cannot_be_written(cli: Cli) -> None:
    """A file in place of the folder for figures is named."""
    cli("run", "start.toml", "-o", "out", "--quiet")
    outcome = cli("plot", "out/start.h5", "-o", "start.toml", code=2)
    says(outcome.stderr, "start.toml/start-pressure.png: cannot be written", "another folder")
