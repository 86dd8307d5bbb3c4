"""For each rule of outputs: an output that breaks it, and only it, by a little."""

import json
from pathlib import Path
from typing import Any, ClassVar, Literal

import pytest

import pellicle as pl
from tests.framework.testing.mutants import check_base, check_mutant, rules_of


class Output(pl.Output):
    """Text with the depth of each step, to be broken."""

    type: Literal["broken"] = "broken"
    scope: ClassVar[Literal["run", "study", "both"]] = "run"

    @property
    def suffixes(self) -> tuple[str, ...]:
        return (".json",)

    def write(self, runs: Any, stem: Any) -> Any:
        path = Path(f"{stem}.json")
        path.write_text(json.dumps(self.shown(runs.table["depth"].values.tolist())))
        return (path,)

    def shown(self, depths: list[float]) -> list[Any]:
        return depths


class LosesFirst(Output):
    """Forgets the first step."""

    def shown(self, depths: list[float]) -> list[Any]:
        return depths[1:] or ["none"]


class LosesLast(Output):
    """Forgets the last step."""

    def shown(self, depths: list[float]) -> list[Any]:
        return depths[:-1] or ["none"]


class Nameless(Output):
    """Does not return what it leaves."""

    def write(self, runs: Any, stem: Any) -> Any:
        super().write(runs, stem)
        return ()


class Littering(Output):
    """Leaves more than it returns."""

    def write(self, runs: Any, stem: Any) -> Any:
        Path(f"{stem}.log").write_text("done")
        return super().write(runs, stem)


class Untold(Output):
    """Leaves and returns a file that is not among its suffixes."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        return ("-*.json",)


class Empty(Output):
    """Leaves a file with nothing in it."""

    def write(self, runs: Any, stem: Any) -> Any:
        (path,) = super().write(runs, stem)
        path.write_text("")
        return (path,)


class Own(Output):
    """Leaves a file of a name that another run would have too."""

    def write(self, runs: Any, stem: Any) -> Any:
        (path,) = super().write(runs, stem)
        return (path.replace(path.with_name("result.json")),)


class Once(Output):
    """Refuses to replace its own file."""

    def write(self, runs: Any, stem: Any) -> Any:
        if Path(f"{stem}.json").exists():
            raise pl.StorageError(f"{stem}.json exists")
        return super().write(runs, stem)


class Jealous(Output):
    """Wants the folder to itself."""

    def write(self, runs: Any, stem: Any) -> Any:
        if any(not path.name.startswith(stem.name) for path in stem.parent.iterdir()):
            raise pl.StorageError(f"{stem.parent} is not empty")
        return super().write(runs, stem)


class OneRun(Output):
    """Shows a study as if it were a run."""

    scope: ClassVar[Literal["run", "study", "both"]] = "both"

    def write(self, runs: Any, stem: Any) -> Any:
        runs.open(runs.table["run"].item())
        return super().write(runs, stem)


class Normalising(Output):
    """Divides the pressure by its maximum, in place."""

    def step(self, record: Any, stem: Any) -> None:
        record["pressure"].values[...] /= record["pressure"].values.max()


class Renaming(Output):
    """Takes the data for its own."""

    def write(self, runs: Any, stem: Any) -> Any:
        runs.open().attrs["title"] = "mine"
        return super().write(runs, stem)


class Spoken(Output):
    """Returns the name of its file as a text."""

    def write(self, runs: Any, stem: Any) -> Any:
        (path,) = super().write(runs, stem)
        return str(path)


OUTPUTS = {
    Normalising: "leaves_its_data_as_they_are",
    Renaming: "leaves_its_data_as_they_are",
    Spoken: "leaves_the_files_it_returns",
    Own: "leaves_the_files_it_returns",
    LosesFirst: "loses_no_step",
    LosesLast: "loses_no_step",
    Nameless: "leaves_the_files_it_returns",
    Littering: "leaves_the_files_it_returns",
    Untold: "leaves_the_files_it_returns",
    Empty: "leaves_the_files_it_returns",
    Once: "leaves_the_files_it_returns",
    Jealous: "works_in_a_run",
    OneRun: "works_in_a_study",
}


@pytest.mark.parametrize(
    ("mutant", "rule"), OUTPUTS.items(), ids=lambda value: getattr(value, "__name__", "")
)
def test_mutant_is_caught(mutant: Any, rule: str) -> None:
    """The message names the class, the rule, what is asked and what was found."""
    check_mutant("output", mutant(), rule)


def test_what_the_mutants_are_made_of_is_whole() -> None:
    """Without its fault each mutant breaks nothing but that no plugin registers it."""
    check_base("output", Output())


def test_each_rule_has_a_mutant(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rule could be dropped, or say yes to everything, without a test that fails."""
    assert rules_of("output", monkeypatch) == set(OUTPUTS.values())
