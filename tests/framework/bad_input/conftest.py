"""Calls the command line in a folder with a run file, and how a message reads."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.command import Cli
from tests.framework.sentences.bad_files import START


@pytest.fixture
def cli(cli: Cli) -> Cli:
    """Return a function that calls the command line in a folder with a run file."""
    Path("start.toml").write_text(START, encoding="utf-8")
    return cli


@pytest.fixture
def refuse(cli: Cli) -> Callable[..., str]:
    """Return a function that runs the start file with changes that must be refused."""

    def refused(*changes: str) -> str:
        options = [part for change in changes for part in ("--set", change)]
        outcome = cli("run", "start.toml", "-o", "out", *options, code=2)
        assert outcome.stdout == ""
        assert not Path("out").exists()
        return outcome.stderr

    return refused


def says(message: str, *words: str) -> None:
    """Check that a message holds all words and none of pydantic's."""
    for word in words:
        assert word in message, f"{word!r} is not in: {message}"
    assert "Input should" not in message
    assert "validation" not in message
