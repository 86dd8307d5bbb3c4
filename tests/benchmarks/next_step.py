"""What the load steps of a curve cost, over cold solves of the same steps.

Each step is a given percentage above the one before. Prints for each case the mean operator
applications of a step on the finest grid: of a cold solve, of one started from the step before, of
one started from the last two, and of the linear solve alone if the contact were known beforehand,
which is what no search for the contact can beat; then the time of the path from two states over
that of the cold solves, first step included, as processor time of one thread, interleaved.

    python tests/benchmarks/next_step.py --points 512 --steps 0.02
"""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import product

import cost
import numpy as np
import scipy.fft
from tables import print_head, print_row

import pellicle as pl
from pellicle.arrays import Array
from pellicle.contact import Problem, State, height_scale, measure
from pellicle.contact.initial_guess import with_force
from pellicle.contact.load_step import FinishedStep, start_of
from pellicle_plugins.solvers.contact_cg import inner_solve
from pellicle_plugins.solvers.preconditioner import Preconditioner


def solved(problem: Problem, tolerance: float, start: State | None) -> tuple[Array, int, float]:
    """Return the pressure, the operator applications and the processor time."""
    before, started = problem.operator.applications, time.process_time()
    solver = pl.solver("active_set", tolerance=tolerance)
    pressure = solver.solve(problem, start, lambda *_: None).pressure
    return pressure, problem.operator.applications - before, time.process_time() - started


def with_known_contact(problem: Problem, tolerance: float, start: Array, answer: Array) -> int:
    """Return the applications of the linear solve alone on the contact of ``answer``."""
    contact = answer > 0
    before = problem.operator.applications
    pressure = with_force(problem, start * contact)
    displacement = problem.operator(pressure)
    u_minus_f = displacement - problem.profile
    depth = problem.depth(u_minus_f[contact])
    scale = height_scale(problem.profile, contact, depth)
    on_contact = Preconditioner(problem.operator).on(contact)
    error = float(np.abs(u_minus_f[contact] - depth).max())
    while error > tolerance * scale:
        inner = inner_solve(
            problem, on_contact, pressure, displacement, tolerance / 2 * scale, certainty=np.inf
        )
        pressure, displacement = inner.pressure, problem.operator(inner.pressure)
        u_minus_f = (displacement - problem.profile)[contact]
        error = float(np.abs(u_minus_f - problem.depth(u_minus_f)).max())
    return problem.operator.applications - before


def main() -> None:
    """Print the table."""
    parser = cost.case_options(__doc__, [512], [0.0, 0.02, 1.0])
    parser.set_defaults(cases=["rough", "punch", "smooth"])
    parser.add_argument("--steps", type=float, nargs="+", default=[0.02])
    parser.add_argument("--number", type=int, default=30)
    options = parser.parse_args()
    print_head(
        *("case", "s/L", "N", "step", "cold", "one state", "two states", "contact known", "time")
    )
    for case, tension, points, step in product(
        options.cases, options.tension, options.points, options.steps
    ):
        given, tolerance, _ = cost.problem(case, points, tension)
        sums, times, known = np.zeros(3), np.zeros(3), 0
        path: list[FinishedStep] = []
        with scipy.fft.set_workers(1):
            for index in range(options.number):
                value = given.value * (1 + step) ** index
                problem = replace(given, control=replace(given.control, value=value))
                last = path[-1].state if path else None
                for column, start in enumerate((None, last, start_of(problem, last, path))):
                    pressure, used, seconds = solved(problem, tolerance, start)
                    sums[column] += used
                    times[column] += seconds
                if last is not None:
                    known += with_known_contact(problem, tolerance, last.pressure, pressure)
                equilibrium = measure(problem, pressure)
                finished = FinishedStep.of(
                    {
                        "pressure": pressure,
                        "gap": equilibrium.gap,
                        "displacement": equilibrium.displacement,
                    },
                    {"depth": equilibrium.depth, "contact_area": 0.0, "converged": True},
                )
                path = [*path[-1:], finished]
        print_row(
            *(case, f"{tension:g}", points, f"{step:.0%}"),
            *(f"{value / options.number:.1f}" for value in sums),
            f"{known / max(1, options.number - 1):.1f}",
            f"{times[2] / times[0]:.2f}",
        )


if __name__ == "__main__":
    main()
