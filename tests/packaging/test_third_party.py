"""A stranger's package: built, installed and run as its author and its users would."""

import json
from pathlib import Path

import numpy as np
import pytest

import pellicle as pl
from tests.packaging.conftest import Command

SOURCE = Path(__file__).with_name("third_party")
SYMBOL_ONLY = Path(__file__).with_name("symbol_only")
RELAXING = Path(__file__).with_name("relaxing")
ONE_OUTPUT = Path(__file__).with_name("one_output")
CELLS = Path(__file__).parents[1] / "data" / "kernel_cells.csv"


@pytest.mark.slow
def test_is_listed_with_its_origin(pellicle: Command) -> None:
    """The list of plugins holds the kernel, its distribution, its version and its first line."""
    listing = json.loads(pellicle("plugins", "--json").stdout)
    assert {
        "family": "kernel",
        "type": "power_law",
        "origin": "pellicle-power-law",
        "version": "1.2.3",
        "description": "Stiffness k ∝ qⁿ: a Winkler foundation (n = 0), a graded solid, "
        "the half-space (n = 1).",
    } in listing["components"]
    assert listing["broken"] == []


def test_is_in_the_schema(pellicle: Command) -> None:
    """An editor completes the kernel's type and fields."""
    kernels = json.loads(pellicle("schema").stdout)["properties"]["kernel"]["oneOf"]
    (mine,) = (k for k in kernels if k["properties"]["type"]["const"] == "power_law")
    assert {"reduced_modulus", "length", "exponent"} <= mine["properties"].keys()


def test_runs_and_is_on_record(pellicle: Command, tmp_path: Path) -> None:
    """Its file of nine lines runs to convergence, and the result names the distribution."""
    done = pellicle("run", str(SOURCE / "graded.toml"), "-o", str(tmp_path))
    assert done.returncode == 0, done.stderr
    result = pl.load(tmp_path / "graded.h5")
    assert result.converged
    assert "pellicle-power-law 1.2.3" in result.dataset.attrs["versions"].split(", ")
    assert result.configuration["kernel"]["type"] == "power_law"


def test_runs_on_a_free_boundary_too(pellicle: Command, tmp_path: Path) -> None:
    """The same file with an isolated contact converges, compliance(q) being all there is."""
    free = ["--set", "grid.boundary=free", "--set", "loading={ depth = '20 um' }"]
    done = pellicle("run", str(SOURCE / "graded.toml"), *free, "-o", str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert pl.load(tmp_path / "graded.h5").converged


def test_a_membrane_known_by_its_symbol_has_the_reference_coefficients(python: Command) -> None:
    """Installed and asked through the library, each of 27 coefficients is met to 1e-7."""
    done = python(str(SYMBOL_ONLY / "cells.py"), str(CELLS))
    assert done.returncode == 0, done.stderr
    errors = json.loads(done.stdout)
    assert {float(s) for s in errors} >= {0.0, 0.1, 10.0}
    for of_length in errors.values():
        assert len(of_length) == 9
        assert max(map(abs, of_length)) < 1e-7


@pytest.mark.slow
def test_a_kernel_that_relaxes_keeps_its_contract(python: Command) -> None:
    """Installed, a gel with branches of its own passes the kit, alone and under a skin."""
    done = python(str(RELAXING / "check.py"))
    assert done.returncode == 0, done.stderr


def test_a_kernel_that_relaxes_runs_in_time(pellicle: Command, tmp_path: Path) -> None:
    """The force at a depth is its modulus at each time."""
    done = pellicle("run", str(RELAXING / "dwell.toml"), "-o", str(tmp_path))
    assert done.returncode == 0, done.stderr
    data = pl.load(tmp_path / "dwell.h5").dataset
    t, force = data["time"].values, data["force"].values
    modulus = 0.2 + 0.4 * np.exp(-t / 0.5) + 0.4 * np.exp(-t / 5)
    np.testing.assert_allclose(force / force[0], modulus, rtol=1e-7)


@pytest.mark.slow
def test_an_output_is_one_method(python: Command) -> None:
    """Installed, a class with the method write() alone keeps the contract of outputs."""
    done = python(str(ONE_OUTPUT / "check.py"))
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("studied", [False, True])
def test_an_output_shows_a_run_and_a_study(
    studied: bool, pellicle: Command, tmp_path: Path
) -> None:
    """Its file has the highest pressure of each step, beside the result and nothing else."""
    vary = ["--set", 'study.vary={"kernel.tension" = ["0.1 N/m", "0.2 N/m"]}'] if studied else []
    done = pellicle("run", str(ONE_OUTPUT / "hottest.toml"), *vary, "-o", str(tmp_path))
    assert done.returncode == 0, done.stderr
    name = "study" if studied else "hottest"
    files = {path.name for path in tmp_path.iterdir()} - {"runs", "study.csv"}
    assert files == {f"{name}.h5", f"{name}-hottest.txt"}
    runs = sorted(tmp_path.glob("runs/*.h5")) if studied else [tmp_path / "hottest.h5"]
    highest = {x for run in runs for x in pl.load(run).dataset["pressure"].max(["x", "y"]).values}
    lines = (tmp_path / f"{name}-hottest.txt").read_text().split()
    assert len(lines) == (4 if studied else 2)
    assert {float(line) for line in lines} == highest


def test_bad_values_are_refused_like_our_own(pellicle: Command) -> None:
    """A field of the stranger is checked, and the message names it, without a traceback."""
    done = pellicle("run", str(SOURCE / "graded.toml"), "--set", "kernel.exponent=3")
    assert done.returncode == 2
    assert done.stderr.startswith("error: kernel.exponent: 3 is not allowed")
    assert "Traceback" not in done.stderr


def test_can_be_switched_off(pellicle: Command) -> None:
    """With strangers off, its file says what is switched off and by what."""
    file = str(SOURCE / "graded.toml")
    done = pellicle("run", file, PELLICLE_DISABLE_PLUGINS="1")
    assert done.returncode == 2
    assert "pellicle-power-law 1.2.3" in done.stderr
    assert "switched off by PELLICLE_DISABLE_PLUGINS" in done.stderr
