"""What ``pellicle new --plugin`` writes: a package for each family, installed, tested and run."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from pellicle.cli.scaffold import write_plugin
from pellicle.components import FAMILIES


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


def call(
    environment: dict[str, str], folder: Path, *arguments: str
) -> subprocess.CompletedProcess[str]:
    """Return what a Python process said."""
    return subprocess.run(
        [sys.executable, "-m", *arguments],
        env=environment,
        cwd=folder,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )


def test_packages_pass_their_own_tests(
    folders: dict[str, Path], environment: dict[str, str], tmp_path: Path
) -> None:
    """As they stand, without a change, with warnings as errors."""
    strict = ["-W", "error", "-p", "no:cacheprovider", "--import-mode=importlib"]
    done = call(environment, tmp_path, "pytest", "-q", "-rA", *strict, *map(str, folders.values()))
    assert done.returncode == 0, done.stdout
    for family in FAMILIES:
        assert f"test_pellicle_my_{family}.py::test_keeps_its_contract" in done.stdout


def test_packages_are_listed(environment: dict[str, str], tmp_path: Path) -> None:
    """Each is found under its family with its name, its version and a sentence."""
    listing = json.loads(call(environment, tmp_path, "pellicle", "plugins", "--json").stdout)
    assert listing["broken"] == []
    mine = [entry for entry in listing["components"] if entry["origin"].startswith("pellicle-my-")]
    assert {(entry["family"], entry["type"]) for entry in mine} == {
        (family, f"my_{family}") for family in FAMILIES
    }
    assert all(entry["description"].endswith((".", ").")) for entry in mine)


@pytest.mark.parametrize("family", FAMILIES)
def test_example_runs(
    family: str, folders: dict[str, Path], environment: dict[str, str], tmp_path: Path
) -> None:
    """The file that comes with a package converges, with the component in its place."""
    example = folders[family] / f"my_{family}.toml"
    done = call(environment, tmp_path, "pellicle", "run", str(example), "-o", "out")
    assert done.returncode == 0, done.stderr
    assert any((tmp_path / "out").iterdir())


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
