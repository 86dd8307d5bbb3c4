"""Prescriptions that break their contract."""

from dataclasses import replace
from itertools import count
from typing import Any, ClassVar, Literal

import numpy as np

import pellicle as pl
from tests.framework.broken.catalogue import Broken, Family, Marked, Refused, Taken, base, run

GapVolume: Any = base("prescription", "gap_volume")


class Volume(GapVolume):
    """Gap volume to be broken."""

    type: Literal["broken"] = "broken"
    variables: ClassVar[Any] = (
        GapVolume.variables[0]._replace(name="broken"),
        GapVolume.variables[1],
    )

    def report(self, setting: Any, step: Any) -> dict[str, float]:
        return {"broken": super().report(setting, step)["gap_volume"]}


def _run(prescription: Any, _: Any) -> str:
    loading = pl.Loading(gap_volume="1.3e-13 m**3")
    # What is not registered has no key in a table.
    vars(loading)["prescription"] = prescription
    return run(loading=loading)


def searches(**members: Any) -> Any:
    """Return a method whose search has other members."""
    return lambda f, *given: replace(f(*given), **members)


def falling(f: Any, *given: Any) -> Any:
    search = f(*given)
    return replace(search, increasing=not search.increasing)


def target(fault: str, words: str, method: Any) -> Broken:
    """Return a prescription whose target a run refuses."""
    return Broken(fault, Refused("target(setting, 1.3e-13)", words), target=method)


CALLS = count(1)
DECLARED = Refused("report() returned {", "a dict of broken, as its variables declare")
FAILED = Refused("division by zero", "prescription 'broken' failed", error=ZeroDivisionError)
OWN = Taken("a step asks once, and a run cannot tell what a value means")
BROKEN: dict[str, Any] = {
    "report_is_as_declared": [
        Broken("not declared", DECLARED, report=lambda f, *given: f(*given) | {"other": 1.0}),
        Broken("in words", Refused("a real number"), report=lambda *_: {"broken": "about 1 mm³"}),
    ],
    "target_is_pure": [
        target("a number", "it has to return a pellicle.Depth, Force", lambda f, _, value: value),
        target("unknown force", ".value returned nan", lambda *_: pl.Force(np.nan)),
        target("infinite depth", ".value is inf; it has to be finite", lambda *_: pl.Depth(np.inf)),
        target("pull", ".value is -1; it has to be finite and ≥ 0", lambda *_: pl.Force(-1.0)),
        target("stiff spring", ".compliance is -1", lambda *_: pl.Depth(0.0, -1.0)),
        target("search for a name", "a function as measure", searches(measure="area")),
        target("search by a number", "control = Depth or Force", searches(control=float)),
        Broken("fails", FAILED, target=lambda f, setting, value: value / 0),
        Broken("moves on", OWN, target=lambda f, _, v: f(_, v * (1 + 1e-9 * next(CALLS)))),
    ],
    "values_are_refused_in_words": Broken(
        "knows no 0", Taken("it is not zero"), target=lambda f, s, value: f(s, 1 / (1 / value))
    ),
    "search_goes_one_way": [
        target("in words", "returned 'much'", searches(measure=lambda step: "much")),
        Broken("searches the wrong way", Marked("NOT_REACHED"), target=falling),
    ],
    "step_has_what_is_prescribed": Broken(
        "means another volume", OWN, target=lambda f, setting, value: f(setting, 0.6 * value)
    ),
}
PRESCRIPTIONS = Family(Volume, {}, {"run": _run}, ("run",), BROKEN)
