"""What a prescription has to be to be registered, and how its runs resume."""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import pytest
from pydantic import Field

import pellicle as pl
from pellicle.plugins import checked_type
from pellicle.units import Quantity

BASE: dict[str, Any] = {
    "grid": {"points": 24, "size": "0.4 mm"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "0.1 N/m"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
}
Value = Annotated[float, Quantity("1"), Field(description="a number")]


class Twice(pl.Prescription):
    """Half of the depth."""

    type: Literal["twice"] = "twice"
    unit: ClassVar[str] = "m"

    def target(self, setting: Any, value: float) -> Any:
        """Return twice the value."""
        return pl.Depth(2 * value)


class NoUnit(pl.Prescription):
    """Has no unit."""

    type: Literal["no_unit"] = "no_unit"

    def target(self, setting: Any, value: float) -> Any:
        """Return the value."""
        return pl.Depth(value)


class OddUnit(Twice):
    """Has a unit that nobody knows."""

    unit: ClassVar[str] = "bananas"


class Option(Twice):
    """Is called as an option of the loading is."""

    type: Literal["stiffness"] = "stiffness"  # type: ignore[assignment]


class OptionField(Twice):
    """Has a field of the name of an option."""

    stiffness: Value = 1.0


class OwnName(Twice):
    """Has a field of its own name."""

    twice: Value = 1.0


@pytest.mark.parametrize(
    ("lie", "words"),
    [
        (NoUnit, "lacks the class variable unit"),
        (OddUnit, "'bananas', which is not a known unit"),
        (Option, "'stiffness' is an option of"),
        (OptionField, "'stiffness' is an option of"),
        (OwnName, "field with the name of its type"),
    ],
)
def test_not_registered(lie: Any, words: str) -> None:
    """What a table of the loading cannot hold is refused when it is registered."""
    assert checked_type(Twice) == "twice"
    with pytest.raises(pl.PluginError, match=words):
        checked_type(lie)


def test_broken_prescription_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """A key whose plugin cannot be loaded is not called unknown."""
    from pellicle import plugins

    entry = EntryPoint("prescription.volume", "no.such.module", "pellicle")
    loaded = plugins.load([entry, *entry_points(group="pellicle")])
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
    from pellicle.runs import steps

    run = pl.Run(**BASE, loading=loading, outputs=[], title="path")
    whole = pl.run(run, directory=tmp_path / "whole", progress=False).dataset
    solve, calls = steps.solve_step, []

    def once(*arguments: Any) -> Any:
        calls.append(arguments)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return solve(*arguments)

    monkeypatch.setattr(steps, "solve_step", once)
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
    run = pl.Run(**BASE, loading={"depth": ["5 um", "10 um"]})
    assert run.identity == "c51d92339c970e7f2928af6eb2c8c669eafaf84bbe14d70919dcc5a8f9ca6f32"
