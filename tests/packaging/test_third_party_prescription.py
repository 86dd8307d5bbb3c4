"""A stranger's prescription: built, installed, checked by the kit, and run."""

import json
from pathlib import Path

import numpy as np
import pytest

import pellicle as pl
from tests.packaging.conftest import Command

SOURCE = Path(__file__).with_name("mean_gap")
CHECK = """
from pellicle.testing import check_prescription
from pellicle_mean_gap import MeanGap
for share in (1.0, 0.5):
    check_prescription(MeanGap(share=share))
"""


@pytest.mark.slow
def test_keeps_its_contract(python: Command) -> None:
    """The kit that checks our own prescriptions has nothing to say."""
    done = python("-c", CHECK)
    assert done.returncode == 0, done.stderr


def test_runs_and_is_on_record(pellicle: Command, tmp_path: Path) -> None:
    """Its file runs to the gaps prescribed; the result names the distribution; a rerun resumes."""
    run = ("run", str(SOURCE / "squeeze.toml"), "-o", str(tmp_path), "--set")
    done = pellicle(*run, "outputs=[]")
    assert done.returncode == 0, done.stderr
    result = pl.load(tmp_path / "squeeze.h5")
    assert result.converged
    assert result.configuration["loading"]["share"] == 0.5
    assert "pellicle-mean-gap 0.3.0" in result.dataset.attrs["versions"].split(", ")
    np.testing.assert_allclose(result.dataset["mean_gap"], [1.5e-5, 1e-5, 5e-6], rtol=1e-6)
    inner = result.dataset["gap"][:, 8:24, 8:24].mean(["x", "y"])
    np.testing.assert_allclose(inner, result.dataset["mean_gap"], rtol=1e-12)
    assert result.dataset["mean_gap"].attrs["units"] == "m"
    again = pellicle(*run, "outputs=[]")
    assert again.returncode == 0, again.stderr
    shown = pellicle("show", str(tmp_path / "squeeze.h5"))
    assert "mean gap [µm]" in shown.stdout


def test_is_in_the_schema(pellicle: Command) -> None:
    """An editor completes its key, its field and the options of the loading."""
    file = json.loads(pellicle("schema").stdout)
    choices = file["$defs"]["Loading"]["oneOf"]
    (mine,) = (c for c in choices if "mean_gap" in c["properties"])
    assert mine["properties"].keys() == {"mean_gap", "share", "time", "stiffness"}
    assert mine["required"] == ["mean_gap"]


@pytest.mark.parametrize(
    ("loading", "words"),
    [
        ("{mean_gap='-1 um'}", "loading.mean_gap: '-1 um' is not allowed; give a value ≥ 0 m"),
        ("{mean_gap='1 um', share=2}", "loading.share: 2 is not allowed"),
        ("{mean_gap='1 um', shore=2}", "loading.shore: is not a field here; did you mean 'share'"),
        ("{mean_gop='1 um'}", "loading.mean_gop: is not a field here; did you mean 'mean_gap'"),
    ],
)
def test_bad_values_are_refused_like_our_own(pellicle: Command, loading: str, words: str) -> None:
    """Its key and its fields are checked, without a traceback."""
    done = pellicle("run", str(SOURCE / "squeeze.toml"), "--set", f"loading={loading}")
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_can_be_switched_off(pellicle: Command, tmp_path: Path) -> None:
    """With strangers off, its file says what is switched off; its results can still be shown."""
    done = pellicle("run", str(SOURCE / "squeeze.toml"), PELLICLE_DISABLE_PLUGINS="1")
    assert done.returncode == 2
    assert "switched off by PELLICLE_DISABLE_PLUGINS" in done.stderr
    pellicle("run", str(SOURCE / "squeeze.toml"), "-o", str(tmp_path))
    shown = pellicle("show", str(tmp_path / "squeeze.h5"), PELLICLE_DISABLE_PLUGINS="1")
    assert shown.returncode == 0, shown.stderr
