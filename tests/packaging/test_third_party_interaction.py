"""A stranger's law of adhesion: built, installed, checked by the kit, and run."""

import json
from pathlib import Path

import numpy as np
import pytest

import pellicle as pl
from tests.packaging.conftest import Command

SOURCE = Path(__file__).with_name("quadratic_softening")
CHECK = """
from pellicle.testing import check_interaction
from pellicle_quadratic_softening import QuadraticSoftening
check_interaction(QuadraticSoftening(work_of_adhesion="50 mJ/m^2", range="8 um"))
"""


@pytest.mark.slow
def test_keeps_its_contract(python: Command) -> None:
    """The kit that checks our own interactions has nothing to say."""
    done = python("-c", CHECK)
    assert done.returncode == 0, done.stderr


def test_runs_and_is_on_record(pellicle: Command, tmp_path: Path) -> None:
    """Its file runs from contact to out of reach; the result has its law and its distribution."""
    run = ("run", str(SOURCE / "retract.toml"), "-o", str(tmp_path), "--set")
    done = pellicle(*run, "outputs=[{type='csv'}]")
    assert done.returncode == 0, done.stderr
    result = pl.load(tmp_path / "retract.h5")
    assert result.converged
    assert result.configuration["interaction"]["range"] == 8e-6
    versions = result.dataset.attrs["versions"].split(", ")
    assert "pellicle-quadratic-softening 0.2.0" in versions
    data = result.dataset.isel(step=1)
    assert data["force"] < 0 < data["zone_area"]
    # The traction is the wall pressure and the law at the gap, by its formula and not by its code.
    law = -3 * 0.05 / 8e-6 * np.clip(1 - data["gap"] / 8e-6, 0, 1) ** 2
    np.testing.assert_allclose(
        data["pressure"], data["wall_pressure"] + law, atol=1e-5 * float(abs(law).max())
    )
    assert not result.dataset["pressure"][2].any()
    assert "residual_traction" in (tmp_path / "retract.csv").read_text(encoding="utf-8")
    again = pellicle(*run, "outputs=[{type='csv'}]")
    assert again.returncode == 0, again.stderr


def test_is_in_the_schema(pellicle: Command) -> None:
    """An editor completes its type and its fields."""
    definitions = json.loads(pellicle("schema").stdout)["$defs"]
    mine = definitions["QuadraticSoftening"]["properties"]
    assert mine.keys() == {"type", "work_of_adhesion", "range"}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("range='50 mJ'", "interaction.range: '50 mJ' is an energy; give"),
        ("work_of_adhesion=0", "interaction.work_of_adhesion: 0 is not allowed"),
        ("rang=1", "interaction.rang: is not a field here; did you mean 'range'"),
    ],
)
def test_bad_values_are_refused_like_our_own(pellicle: Command, change: str, words: str) -> None:
    """Its fields are checked, without a traceback."""
    done = pellicle("run", str(SOURCE / "retract.toml"), "--set", f"interaction.{change}")
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
