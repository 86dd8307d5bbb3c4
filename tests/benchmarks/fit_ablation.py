"""What each constant of the searches of fits, and each rival, is worth.

    python tests/benchmarks/fit_ablation.py 1 >docs/measurements/fit_ablation.csv

Curves of the kinds of `fit_verdicts`, so many of each, are fitted with each rival left out and, of
some kinds, with each constant at half and at twice its value.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from fit_verdicts import KINDS, NOISE, TOP, fitted, held, rows_of, truth_of

import pellicle as pl
from pellicle_fit import balance, explanation
from pellicle_fit.config import DEFAULT_RIVALS
from pellicle_fit.contact import curve
from pellicle_fit.estimation import intervals, objective, search, starts
from pellicle_fit.explanation import Explanation
from pellicle_fit.selection import rivals
from tests.physics.frozen.fit_curves import MODULUS

CONSTANTS: dict[ModuleType, tuple[str, ...]] = {
    search: (
        *("_MOST", "_TRIES", "_DAMPING", "_ROUGHLY", "_LEAST", "_LARGEST", "_SHORT"),
        *("_EASED", "_STIFFENED", "_HOPE", "_STALLED"),
        *("_FALL", "_ROUGH_FALL", "_SHARE", "_ROUGH_SHARE"),
    ),
    starts: ("_POINTS", "_EARLIER", "_LAST", "_KEPT", "_GUESS"),
    rivals: (
        *("_ROWS", "_FEW", "_FAR", "_NEAR", "_LEADS", "_BESIDE"),
        *("_STARTS", "_STEPS", "_KEPT", "_LOWER", "_COMPARED"),
    ),
    intervals: (
        *("_REACH", "_FAR", "_NEAR", "_SMALL", "_STEPS"),
        *("_PROFILE", "_IMPROVEMENT", "_RESTARTS", "_ALIKE"),
    ),
    objective: ("_STEP",),
    curve: ("_NEIGHBOURS", "_CLEAR", "_WAYS", "_COARSE"),
    explanation: ("_LEAST",),
    balance: ("_BALANCE", "_HALVED", "_LOST", "_LONGEST", "_FAR", "_STEPS", "_SECANTS"),
}
SOME = (
    *("hertz", "standard linear", "adhesion", "drag", "thin layer", "worn tip", "brush"),
    *("stiff surface", "softening", "tension"),
)
"""Kinds on which constants are changed."""
MOVED = 0.02
"""Move of an end of an interval that counts, over its width."""
HEADS = "changed,value,verdicts,choices,ends,modulus_held,of,forces"


class Outcome(NamedTuple):
    """What the fit of a curve says, and what it costs."""

    kind: str
    verdict: str
    selected: frozenset[str]
    ends: tuple[float | None, ...]
    """Of the intervals of modulus and tension."""
    is_held: bool
    forces: int
    """Forces that were computed, one for each row and trial."""


@contextmanager
def changed(module: ModuleType, name: str, value: object) -> Iterator[None]:
    """Give a constant another value, also where it is the default of an argument."""
    old, functions = getattr(module, name), [*vars(module).values()]
    setattr(module, name, value)
    put_back: list[tuple[FunctionType, Any, Any]] = []
    for function in functions:
        if isinstance(function, FunctionType):
            named = function.__kwdefaults__ or {}
            put_back.append((function, function.__defaults__, dict(named)))
            unnamed = function.__defaults__ or ()
            function.__defaults__ = tuple(value if x is old else x for x in unnamed) or None
            named.update({key: value for key, x in named.items() if x is old})
    try:
        yield
    finally:
        setattr(module, name, old)
        for function, unnamed, named in put_back:
            function.__defaults__, function.__kwdefaults__ = unnamed, named or None


@contextmanager
def counted() -> Iterator[list[int]]:
    """Count the forces that explanations compute."""
    count = [0]
    methods = {name: getattr(Explanation, name) for name in ("balance", "beside")}

    def counting(method: Any) -> Any:
        def of(*arguments: Any, **named: Any) -> Any:
            found = method(*arguments, **named)
            count[0] += np.size(found[0] if isinstance(found, tuple) else found)
            return found

        return of

    for name, method in methods.items():
        setattr(Explanation, name, counting(method))
    yield count
    for name, method in methods.items():
        setattr(Explanation, name, method)


def outcome(kind: str, number: int, **options: Any) -> Outcome:
    """Return what the fit of a curve says: of an approach or, of a drift, of both passes."""
    protocol = "both" if kind == "drift" else "approach"
    random = np.random.default_rng([number, *kind.encode()])
    truth, share = truth_of(kind, random), random.uniform(*NOISE)
    with counted() as count:
        fit = fitted(truth, protocol, share, random, **options)
    (rows,) = rows_of(protocol, TOP)
    modulus = MODULUS * truth.relaxed(float(rows.time[np.argmax(rows.depth)]))
    estimates: tuple[pl.Estimate, ...] = fit.reduced_modulus, fit.tension
    ends = tuple(end for one in estimates for end in (one.low, one.high))
    is_held = held(fit.reduced_modulus, modulus)
    return Outcome(kind, fit.verdict.name, fit.answer.selected.types, ends, is_held, count[0])


def outcomes(kinds: Sequence[str], curves: int, **options: Any) -> list[Outcome]:
    """Return what fits of so many curves of each kind say."""
    return [outcome(kind, number, **options) for kind in kinds for number in range(curves)]


def moves(one: Outcome, base: Outcome) -> bool:
    """Return whether an end of an interval is another."""
    for k in (0, 2):
        pairs = [*zip(one.ends[k : k + 2], base.ends[k : k + 2], strict=True)]
        if any((now is None) != (then is None) for now, then in pairs):
            return True
        known = [(now, then) for now, then in pairs if now is not None and then is not None]
        width = max((abs(a - b) for _, a in known for _, b in known), default=0.0)
        width = width or max((abs(then) for _, then in known), default=0.0)
        if any(abs(now - then) > MOVED * width for now, then in known):
            return True
    return False


def row(changed: str, value: object, found: Sequence[Outcome], base: Sequence[Outcome]) -> None:
    """Write a row: how many of the curves say something else."""
    pairs = [*zip(found, base, strict=True)]
    kinds = [one.kind for one, then in pairs if one.verdict != then.verdict]
    cells: Mapping[str, object] = {
        "changed": changed,
        "value": f"{value:.4g}" if isinstance(value, float) else value,
        "verdicts": "; ".join(kinds),
        "choices": sum(one.selected != then.selected for one, then in pairs),
        "ends": sum(moves(one, then) for one, then in pairs),
        "modulus_held": sum(one.is_held for one in found),
        "of": len(found),
        "forces": f"{sum(o.forces for o in found) / sum(o.forces for o in base):.3f}",
    }
    csv.writer(sys.stdout, lineterminator="\n").writerow(cells.values())
    sys.stdout.flush()


def main() -> None:
    """Write a row for each constant at half and twice its value, and for each rival left out."""
    curves = int(sys.argv[1])
    print(f"# script: python tests/benchmarks/fit_ablation.py {curves}; version: {pl.__version__}")
    print(
        f"# Curves of {len(SOME)} kinds (constants) and of {len(KINDS)} (rivals), {curves} of "
        "each, 350 rows, noise 0.3 to 1 %: kinds whose "
        "verdict changes, choices and intervals that change (an end by 2 % of the width), moduli "
        "that intervals hold, and forces computed over those of the values as they are."
    )
    print(HEADS)
    base = outcomes(SOME, curves)
    row("nothing", "", base, base)
    for module, names in CONSTANTS.items():
        for name in names:
            old = getattr(module, name)
            for factor in (0.5, 2.0):
                value = max(round(old * factor), 1) if isinstance(old, int) else old * factor
                with changed(module, name, value):
                    found = outcomes(SOME, curves)
                told = f"times {factor:g}" if isinstance(old, np.ndarray) else value
                row(f"{module.__name__.rpartition('.')[2]}.{name.strip('_')}", told, found, base)
    base = outcomes(KINDS, curves)
    row("no rival", "", base, base)
    for number, rival in enumerate(DEFAULT_RIVALS):
        others = [*DEFAULT_RIVALS[:number], *DEFAULT_RIVALS[number + 1 :]]
        words = rival if isinstance(rival, str) else " + ".join(rival)
        row(f"without {words}", "", outcomes(KINDS, curves, rivals=others), base)


if __name__ == "__main__":
    main()
