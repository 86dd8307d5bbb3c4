"""An environment with strangers' packages, built and installed as their users would."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

HERE = Path(__file__).parent
PACKAGES = (
    *("third_party", "symbol_only", "one_output", "mean_gap", "quadratic_softening"),
    "relaxing",
)
Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def python(tmp_path_factory: pytest.TempPathFactory) -> Command:
    """Return the interpreter of an environment in which strangers' packages are installed."""
    wheels, site = tmp_path_factory.mktemp("wheels"), tmp_path_factory.mktemp("site")
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", f"--outdir={wheels}"]
    for source in PACKAGES:
        subprocess.run([*build, HERE / source], check=True, capture_output=True)
    install = [sys.executable, "-m", "pip", "install", "--no-deps", "--no-index"]
    subprocess.run(
        [*install, f"--target={site}", *wheels.iterdir()], check=True, capture_output=True
    )
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PELLICLE_")}
    path = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])

    def run(*arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments],
            env=environment | {"PYTHONPATH": path, "PYTHONUTF8": "1"} | more,
            cwd=tmp_path_factory.mktemp("empty"),
            capture_output=True,
            encoding="utf-8",
            check=False,
        )

    return run


@pytest.fixture(scope="session")
def pellicle(python: Command) -> Command:
    """Return the command ``pellicle`` of that environment."""
    return partial(python, "-m", "pellicle")
