"""An environment with strangers' packages, built and installed as their users would."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

HERE = Path(__file__).parent
PACKAGES = (
    *("third_party", "symbol_only", "one_output", "mean_gap", "quadratic_softening"),
    *("relaxing", "hertz"),
)
COMMAND_LINE = """
import json, os, sys
from typer.testing import CliRunner
from pellicle.cli.app import app

for line in sys.stdin:
    folder, arguments = json.loads(line)
    os.chdir(folder)
    done = CliRunner().invoke(app, arguments)
    print(json.dumps([done.exit_code, done.stdout, done.stderr]), flush=True)
"""
Command = Callable[..., subprocess.CompletedProcess[str]]


@contextmanager
def command_line(environment: dict[str, str]) -> Iterator[Command]:
    """Yield the command ``pellicle`` of an environment, whose first argument is its folder.

    All calls are in one process: loading the libraries takes twenty times as long as a command.
    """
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND_LINE],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        encoding="utf-8",
    )
    with process as server:
        assert server.stdin
        assert server.stdout
        answers, questions = server.stdout, server.stdin

        def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
            questions.write(json.dumps([str(folder), arguments]) + "\n")
            questions.flush()
            return subprocess.CompletedProcess(arguments, *json.loads(answers.readline()))

        yield run
        questions.close()
        assert server.wait(60) == 0


@pytest.fixture(scope="session")
def environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Return the environment of processes in which strangers' packages are installed."""
    site = tmp_path_factory.mktemp("site")
    install = [sys.executable, "-m", "pip", "install", "--no-deps", "--no-index", "--quiet"]
    sources = [HERE / source for source in PACKAGES]
    done = subprocess.run(
        [*install, "--no-build-isolation", f"--target={site}", *sources],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    inherited = {k: v for k, v in os.environ.items() if not k.startswith("PELLICLE_")}
    path = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    return inherited | {"PYTHONPATH": path, "PYTHONUTF8": "1"}


@pytest.fixture(scope="session")
def python(environment: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Command:
    """Return the interpreter of that environment."""

    def run(*arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments],
            env=environment | more,
            cwd=tmp_path_factory.mktemp("empty"),
            capture_output=True,
            encoding="utf-8",
            check=False,
        )

    return run


@pytest.fixture(scope="session")
def pellicle(
    environment: dict[str, str], python: Command, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Command]:
    """Return the command ``pellicle`` of that environment; other variables need a new process."""
    with command_line(environment) as here:

        def run(*arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
            if more:
                return python("-m", "pellicle", *arguments, **more)
            return here(tmp_path_factory.mktemp("empty"), *arguments)

        yield run
