"""What a prescription has to be to be registered, and how its runs resume."""

from functools import partial
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from pydantic import Field

import pellicle as pl
from pellicle.components.installed import FAMILIES
from pellicle.plugins.registry import checked_type, load
from pellicle.units import Quantity
from tests.framework.broken.catalogue import Broken, Taken, make
from tests.framework.broken.prescriptions import PRESCRIPTIONS
from tests.tables_of_runs import interrupt, paraboloid, pressing, tensed

STAYS = Taken("registration looks at the class")
pressed = partial(pressing, 24, "0.4 mm", tensed("10 kPa", "0.1 N/m"), paraboloid("1 mm"))
NUMBER = (Annotated[float, Quantity("1"), Field(description="a number")], 1.0)


def lie(fault: str, words: str, **members: Any) -> Any:
    """Return a prescription that cannot be registered, and what is said of it."""
    return pytest.param(Broken(fault, STAYS, **members), words, id=fault)


@pytest.mark.parametrize(
    ("broken", "words"),
    [
        lie("no unit", "lacks the class variable unit", unit=()),
        lie("odd unit", "'bananas', which is not a known unit", unit="bananas"),
        lie("option", "is an option of", fields={"type": (Literal["stiffness"], "stiffness")}),
        lie("field of an option", "'stiffness' is an option of", fields={"stiffness": NUMBER}),
        lie("own name", "field with the name of its type", fields={"broken": NUMBER}),
    ],
)
def test_not_registered(broken: Broken, words: str) -> None:
    """What a table of the loading cannot hold is refused when it is registered."""
    with pytest.raises(pl.PluginError, match=words):
        checked_type(type(make(PRESCRIPTIONS, broken)))


def test_broken_prescription_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """A key whose plugin cannot be loaded is not called unknown."""
    entry = EntryPoint("prescription.volume", "no.such.module", "pellicle")
    loaded = load([entry, *entry_points(group="pellicle")], known=FAMILIES)
    monkeypatch.setattr("pellicle.config.loading.registry", lambda: loaded)
    with pytest.raises(pl.PluginError, match="prescription 'volume' is broken"):
        pl.Loading(volume=1.0)


@pytest.mark.parametrize(
    "loading",
    [
        {"depth": ["5 um", "10 um", "15 um"]},
        {"base_displacement": ["20 um", "30 um", "40 um"], "spring_constant": "0.5 N/m"},
        {"gap_volume": ["1.3e-12 m**3", "1.2e-12 m**3", "1.1e-12 m**3"]},
    ],
)
def test_resumes_in_the_middle(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, loading: dict[str, Any]
) -> None:
    """A run that was interrupted goes on at its next step, from the state of the one before."""
    run = pl.Run(**pressed(**loading), outputs=[], title="path")
    whole = pl.run(run, directory=tmp_path / "whole", progress=False).dataset
    calls = interrupt(monkeypatch)
    with pytest.raises(KeyboardInterrupt):
        pl.run(run, directory=tmp_path / "parts", progress=False)
    resumed = pl.run(run, directory=tmp_path / "parts", progress=False).dataset
    # One call before the interruption, that which was interrupted, and two to finish.
    assert len(calls) == 4
    for name in ("force", "depth", "contact_area", "operator_applications", *loading):
        if name in whole:
            assert resumed[name].values.tolist() == whole[name].values.tolist(), name


def test_identity_of_a_run_is_kept() -> None:
    """The identity under which an unchanged run goes on in its file."""
    run = pl.Run(**pressed(depth=["5 um", "10 um"]))
    assert run.identity == "c51d92339c970e7f2928af6eb2c8c669eafaf84bbe14d70919dcc5a8f9ca6f32"
