"""Commands name what is wrong, and say of it what the snapshot says."""

import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.framework.sentences.snapshot import FILE, Row, answer, fixed, prepare, rows, stored

STORED, ROWS = stored(), rows()
AGAIN = "if that is right: python tests/framework/sentences/snapshot.py, and read the difference"
JARGON = (
    "Traceback",
    "Input should",
    "validation",
    "Value error",
    "<str>",
    "list[",
    "<bool>",
    "<int",
)


@pytest.fixture(scope="module", autouse=True)
def _folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Run commands in a folder with their files."""
    folder, before = tmp_path_factory.mktemp("sentences"), Path.cwd()
    prepare(folder)
    os.chdir(folder)
    yield
    os.chdir(before)


@pytest.mark.parametrize(
    "row",
    [
        pytest.param(row, id=row.command[:60], marks=[pytest.mark.slow] if row.code < 1 else [])
        for row in ROWS
    ],
)
def test_answer(row: Row) -> None:
    """A command ends with its code, names the field, leaves nothing behind and says its words."""
    done = answer(row)
    assert done.code == row.code, done
    first, *others = done.stderr.splitlines() or [""]
    if row.named:
        named = re.escape(row.named)
        assert re.match(rf"(error|warning): '?{named}(?![\w.])", first), first
    if row.code:
        assert not done.stdout
        assert not Path("out").exists()
        assert all(line.startswith(("error: ", "  -")) for line in others)
        assert len(done.stderr) < 1500
    assert done.sentences == STORED[row.command], AGAIN


def test_statuses_and_help() -> None:
    """Statuses of steps and the help of each command are those of the snapshot."""
    for asked, said in fixed():
        assert STORED.get(asked) == said, AGAIN


def test_no_sentence_is_forgotten_or_speaks_of_python() -> None:
    """The snapshot holds what is asked and nothing else, without a word of the implementation."""
    assert [*STORED] == [*(row.command for row in ROWS), *(asked for asked, _ in fixed())]
    text = FILE.read_text(encoding="utf-8")
    assert [word for word in JARGON if word in text] == []
