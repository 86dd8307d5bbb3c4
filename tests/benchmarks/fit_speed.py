"""How much faster fits are than those of another version, and whether they say the same.

    python tests/benchmarks/fit_verdicts.py outcomes.jsonl 5 501        in each of two trees
    python tests/benchmarks/fit_speed.py before.jsonl after.jsonl [curves of a folder]

The times are processor time of fits with all rivals.  With a number, a folder of that many curves
of each kind is fitted as well, alike but for noise, modulus and contact point, for the time of a
curve in it and for verdicts beside those with every rival.
"""

from __future__ import annotations

import csv
import json
import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from fit_verdicts import NOISE, TOP, pink, rows_of, truth_of

import pellicle as pl
from tests.physics.frozen.fit_curves import RADIUS

_HEAD = (
    *("kind", "protocol", "curves", "before [s]", "after [s]", "factor"),
    *("same verdict", "same choice", "same ties"),
    *("in a folder [s]", "factor in a folder", "same verdict in a folder"),
)
_OF_CURVES = 9
"""Columns of a row without a folder."""


def compared(before: Sequence[Mapping[str, Any]], after: Sequence[Mapping[str, Any]]) -> Any:
    """Return pairs of outcomes of the same curve, by kind and protocol."""
    known = {(o["kind"], o["protocol"], o["number"], o["seed"]): o for o in before}
    found: dict[tuple[str, str], list[Any]] = defaultdict(list)
    for new in after:
        old = known.get((new["kind"], new["protocol"], new["number"], new["seed"]))
        if old is not None:
            found[new["kind"], new["protocol"]].append((old, new))
    return found


def folder(kind: str, protocol: str, count: int) -> tuple[float, int]:
    """Return the processor time of a curve in a folder [s], and how many verdicts stay."""
    random = np.random.default_rng([501, *f"{kind}, {protocol}".encode()])
    truth, share = truth_of(kind, random), random.uniform(*NOISE)
    (rows,) = rows_of(protocol, TOP)
    exact, curves = truth.force(rows), {}
    for number in range(count):
        draw = pink(random, exact.size) if truth.coloured else random.standard_normal(exact.size)
        noise = share * random.lognormal(0, 0.1) * np.abs(exact).max() * draw
        force = random.lognormal(0, 0.1) * (exact + noise)
        base = rows.depth + random.uniform(0, 2e-6)
        curves[str(number)] = base - (force / truth.spring if truth.spring else 0.0), force
    options: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS, "progress": False}
    options["segment"] = "both" if protocol == "both" else "approach"
    if truth.spring:
        options["spring_constant"] = truth.spring
    if "weighed" in truth.kind:
        options |= {"uncertainty": {"sensitivity": "6 %"}}
    began = process_time()
    spared = pl.fit_many(curves, **options)
    seconds = (process_time() - began) / count
    whole = pl.fit_many(curves, every_rival=True, **options)
    return seconds, int((spared["verdict"] == whole["verdict"]).sum())


def main() -> None:
    """Print a CSV with a row for each kind and protocol, below what all of them come to."""
    before, after = (
        [json.loads(line) for line in Path(name).read_text(encoding="utf-8").splitlines()]
        for name in sys.argv[1:3]
    )
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    rows, same, total = [], np.zeros(3, dtype=int), 0
    for (kind, protocol), pairs in compared(before, after).items():
        old, new = (median(pair[side]["seconds"] for pair in pairs) for side in (0, 1))
        factor = median(a["seconds"] / b["seconds"] for a, b in pairs)
        equal = [sum(a[k] == b[k] for a, b in pairs) for k in ("verdict", "chosen", "tied")]
        in_folder: list[float] = []
        if count and protocol != "speeds":
            seconds, verdicts = folder(kind, protocol, count)
            in_folder = [round(seconds, 3), round(old / seconds, 1), verdicts]
        numbers = [len(pairs), round(old, 2), round(new, 2), round(factor, 1)]
        rows.append([kind, protocol, *numbers, *equal, *in_folder])
        same, total = same + equal, total + len(pairs)
    factors = [row[5] for row in rows]
    print(
        "# Processor time of fits with all rivals, before and after, and whether they say the same."
    )
    print(f"# Factors: median {median(factors):.1f}, least {min(factors)}, most {max(factors)}.")
    verdicts, chosen, tied = same
    print(f"# Of {total} curves {verdicts} have the same verdict, {chosen} the same choice,")
    print(f"# {tied} the same ties.")
    if folders := [row for row in rows if len(row) > _OF_CURVES]:
        gains = [row[10] for row in folders]
        kept = sum(row[11] for row in folders)
        print(
            f"# In folders of {count}: median {median(gains):.1f}, least {min(gains)}; verdicts as"
        )
        print(f"# with every rival in {kept} of {count * len(folders)} curves.")
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerows([_HEAD, *rows])


if __name__ == "__main__":
    main()
