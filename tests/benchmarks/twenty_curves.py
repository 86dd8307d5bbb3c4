"""Twenty curves of a laboratory as tables in a folder, and what is true of each beside them.

    python tests/benchmarks/twenty_curves.py curves truth.csv [seed]
    pellicle fit curves --indenter paraboloid --radius "5 um"

Somebody who has not seen the truth says of each, from what the terminal prints, whether a tension
is needed, modulus and tension, and whether it is to be distrusted.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from fit_verdicts import TOP, Truth, rows_of, truth_of

from tests.physics.frozen.fit_curves import MODULUS, Array


class Case(NamedTuple):
    """A solid, and what went wrong as it was measured."""

    kind: str
    fault: str = ""
    protocol: str = "both"
    noise: float = 0.005


CASES = (
    *(Case("tension"), Case("tension"), Case("tension"), Case("tension", protocol="approach")),
    *(Case("hertz"), Case("hertz", protocol="approach"), Case("hertz", noise=0.03)),
    *(Case("thin layer"), Case("thin layer", protocol="approach"), Case("thick layer")),
    *(Case("power law"), Case("standard linear"), Case("adhesion"), Case("worn tip")),
    Case("hertz", "tilted baseline"),
    Case("tension", "tilted baseline"),
    Case("hertz", "force before contact"),
    Case("hertz", "missed contact"),
    Case("tension", "spikes"),
    Case("softening"),
)
FAULTY = {"softening", "thin layer", "thick layer"}
"""Solids of which a curve is to be distrusted, although nothing went wrong."""


def measured(case: Case, random: np.random.Generator) -> tuple[Array, Truth]:
    """Return columns of tip position [m], force [N] and time [s], shape (n, 3), and the truth."""
    (rows,) = rows_of(case.protocol, TOP)
    truth = truth_of(case.kind, random)
    force = truth.force(rows)
    largest = float(force.max())
    force = force + case.noise * largest * random.standard_normal(force.size)
    keep = np.ones(force.size, dtype=bool)
    match case.fault:
        case "tilted baseline":
            force += 0.04 * largest * (rows.depth - rows.depth[0]) / TOP
        case "force before contact":
            force += 0.06 * largest
        case "missed contact":
            keep = rows.depth > 0.25 * TOP
        case "spikes":
            force[random.choice(force.size, 8, replace=False)] += 0.5 * largest
    table = np.column_stack([rows.depth + random.uniform(1e-6, 3e-6), force, rows.time])
    return table[keep], truth


def main() -> None:
    """Write the tables, in an order of chance, and what is true of them."""
    folder, answers = Path(sys.argv[1]), Path(sys.argv[2])
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    folder.mkdir(parents=True, exist_ok=True)
    random, lines = np.random.default_rng(seed), []
    for number, case in enumerate(random.permutation(len(CASES)), 1):
        chosen = CASES[case]
        table, truth = measured(chosen, random)
        path = folder / f"{number:02}.csv"
        head = "position [um],force [nN],time [s]"
        np.savetxt(path, table * [1e6, 1e9, 1], "%.7g", ",", header=head, comments="")
        distrust = bool(chosen.fault) or chosen.kind in FAULTY
        # The approach takes 1 s.
        lines.append((path.name, *chosen, MODULUS * truth.relaxed(1.0), truth.tension, distrust))
    with answers.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        heads = "curve", "kind", "fault", "protocol", "noise", "modulus [Pa]", "tension [N/m]"
        writer.writerow((*heads, "to be distrusted"))
        writer.writerows(lines)


if __name__ == "__main__":
    main()
