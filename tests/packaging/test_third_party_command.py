"""A stranger's command: built, installed and called as its users would."""

import json
from pathlib import Path

import pytest

from tests.packaging.conftest import Command


def test_is_listed_beside_our_own(pellicle: Command) -> None:
    """Help has its first line; the list of plugins its origin and version."""
    assert "Print the force on a rigid sphere" in pellicle("--help").stdout
    listing = json.loads(pellicle("plugins", "--json").stdout)
    assert {
        "family": "command",
        "type": "hertz",
        "origin": "pellicle-hertz",
        "version": "0.3.0",
        "description": "Print the force on a rigid sphere in an elastic half-space.",
    } in listing["components"]
    assert listing["broken"] == []


def test_its_example_runs(pellicle: Command, tmp_path: Path) -> None:
    """The example is found in its package, and what is beside it is named after it."""
    file = tmp_path / "mine.toml"
    done = pellicle("new", "--example", "bead", str(file))
    assert done.stdout == f"wrote {file}; next: pellicle hertz {file}\n"
    assert {path.name for path in tmp_path.iterdir()} == {"mine.toml", "mine-image.txt"}
    assert "measured in mine-image.txt" in file.read_text(encoding="utf-8")
    # 4/3 · 2 kPa · √(5 µm) · (0.5 µm)^(3/2)
    assert pellicle("hertz", str(file)).stdout == "2.108 nN\n"


def test_the_model_of_its_file_explains_it(pellicle: Command) -> None:
    """Fields, an example and a schema; words for what it is not."""
    shown = pellicle("explain", "hertz").stdout
    assert 'radius = "5 um"\nreduced_modulus = "2 kPa"\ndepth = "0.5 um"\n' in shown
    assert {"radius", "reduced_modulus", "depth"} == {
        line.split()[0] for line in shown.splitlines() if " required " in line
    }
    schema = json.loads(pellicle("schema", "hertz").stdout)
    assert schema["required"] == ["radius", "reduced_modulus", "depth"]
    other = pellicle("schema", "check")
    assert other.returncode == 2
    assert "Known: fit, hertz, run" in other.stderr


def test_a_file_for_another_command_is_told_so(pellicle: Command, tmp_path: Path) -> None:
    """Both ways, between a stranger's command and ours."""
    for example, wrong, right in (("bead", "run", "hertz"), ("layer", "hertz", "run")):
        file = tmp_path / f"{example}.toml"
        pellicle("new", "--example", example, str(file))
        done = pellicle(wrong, str(file))
        assert done.returncode == 2
        assert f"makes this a file for `pellicle {right}`" in done.stderr
        assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("switch", ["1", "pellicle-hertz", "command.hertz"])
def test_is_switched_off(pellicle: Command, switch: str) -> None:
    """As components are: it is not found, and listed as switched off."""
    done = pellicle("hertz", PELLICLE_DISABLE_PLUGINS=switch)
    assert done.returncode == 2
    assert "No such command 'hertz'" in done.stderr
    listed = json.loads(pellicle("plugins", "--json", PELLICLE_DISABLE_PLUGINS=switch).stdout)
    assert "pellicle-hertz 0.3.0 (entry point 'command.hertz')" in listed["disabled"]
