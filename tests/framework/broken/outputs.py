"""Outputs that break their contract."""

import json
from pathlib import Path
from typing import Any, ClassVar, Literal

import pellicle as pl
from tests.framework.broken.catalogue import Broken, Family, Refused, Taken, run, study


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

    def shown(self, depths: list[float]) -> list[float]:
        return depths


def _run(output: Any, folder: Path) -> str:
    return run(folder, outputs=[output])


def _study(output: Any, folder: Path) -> str:
    return study(folder, outputs=[output])


def before(action: Any) -> Any:
    """Return a method that does something else before it writes."""
    return lambda f, runs, stem: (action(runs, stem), f(runs, stem))[1]


def refuses(condition: Any) -> Any:
    """Return an action that raises where there is a certain file."""

    def refuse(runs: Any, stem: Path) -> None:
        if any(condition(path.name, stem.name) for path in stem.parent.iterdir()):
            raise RuntimeError("there is a file")

    return before(refuse)


def fails(f: Any, runs: Any, stem: Any) -> Any:
    raise OSError("the volume is read-only")


def zero(data: Any) -> None:
    data["force"].values[...] = 0


def empties(f: Any, runs: Any, stem: Any) -> Any:
    (path,) = f(runs, stem)
    path.write_text("")
    return (path,)


CHANGES = Refused("read-only", error=ValueError)
THERE = Refused("there is a file", "output 'broken' failed", error=RuntimeError)
UNSEEN = Taken("a run does not look into the files of an output")
PATHS = Refused("write(runs, stem) returned", "a tuple of pathlib.Path")
ASTRAY = Refused("write(runs, stem) returned", "its files have to begin with the stem")
SUFFIXES = Refused("suffixes is", "it has to be a tuple of texts")
BROKEN: dict[str, Any] = {
    "loses_no_step": [
        Broken("forgets the first step", UNSEEN, shown=lambda f, depths: depths[1:] or [0]),
        Broken("forgets the last step", UNSEEN, shown=lambda f, depths: depths[:-1] or [0]),
    ],
    "leaves_the_files_it_returns": [
        Broken("changes steps", CHANGES, step=lambda f, record, stem: zero(record)),
        Broken("changes the result", CHANGES, write=before(lambda runs, _: zero(runs.open()))),
        Broken(
            "the table", CHANGES, "study", scope="both", write=before(lambda r, _: zero(r.table))
        ),
        Broken("cannot write", Refused("read-only", "'broken' failed", error=OSError), write=fails),
        Broken("returns nothing", PATHS, write=lambda f, *given: None),
        Broken("returns text", PATHS, write=lambda f, *given: [str(f(*given)[0])]),
        Broken("file elsewhere", ASTRAY, write=lambda f, _, stem: [stem.parent / ".." / stem.name]),
        Broken("suffixes in one text", SUFFIXES, suffixes=property(lambda self: ".json")),
        Broken("other suffixes", UNSEEN, suffixes=property(lambda self: ("-*.json",))),
        Broken("does not return its file", UNSEEN, write=lambda f, *given: f(*given)[1:]),
        Broken("leaves more", UNSEEN, write=before(lambda runs, stem: Path(f"{stem}.log").touch())),
        Broken("leaves an empty file", UNSEEN, write=empties),
        Broken("never twice", UNSEEN, write=refuses(lambda name, stem: name == f"{stem}.json")),
    ],
    "works_in_a_run": Broken(
        "wants no other", THERE, write=refuses(lambda name, stem: not name.startswith(stem))
    ),
    "works_in_a_study": Broken(
        "shows a study as if it were a run",
        Refused("output 'broken' failed", error=ValueError),
        "study",
        scope="both",
        write=before(lambda runs, _: runs.open(runs.table["run"].item())),
    ),
}
OUTPUTS = Family(Output, {}, {"run": _run, "study": _study}, ("run",), BROKEN)
