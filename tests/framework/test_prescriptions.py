"""What a prescription has to be to be registered, what a run does with one, and old files."""

from __future__ import annotations

import gzip
import json
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any, ClassVar, Literal

import pytest
from pydantic import Field

import pellicle as pl
from pellicle.components.calls import check_variables, report_of, target_of
from pellicle.plugins import checked_type
from pellicle.results.variables import Variable
from pellicle.runs.compose import compose
from pellicle.units import Quantity

DATA = Path(__file__).parents[1] / "data"
BASE: dict[str, Any] = {
    "grid": {"points": 24, "size": "0.4 mm"},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "0.1 N/m"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
}
SEARCH: Any = pl.Search
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


def _returns(**members: Any) -> pl.Prescription:
    return type("Liar", (Twice,), {"__module__": __name__, "__doc__": "Lies.", **members})()  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    ("target", "words"),
    [
        (lambda *_: 1e-6, r"'twice'.* returned 1e-06; it has to return a pellicle.Depth, Force"),
        (lambda *_: None, "returned None"),
        (lambda *_: pl.Depth(float("nan")), r"\.value returned nan"),
        (lambda *_: pl.Depth(float("inf")), r"\.value is inf; it has to be finite"),
        (lambda *_: pl.Depth(1e-6, compliance=-1.0), r"compliance is -1; .* finite and ≥ 0"),
        (lambda *_: pl.Force(-1.0), r"value is -1; it has to be finite and ≥ 0"),
        (lambda *_: SEARCH(1.0, "area"), "a function as measure"),
        (lambda *_: SEARCH(1.0, len, control=float), "control = Depth or Force"),
        (lambda *_: SEARCH(1.0, len, resolution=-1.0), "resolution is -1"),
    ],
)
def test_target_that_lies(target: Any, words: str) -> None:
    """What is returned is checked before it is solved for; the message names the component."""
    setting = compose(pl.Run(**BASE, loading={"depth": 0}))
    with pytest.raises(pl.PluginError, match=words):
        target_of(_returns(target=target), setting, 1e-6)


def _much(step: Any) -> Any:
    return "much"


def test_measure_and_report_that_lie() -> None:
    """A quantity that is no number, and variables that are not declared, are refused."""
    setting = compose(pl.Run(**BASE, loading={"depth": 0}))
    liar = _returns(target=lambda *_: SEARCH(1.0, _much))
    target = target_of(liar, setting, 1.0)
    with pytest.raises(pl.PluginError, match=r"measure\(step\) returned 'much'"):
        target.measure(SimpleNamespace())  # type: ignore[union-attr, arg-type]
    with pytest.raises(pl.PluginError, match="dict of nothing"):
        report_of(_returns(report=lambda *_: {"extra": 1.0}), setting, SimpleNamespace())  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["force", "pressure", "status", "x", "step", "a/b", ""])
def test_no_variable_of_a_result_is_replaced(name: str) -> None:
    """A variable that a prescription adds is neither another number of the step nor unreadable."""
    liar = _returns(variables=(Variable(name, "m", "meaning"),))
    with pytest.raises(pl.PluginError, match=rf"'twice': variables has '{name}', which is "):
        check_variables(liar)


def test_what_it_raises_has_its_name() -> None:
    """An error of a prescription is noted to be its own."""

    def fail(*_: Any) -> Any:
        raise ZeroDivisionError

    setting = compose(pl.Run(**BASE, loading={"depth": 0}))
    with pytest.raises(ZeroDivisionError) as caught:
        target_of(_returns(target=fail), setting, 1.0)
    assert "prescription 'twice' failed" in caught.value.__notes__[0]


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


def test_identity_and_text_are_those_of_the_version_before(tmp_path: Path) -> None:
    """A file of version 1 is read, and its run is the same run."""
    path = tmp_path / "result.h5"
    path.write_bytes(gzip.decompress((DATA / "result_v1.h5.gz").read_bytes()))
    result = pl.load(path)
    text = result.dataset.attrs["configuration"]
    run = pl.Run.from_json(text)
    assert result.dataset.attrs.get("identity", run.identity) == run.identity
    assert json.loads(run.to_json())["loading"] == json.loads(text)["loading"]
    assert result.planned_steps == len(run.loading.values)
    known = pl.Run(**BASE, loading={"depth": ["5 um", "10 um"]})
    assert known.identity == IDENTITY


# As main at the tag of the version before computed it.
IDENTITY = "c51d92339c970e7f2928af6eb2c8c669eafaf84bbe14d70919dcc5a8f9ca6f32"
