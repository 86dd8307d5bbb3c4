"""Calls the command line in an empty folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pellicle.cli.app import app
from tests.framework.bad_input.command_line import Cli, Outcome
from tests.framework.sentences.bad_files import START


@pytest.fixture
def cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Cli:
    """Return a function that calls the command line in an empty folder."""
    monkeypatch.chdir(tmp_path)
    Path("start.toml").write_text(START, encoding="utf-8")

    def call(*arguments: object) -> Outcome:
        result = CliRunner().invoke(app, [str(argument) for argument in arguments])
        # Anything but an exit would be a traceback on the user's screen.
        assert result.exception is None or isinstance(result.exception, SystemExit)
        assert "Traceback" not in result.output
        return Outcome(result.exit_code, result.stdout, result.stderr)

    return call


@pytest.fixture
def refuse(cli: Cli) -> Callable[..., str]:
    """Return a function that runs the start file with changes that must be refused."""

    def call(*changes: str) -> str:
        options = [part for change in changes for part in ("--set", change)]
        outcome = cli("run", "start.toml", "-o", "out", *options)
        assert outcome.exit_code == 2
        assert outcome.stdout == ""
        assert not Path("out").exists()
        return outcome.message

    return call
