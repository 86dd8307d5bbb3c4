"""What ``pellicle new --plugin`` writes: a package for each family, installed, tested and run."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from pellicle.cli.scaffold import write_plugin
from pellicle.components import FAMILIES
from tests.packaging.conftest import Command, command_line


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return the folder of a package of each family."""
    parent = tmp_path_factory.mktemp("written")
    return {family: write_plugin(family, f"my-{family}", parent) for family in FAMILIES}


@pytest.fixture(scope="module")
def environment(
    folders: dict[str, Path], tmp_path_factory: pytest.TempPathFactory
) -> dict[str, str]:
    """Return the environment of processes in which all of them are installed."""
    site = tmp_path_factory.mktemp("site")
    install = [sys.executable, "-m", "pip", "install", "--no-deps", "--no-index"]
    done = subprocess.run(
        [*install, "--no-build-isolation", "--quiet", f"--target={site}", *folders.values()],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    inherited = {k: v for k, v in os.environ.items() if not k.startswith("PELLICLE_")}
    return inherited | {"PYTHONPATH": str(site), "PYTHONUTF8": "1"}


@pytest.fixture(scope="module")
def pellicle(environment: dict[str, str]) -> Iterator[Command]:
    """Return the command ``pellicle`` of that environment."""
    with command_line(environment) as command:
        yield command


@pytest.mark.slow
def test_packages_pass_their_own_tests(
    folders: dict[str, Path], environment: dict[str, str], tmp_path: Path
) -> None:
    """As they stand, without a change, with warnings as errors."""
    strict = ["-W", "error", "-p", "no:cacheprovider", "--import-mode=importlib"]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-rA", *strict, *map(str, folders.values())],
        env=environment,
        cwd=tmp_path,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stdout
    for family in FAMILIES:
        assert f"test_pellicle_my_{family}.py::test_keeps_its_contract" in done.stdout


def test_packages_are_listed(pellicle: Command, tmp_path: Path) -> None:
    """Each is found under its family with its name, its version and a sentence."""
    listing = json.loads(pellicle(tmp_path, "plugins", "--json").stdout)
    assert listing["broken"] == []
    mine = [entry for entry in listing["components"] if entry["origin"].startswith("pellicle-my-")]
    assert {(entry["family"], entry["type"]) for entry in mine} == {
        (family, f"my_{family}") for family in FAMILIES
    }
    assert all(entry["description"].endswith((".", ").")) for entry in mine)


@pytest.mark.parametrize("family", FAMILIES)
def test_example_runs(
    family: str, folders: dict[str, Path], pellicle: Command, tmp_path: Path
) -> None:
    """The file that comes with a package converges, with the component in its place."""
    example = folders[family] / f"my_{family}.toml"
    done = pellicle(tmp_path, "run", str(example), "-o", "out")
    assert done.returncode == 0, done.stderr
    assert any((tmp_path / "out").iterdir())


@pytest.mark.slow
def test_readme_and_code_are_filled_in(folders: dict[str, Path]) -> None:
    """No placeholder is left, and every file parses."""
    for folder in folders.values():
        files = sorted(folder.iterdir())
        assert len(files) == 5
        for file in files:
            text = file.read_text(encoding="utf-8")
            assert "$" not in text.replace("\n$ ", "\n"), file
            if file.suffix == ".py":
                compile(text, str(file), "exec")
