"""Runs every code block of README.md and docs/*.md, page by page, as a reader would."""

import doctest
import importlib
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import pellicle as pl
from pellicle.cli.app import app
from pellicle.components import (
    AreaCorrection,
    Executor,
    Indenter,
    Interaction,
    Kernel,
    Output,
    Solver,
)
from pellicle.schema import ranges as axes
from tests.docs.blocks import DOCS, PAGES, ROOT, Block, blocks
from tests.shared_fits import share_fits

LANGUAGES = {"python", "pycon", "toml", "console", "sh"}
DIRECTIVES = {"{eval-rst}", "{include}", "{toctree}"}
EXEMPT = [
    "python3 -m venv .venv && .venv/bin/pip install . && "
    ".venv/bin/pellicle run docs/studies/indent.toml -o results",
    "python3 -m venv .venv && .venv/bin/pip install '.[test]' && .venv/bin/python -m pytest "
    "-n 2 --dist loadfile",
]
"""Set-up of a fresh machine: the packaging tests do that."""

_TABLES: dict[str, Any] = {
    "kernel": Kernel,
    "indenter": Indenter,
    "interaction": Interaction,
    "solver": Solver,
    "corrections": AreaCorrection,
    "outputs": Output,
    "executor": Executor,
}
_OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
_NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?"
_ONE_THREAD = 1


class Reader:
    """Someone who works through a page in a folder of their own."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.folder = folder
        self.monkeypatch = monkeypatch
        self.names: dict[str, Any] = {"__name__": "__main__"}
        self.lines_run: set[int] = set()

    def do(self, block: Block) -> None:
        if "file" in block.comments:
            (self.folder / block.comments["file"]).write_text(block.text, encoding="utf-8")
            self.forget()
        getattr(self, block.language)(block)

    def python(self, block: Block) -> None:
        """Execute a block in the namespace of its page."""
        code = compile(block.text, str(block), "exec", dont_inherit=True)
        if "untested" not in block.comments:
            exec(code, self.names)

    def pycon(self, block: Block) -> None:
        """Execute an interactive session and compare what it shows."""
        test = doctest.DocTestParser().get_doctest(block.text, {}, str(block), None, block.line)
        test.globs = self.names
        lines: list[str] = []
        runner = doctest.DocTestRunner(optionflags=_OPTIONS)
        runner.run(test, out=lines.append, clear_globs=False)
        assert not runner.summarize(verbose=False).failed, "".join(lines)

    def toml(self, block: Block) -> None:
        """Solve a complete run or study, unless a command does; check the tables of a part."""
        data = tomllib.loads(block.text)
        if block.line in self.lines_run:
            return
        if "project" in data:
            assert block.comments["file"] == "pyproject.toml"
        elif {"grid", "study"} <= data.keys():
            table = pl.run_study(data, progress=False, threads=_ONE_THREAD)
            assert table["converged"].all(), block
        elif "grid" in data:
            run = pl.Run(**data)
            result = pl.run(
                run, directory=self.folder / "toml", progress=False, threads=_ONE_THREAD
            )
            assert result.converged, block
        else:
            check_part(data)

    def sh(self, block: Block) -> None:
        """Check that a set-up is one of those that need no test here."""
        assert block.text.strip() in EXEMPT, f"{block}: not an exempt set-up"

    def console(self, block: Block) -> None:
        """Carry out commands and compare what they print."""
        commands = list(_commands(block.text))
        assert commands, f"{block}: no command; begin it with '$ '"
        for number, (command, expected) in enumerate(commands):
            wanted = int(block.comments.get("exit", 0)) if number == len(commands) - 1 else 0
            code, output = self.command(command, block.comments.get("run"))
            assert code == wanted, f"{block}: {command}: exit code {code}\n{output}"
            if expected:
                assert is_like(expected, output), (
                    f"{block}: {command}\nexpected:\n{expected}\ngot:\n{output}"
                )

    def command(self, command: str, override: str | None) -> tuple[int, str]:
        """Return the exit code and the output of a ``pellicle`` or ``pip install`` command."""
        words = shlex.split(command)
        environment: dict[str, str | None] = {}
        while "=" in words[0]:
            name, _, value = words.pop(0).partition("=")
            environment[name] = value
        if words == ["pip", "install", "-e", "."]:
            return self.install()
        assert words[0] == "pellicle", f"{command}: only pellicle and pip install -e . are run"
        target = None
        if ">" in words:
            at = words.index(">")
            target, words = words[at + 1], words[:at]
        if words[1] == "run":
            words += ["--threads", str(_ONE_THREAD)]
            if override:
                words += ["--set", override]
        self.forget()
        run = CliRunner().invoke(app, words[1:], prog_name="pellicle", env=environment)
        assert run.exception is None or isinstance(run.exception, SystemExit), run.exception
        if target:
            (self.folder / target).write_text(run.stdout, encoding="utf-8")
            return run.exit_code, run.stderr
        return run.exit_code, run.output

    def install(self) -> tuple[int, str]:
        """Install the package of the folder where this process finds it, its modules in place."""
        site = self.folder / "site"
        pip = [sys.executable, "-m", "pip", "install", "--no-deps", "--no-build-isolation"]
        done = subprocess.run(
            [*pip, "--quiet", "--disable-pip-version-check", "--target", str(site), "."],
            cwd=self.folder,
            capture_output=True,
            text=True,
            env={**os.environ, "PIP_NO_INDEX": "1"},
            check=False,
        )
        self.monkeypatch.syspath_prepend(str(site))
        self.monkeypatch.syspath_prepend(str(self.folder))
        self.forget()
        return done.returncode, done.stdout + done.stderr

    def forget(self) -> None:
        """Make the next look at the registry a fresh one, as a new process would."""
        for name, module in list(sys.modules.items()):
            if str(getattr(module, "__file__", None) or "").startswith(str(self.folder)):
                del sys.modules[name]
        for cached in self.folder.rglob("__pycache__"):
            for file in cached.iterdir():
                file.unlink()
        importlib.invalidate_caches()
        pl.registry.cache_clear()


def lines_run(page: list[Block]) -> set[int]:
    """Return the lines of the files of a page that one of its commands runs as they stand."""
    lines, latest = set(), {}
    for block in page:
        if name := block.comments.get("file"):
            latest[name] = block.line
        if block.language != "console" or {"run", "exit"} & block.comments.keys():
            continue
        for command, _ in _commands(block.text):
            words = shlex.split(command)
            if words[:2] == ["pellicle", "run"] and not {"--set", "--dry-run"} & set(words):
                lines |= {latest[word] for word in words if word in latest}
    return lines


def check_part(data: dict[str, Any]) -> None:
    """Check each table of a part of a run file against its own model."""
    for name, table in data.items():
        if name == "title":
            assert isinstance(table, str)
        elif name == "grid":
            pl.Grid(**table)
        elif name == "loading":
            pl.Loading(**table)
        elif name == "study":
            check_part({key: part for key, part in table.items() if key == "executor"})
            assert all(axes.expand(table.get("vary", {})).values())
        else:
            for entry in table if isinstance(table, list) else [table]:
                pl.registry().make(_TABLES[name], entry)


_MANY = 1000
"""Number from which whole ones are not counted but computed, and rounded."""


def is_like(expected: str, output: str) -> bool:
    """Whether an output is that of a page, but for what other machines and versions change.

    Where nothing is elided, numbers from 1000 on or with a point or an exponent may differ by 5 %;
    iterations, hashes, versions, times, and the order in which runs end, are left out of the
    comparison.
    """
    expected, output = (re.sub(r"(?m)^took .* s\n", "", text) for text in (expected, output))
    if doctest.OutputChecker().check_output(expected, output, _OPTIONS):
        return True
    if "..." in expected:
        return False
    parts = [_parts(text) for text in (expected, output)]
    return len(parts[0]) == len(parts[1]) and all(map(_is_near, *parts))


def _parts(text: str) -> list[str]:
    """Return the words and numbers of an output."""
    # Such a number is round-off.
    text = re.sub(r"\b\d(?:\.\d+)?e-1\d\b", "#", text)
    text = re.sub(r"^\[\d+/\d+\] ", "[n] ", text, flags=re.MULTILINE)
    text = re.sub(r"\b[0-9a-f]{8,}\b|\d{4}-\d\d-\d\dT[\d:+]+|\b\d+\.\d+\.\d+\b", "#", text)
    runs: list[str] = []
    rows: list[str] = []
    column, width = None, 0
    for line in text.splitlines():
        cells = re.split(r"\s{2,}", line.strip())
        if "iterations" in cells:
            column, width = cells.index("iterations"), len(cells)
        elif column is not None and len(cells) == width:
            cells[column] = "#"
        (runs if line.startswith("[n]") else rows).append(" ".join(cells))
    return re.findall(rf"{_NUMBER}|[^\s\d]+|\d", " ".join([*sorted(runs), *rows]))


def _is_near(expected: str, value: str) -> bool:
    """Whether two words are equal, or two numbers near enough."""
    if expected == value:
        return True
    numbers = re.fullmatch(_NUMBER, expected) and re.fullmatch(_NUMBER, value)
    are_rounded = numbers and (re.search("[.e]", expected + value) or abs(float(expected)) >= _MANY)
    return bool(are_rounded) and math.isclose(float(expected), float(value), rel_tol=0.05)


def _commands(text: str) -> Iterator[tuple[str, str]]:
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, _, expected = part.partition("\n")
        yield command, expected


@pytest.fixture
def reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Reader]:
    """Someone in a folder that holds nothing but the reference tables."""
    for table in (DOCS / "reference-data").glob("*.csv"):
        shutil.copy(table, tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PELLICLE_DISABLE_PLUGINS", raising=False)
    share_fits(monkeypatch)
    reader = Reader(tmp_path, monkeypatch)
    yield reader
    monkeypatch.undo()
    reader.forget()


@pytest.mark.parametrize(
    ("value", "like"), [("10.31 µm, 2", True), ("11.25 µm, 2", False), ("10.25 µm, 3", False)]
)
def test_outputs_are_compared(value: str, like: bool) -> None:
    """Another machine prints other digits; another answer is another output."""
    assert is_like("10.25 µm, 2", value) is like


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_page_runs(page: Path, reader: Reader) -> None:
    """Every block of a page works, in order, and prints what the page says."""
    reader.lines_run = lines_run(list(blocks(page)))
    for block in blocks(page):
        if block.language.partition(" ")[0] in DIRECTIVES:
            continue
        assert block.language in LANGUAGES, f"{block}: language {block.language!r} is not tested"
        try:
            reader.do(block)
        except Exception as error:
            error.add_note(f"in the block at {block}")
            raise


def test_readme_begins_with_the_two_set_up_commands() -> None:
    """The first two blocks of the README are one shell line each; no other set-up is exempt."""
    first, second, *rest = blocks(ROOT / "README.md")
    assert [first.text.strip(), second.text.strip()] == EXEMPT
    others = [*rest, *(block for page in PAGES[1:] for block in blocks(page))]
    assert not [str(block) for block in others if block.language == "sh"]


def test_study_of_the_readme_is_the_starter_file() -> None:
    """What the README runs is what ``pellicle new`` writes."""
    starter = Path(pl.__file__).parent / "examples" / "indent" / "indent.toml"
    assert (ROOT / "docs/studies/indent.toml").read_bytes() == starter.read_bytes()
