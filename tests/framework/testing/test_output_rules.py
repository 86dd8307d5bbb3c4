"""For each rule of outputs: an output that breaks it, and only it, by a little."""

import json
from typing import Any, Literal

import pytest

import pellicle as pl
from tests.framework.testing.mutants import check_base, check_mutant, rules_of


class Output(pl.Output):
    """Text with the depth of each step, to be broken."""

    type: Literal["broken"] = "broken"

    def endings(self) -> tuple[str, ...]:
        return (".json",)

    def close(self, place: Any, result: Any) -> Any:
        path = place.file(".json")
        path.write_text(json.dumps(self.told(result.dataset["depth"].values.tolist())))
        return (path,)

    def told(self, depths: list[float]) -> list[Any]:
        return depths


class LosesFirst(Output):
    """Forgets the first step."""

    def told(self, depths: list[float]) -> list[Any]:
        return depths[1:] or ["none"]


class LosesLast(Output):
    """Forgets the last step."""

    def told(self, depths: list[float]) -> list[Any]:
        return depths[:-1] or ["none"]


class Nameless(Output):
    """Does not name what it leaves."""

    def close(self, place: Any, result: Any) -> Any:
        super().close(place, result)
        return ()


class Littering(Output):
    """Leaves more than it names."""

    def close(self, place: Any, result: Any) -> Any:
        place.file(".log").write_text("done")
        return super().close(place, result)


class Untold(Output):
    """Leaves and names a file that it tells nobody of beforehand."""

    def endings(self) -> tuple[str, ...]:
        return ("-*.json",)


class Empty(Output):
    """Leaves a file with nothing in it."""

    def close(self, place: Any, result: Any) -> Any:
        (path,) = super().close(place, result)
        path.write_text("")
        return (path,)


class Own(Output):
    """Leaves a file of a name that another run would have too."""

    def close(self, place: Any, result: Any) -> Any:
        (path,) = super().close(place, result)
        return (path.replace(path.with_name("result.json")),)


class Once(Output):
    """Refuses to replace its own file."""

    def open(self, place: Any) -> None:
        super().open(place)
        if place.file(".json").exists():
            raise pl.StorageError(f"{place.file('.json')} exists")


class Optimistic(Output):
    """Finds out after the computation that it cannot write."""

    def open(self, place: Any) -> None:
        pass

    def close(self, place: Any, result: Any) -> Any:
        place.directory.mkdir(parents=True, exist_ok=True)
        return super().close(place, result)


class Resuming(Output):
    """Goes on from a file that need not be there."""

    def resume(self, place: Any) -> Any:
        json.loads(place.file(".json").read_text())


class Normalising(Output):
    """Divides the pressure by its maximum, in place."""

    def step(self, place: Any, step: Any) -> None:
        step["pressure"].values[...] /= step["pressure"].values.max()


class Renaming(Output):
    """Takes the data for its own."""

    def close(self, place: Any, result: Any) -> Any:
        result.dataset.attrs["title"] = "mine"
        return super().close(place, result)


class Spoken(Output):
    """Says the name of its file."""

    def close(self, place: Any, result: Any) -> Any:
        (path,) = super().close(place, result)
        return str(path)


OUTPUTS = {
    Normalising: "leaves_its_data_as_they_are",
    Renaming: "leaves_its_data_as_they_are",
    Spoken: "leaves_the_files_it_names",
    LosesFirst: "loses_no_step",
    LosesLast: "loses_no_step",
    Nameless: "leaves_the_files_it_names",
    Littering: "leaves_the_files_it_names",
    Untold: "leaves_the_files_it_names",
    Empty: "leaves_the_files_it_names",
    Own: "leaves_the_files_it_names",
    Once: "leaves_the_files_it_names",
    Optimistic: "hopeless_folder_is_known_before_computing",
    Resuming: "works_in_a_run",
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
