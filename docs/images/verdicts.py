"""Draws ``verdicts.png``: what fits say of curves of known solids (docs/fit-method.md).

Run it as ``python docs/images/verdicts.py``; with the file of outcomes that
``tests/benchmarks/fit_verdicts.py`` leaves it first counts those, into
``docs/measurements/fit_verdicts.csv``.
"""

from __future__ import annotations

import csv
import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from pellicle.show import save_figure
from pellicle.show.figure_style import OKABE_ITO
from pellicle_fit.selection.verdict import Verdict

TABLE = Path(__file__).parents[1] / "measurements" / "fit_verdicts.csv"
ORDER = {
    Verdict.NEEDED: (OKABE_ITO[1], "tension is needed"),
    Verdict.CANNOT_TELL: (OKABE_ITO[4], "cannot tell"),
    Verdict.UNDESCRIBED: ("0.6", "no model describes"),
    Verdict.NO_SIGN: (OKABE_ITO[5], "no sign of tension"),
    Verdict.OTHER: (OKABE_ITO[0], "described better by another"),
}
"""Colour and words of each verdict."""
_FIRST = "hertz", "tension"
"""Solids at the top."""


def count(outcomes: Path) -> None:
    """Write a row for each kind of solid and protocol."""
    found = [json.loads(line) for line in outcomes.read_text(encoding="utf-8").splitlines()]
    rows = []
    for kind, protocol in sorted({(o["kind"], o["protocol"]) for o in found}):
        mine = [o for o in found if (o["kind"], o["protocol"]) == (kind, protocol)]
        counts = Counter(o["verdict"] for o in mine)
        could = [o for o in mine if (o["expected"] or 0) > 12]
        rows.append(
            {
                "kind": kind,
                "protocol": protocol,
                "curves": len(mine),
                **{v.name.lower(): counts[v.name] for v in ORDER},
                "could_be_found": len(could),
                "found": sum(o["verdict"] == "NEEDED" for o in could),
                "modulus_held": sum(o["modulus"] for o in mine),
                "tension_held": sum(o["tension"] for o in mine),
                "median_cpu_s": round(float(np.median([o["seconds"] for o in mine])), 1),
            }
        )
    heads = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if line[:1] == "#"]
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        file.write("".join(f"{line}\n" for line in heads))
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def draw(figure: Figure) -> None:
    """Draw the shares of verdicts for each kind of solid, and how often the intervals hold E*."""
    lines = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if line[:1] != "#"]
    total: dict[str, Counter[str]] = {}
    for row in csv.DictReader(lines):
        kind = total.setdefault(row["kind"], Counter())
        kind.update({k: int(v) for k, v in row.items() if v.isdigit() and k != "median_cpu_s"})
    kinds = [*_FIRST, *(kind for kind in total if kind not in _FIRST)][::-1]
    axes = figure.add_subplot()
    left = np.zeros(len(kinds))
    for verdict, (colour, words) in ORDER.items():
        share = np.array([total[k][verdict.name.lower()] / total[k]["curves"] for k in kinds])
        axes.barh(kinds, 100 * share, left=left, color=colour, label=words)
        left += 100 * share
    for y, kind in enumerate(kinds):
        held = f"{total[kind]['modulus_held']} of {total[kind]['curves']}"
        axes.text(102, y, held, va="center", fontsize="small")
    axes.text(102, len(kinds) - 0.2, "E* held", fontsize="small")
    axes.set(xlim=(0, 100), xlabel="share of curves [%]")
    figure.legend(loc="outside upper center", ncols=3, fontsize="small")


def main() -> None:
    """Count outcomes if they are given, and draw."""
    if len(sys.argv) > 1:
        count(Path(sys.argv[1]))
    save_figure(draw, Path(__file__).with_name("verdicts"), ["png"], (6.4, 5.4))


if __name__ == "__main__":
    main()
