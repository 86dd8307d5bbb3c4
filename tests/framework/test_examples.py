"""The examples that ``pellicle new --example`` writes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import pellicle as pl
from pellicle.config.study import from_toml
from tests.command import call

SMALLER = {
    "rough": ["grid.points=64", "indenter.cutoff_wavelength='125 um'"],
    "gel": ["grid.points=32"],
    "layer": ["grid.points=32"],
}


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", SMALLER)
def test_an_example_runs_as_it_is(name: str) -> None:
    """It is read without a change, and solved (on fewer cells here); every step converges."""
    done = call("new", "--example", name)
    assert done.output == f"wrote {name}.toml; next: pellicle run {name}.toml\n"
    assert isinstance(from_toml(f"{name}.toml"), pl.Study) is (name == "gel")
    smaller = [word for value in SMALLER[name] for word in ("--set", value)]
    call("run", f"{name}.toml", "--quiet", "--threads", "1", *smaller)
    assert list(Path(name).glob("*.h5"))
    assert list(Path(name).glob("*.csv"))


@pytest.mark.slow
def test_the_example_of_a_fit_finds_what_went_in() -> None:
    """The intervals contain the modulus and the tension with which the curve was made."""
    call("new", "--example", "fit", "mine.toml")
    fit = json.loads(call("fit", "mine.toml", "--json").output)
    for name, true in (("reduced_modulus", 2e3), ("tension", 5e-3), ("contact_point", 3e-6)):
        known = fit["parameters"][name]
        assert known["low"] < true < known["high"]
    assert fit["tension_needed"]


def test_an_example_replaces_no_file() -> None:
    """A file of that name stays as it is, and so does a curve; other examples do not exist."""
    Path("fit-curve.csv").write_text("mine", encoding="utf-8")
    assert "exists already" in call("new", "--example", "fit", code=2).output
    assert Path("fit-curve.csv").read_text(encoding="utf-8") == "mine"
    assert not Path("fit.toml").exists()
    told = "give one of fit, droplet, gel, indent, layer, rough"
    assert told in call("new", "--example", "soft", code=2).output
    both = call("new", "--example", "gel", "--plugin", "kernel", "x", code=2).output
    assert "exclude each other" in both
