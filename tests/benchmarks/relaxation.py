"""Contacts of solids that relax against closed theory, and what their steps cost.

Without an option, prints three tables. A paraboloid on a solid with a power law, pressed in for 1 s
and drawn back at the same speed in n steps each way, spaced as t ∝ i^p on the way in, on N cells
along 2.6 √(Rδ): largest error of the force over the largest force and, once the contact has 100
cells, over its own value (Lee & Radok 1960); the time of lost contact (Ting 1966), at which F^(2/3)
of the last two steps in contact vanishes. Then a flat punch with a tensed skin after a step of its
depth, against tests/data/visco_punch.csv and its extrapolation over two grids; and what a domain of
fewer contact radii changes.

    python tests/benchmarks/relaxation.py            # a few minutes
    python tests/benchmarks/relaxation.py --cost     # 100 steps of 256² cells, five branches
"""

from __future__ import annotations

import argparse
import csv
import time
import warnings
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import beta
from tables import print_head, print_row

import pellicle as pl

MODULUS, RADIUS, DEPTH = 1e4, 1e-3, 1e-5
TABLE = Path(__file__).parents[1] / "data" / "visco_punch.csv"
# The times of the table and some in between: outside the punch the surface moves.
TIMES = np.array([0.0, 0.03, 0.1, 0.2, 0.3, 0.6, 1.0, 1.7, 3.0, 5.0, 10.0])
DECADES = [{"fraction": 0.16, "time": 10.0**n} for n in range(-2, 3)]


def half_space(modulus: float = MODULUS) -> dict[str, Any]:
    """Return an elastic half-space."""
    return {"type": "half_space", "reduced_modulus": modulus}


def solved(**tables: Any) -> Any:
    """Return the dataset of a run."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pl.ConvergenceWarning)
        return pl.run(tables, progress=False).dataset


def triangle(exponent: float, points: int, number: int, power: float) -> tuple[float, ...]:
    """Return errors of the force over the largest and its own, and of the time of lost contact."""
    way_in = (np.arange(number + 1) / number) ** power
    times = np.concatenate([way_in, np.linspace(1, 2, number + 1)[1:]])
    law = {"exponent": exponent, "time": 1.0, "shortest": way_in[1] / 100, "longest": 10.0}
    data = solved(
        grid={"points": points, "size": 2.6 * np.sqrt(RADIUS * DEPTH), "boundary": "free"},
        kernel={"type": "viscoelastic", "solid": half_space(), "power_law": law},
        indenter={"type": "paraboloid", "radius": RADIUS},
        loading={"depth": (DEPTH * (1 - np.abs(1 - times))).tolist(), "time": times.tolist()},
        solver={"type": "active_set", "tolerance": 1e-8},
    )
    force = data["force"].values
    factor = 2 * np.sqrt(RADIUS) * MODULUS * DEPTH**1.5 * beta(1.5, 1 - exponent)
    expected = factor * way_in ** (1.5 - exponent)
    error = np.abs(force[: number + 1] - expected)
    cells = data["contact"].values[: number + 1].sum(axis=(1, 2))
    own = error[cells >= 100] / expected[cells >= 100]
    before, last = np.flatnonzero(force > 0)[-2:]
    rate = (force[before] ** (2 / 3) - force[last] ** (2 / 3)) / (times[last] - times[before])
    lost = times[last] + force[last] ** (2 / 3) / rate
    ratio = 2 ** (1 / (1 - exponent))
    applications = data["operator_applications"].values.mean()
    return error.max() / expected[-1], own.max(), lost / (ratio / (ratio - 1)) - 1, applications


def print_triangles(grids: list[tuple[int, int]], powers: list[float]) -> None:
    """Print the table of Lee & Radok and of Ting."""
    print_head("α", "N", "n", "p", "force, largest", "force, own", "lost", "applications per step")
    for exponent, power, (points, number) in product((0.1, 0.2, 0.3), powers, grids):
        largest, own, lost, applications = triangle(exponent, points, number, power)
        print_row(
            *(exponent, points, number, f"{power:g}", f"{largest:.1e}", f"{own:.2%}"),
            *(f"{lost:+.1e}", f"{applications:.1f}"),
        )


def punch(points: int, size: float = 8.0, tension: float = 0.5) -> Any:
    """Return the force on a flat punch of radius 1 m after a step of 1 m, E* = 5 to 1 Pa."""
    relaxation = [{"fraction": 0.8, "time": 1.0}]
    solid = {"type": "viscoelastic", "solid": half_space(5.0), "relaxation": relaxation}
    data = solved(
        grid={"points": points, "size": size, "boundary": "free"},
        kernel={"type": "coated", "tension": tension, "substrate": solid},
        indenter={"type": "flat_punch", "radius": 1.0},
        loading={"depth": [1.0] * TIMES.size, "time": TIMES.tolist()},
        solver={"type": "active_set", "tolerance": 1e-7},
    )
    return data["force"].values


def print_punch() -> None:
    """Print errors against the reference table, in per cent."""
    lines = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if line[0] != "#"]
    rows = [row for row in csv.DictReader(lines) if float(row["tau0_over_Einf_a"]) == 0.5]
    wanted = np.searchsorted(TIMES, [float(row["t_over_T"]) for row in rows])
    expected = np.array([float(row["P_over_Einf_a_delta"]) for row in rows])
    print()
    print_head("cells along 8 a", *(f"t = {TIMES[n]:g}" for n in wanted))
    forces = {str(points): punch(points)[wanted] for points in (62, 112)}
    forces["extrapolated"] = (112 * forces["112"] - 62 * forces["62"]) / (112 - 62)
    for name, force in forces.items():
        print_row(name, *(f"{error:+.2%}" for error in force / expected - 1))


def print_cost(points: int, steps: int) -> None:
    """Print applications and processor time per equal step, over those of an elastic solid."""
    print_head("skin", "solid", "applications per step", "seconds")
    depths, times = np.linspace(0, 2e-5, steps + 1)[1:], np.linspace(0, 10, steps)
    relaxing = {"type": "viscoelastic", "solid": half_space(), "relaxation": DECADES}
    for tension in (0.0, 0.02):
        for name, solid in (("elastic", half_space()), ("five branches", relaxing)):
            kernel = {"type": "coated", "tension": tension, "substrate": solid}
            started = time.process_time()
            data = solved(
                grid={"points": points, "size": 1.2e-3, "boundary": "free"},
                kernel=kernel if tension else solid,
                indenter={"type": "paraboloid", "radius": RADIUS},
                loading={"depth": depths.tolist(), "time": times.tolist()},
                solver={"type": "active_set", "tolerance": 1e-6},
            )
            seconds = time.process_time() - started
            used = data["operator_applications"].values.mean()
            shown = (f"{value:.1f}" for value in (used, seconds))
            print_row(f"{tension:g} N/m", name, *shown)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cost", action="store_true", help="print costs, not errors")
    parser.add_argument("--points", type=int, default=256, help="cells each way, with --cost")
    parser.add_argument("--steps", type=int, default=100, help="steps, with --cost")
    options = parser.parse_args()
    if options.cost:
        print_cost(options.points, options.steps)
        return
    print_triangles([(32, 25), (64, 50), (128, 100)], [1.0, 2.0])
    print_punch()


if __name__ == "__main__":
    main()
