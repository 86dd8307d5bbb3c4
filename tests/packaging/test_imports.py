"""What an import costs, and which names of the top level applications bring."""

import json
import re
import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

import pellicle
import pellicle as pl
from pellicle.plugins import applications
from pellicle.plugins.commands import commands

HEAVY = {
    *("numpy", "scipy", "pydantic", "pint", "xarray", "h5py", "h5netcdf", "pandas", "matplotlib"),
    "pellicle_plugins",
}
ON_THE_COMMAND_LINE = """
import sys
for arguments in {helps}:
    sys.argv = ["pellicle", *arguments]
    try:
        main()
    except SystemExit:
        pass
"""
PELLICLE = "from pellicle.__main__ import main\n" + ON_THE_COMMAND_LINE
BARE = (
    """
from pathlib import Path
from typing import Annotated
import rich.console, rich.table, typer
main = typer.Typer()

@main.command()
def run(file: Path, n: Annotated[int, typer.Option(min=1)] = 1):
    pass

@main.command()
def show():
    pass
"""
    + ON_THE_COMMAND_LINE
)
"""A program of typer alone: what it loads is not ours to save."""


def modules(code: str) -> set[str]:
    """Return the modules that a fresh interpreter has loaded after ``code``."""
    script = f"{code}\nimport json, sys\nprint()\nprint(json.dumps(sorted(sys.modules)))"
    # Isolated from PYTHON* variables and the current folder.
    done = subprocess.run(
        [sys.executable, "-I", "-c", script], check=True, capture_output=True, encoding="utf-8"
    )
    return set(json.loads(done.stdout.splitlines()[-1]))


def loaded(code: str) -> set[str]:
    """Return the heavy packages that a fresh interpreter has loaded after ``code``."""
    return HEAVY & modules(code)


def test_importing_pellicle_loads_nothing_heavy() -> None:
    """The bare import pays for none of the names behind it, nor does one that catches errors."""
    assert loaded("from pellicle import PellicleError, ConfigError, StorageError") == set()


def test_help_loads_nothing_heavy() -> None:
    """Help is printed without the heavy packages, but for those that typer itself loads."""
    helps = [["--help"], *([name, "--help"] for name in commands())]
    assert loaded(PELLICLE.format(helps=helps)) <= loaded(BARE.format(helps=[["run", "--help"]]))


def test_the_registry_loads_no_more_than_components_need() -> None:
    """A module of a component imports numpy and its contract; what it computes with is later."""
    names = modules("import pellicle\npellicle.kernel('half_space', reduced_modulus=1.0)")
    assert HEAVY & names == {"numpy", "scipy", "pydantic", "pellicle_plugins"}
    # What scipy itself loads with these is its own: from 1.18 on, scipy.linalg with scipy.special.
    own = modules("import scipy.fft, scipy.sparse, scipy.special, scipy.version")
    public = {name for name in names if re.fullmatch(r"scipy\.[a-z]+", name)}
    assert public <= own


def test_a_misspelt_keyword_loads_no_command() -> None:
    """Only a file may be for another command; a call says what it makes."""
    run = "grid={'points': 8, 'size': 1.0}, kernel={'type': 'half_space', 'reduced_modulus': 1.0}"
    study = f"pellicle.Study(run=dict({run}, kernl=1), vary={{'kernel.reduced_modulus': [1, 2]}})"
    wrong = (f"pellicle.Run({run}, kernl=1)", f"pellicle.run(dict({run}, kernl=1))", study)
    tries = "".join(
        f"try:\n    {call}\nexcept pellicle.ConfigError as e:\n    assert 'kernl' in str(e)\n"
        for call in wrong
    )
    names = modules(f"import pellicle\n{tries}")
    assert not {"pellicle_fit.command", "pellicle_check", "pellicle.cli.run"} & names


def test_unknown_name_is_an_attribute_error() -> None:
    """A name that does not exist fails as in any module."""
    with pytest.raises(AttributeError, match="nonsense"):
        _ = pellicle.nonsense  # type: ignore[attr-defined]


GROUP = "pellicle.applications"


def test_a_name_is_that_of_the_application() -> None:
    """The name at the top level and that of the package are one object."""
    import pellicle_fit

    assert pl.fit is pellicle_fit.fit
    assert "fit" in dir(pl)


def test_what_is_not_installed_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """A part of the wheel that is missing costs its own names, and no others."""
    unknown = "simulate_gel"
    entries = [
        EntryPoint("absent", "no_such_package", GROUP),
        EntryPoint("fit", "pellicle_fit", GROUP),
    ]
    monkeypatch.setattr(applications, "entry_points", lambda group: entries)
    assert applications.fit is pl.fit
    with pytest.raises(pl.PluginError, match=r"brings pellicle\.simulate_gel; that of no_such_pa"):
        getattr(applications, unknown)
    monkeypatch.setattr(applications, "entry_points", lambda group: [])
    with pytest.raises(AttributeError, match="'fit'"):
        _ = applications.fit
