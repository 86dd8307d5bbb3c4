"""What the next load step of a curve costs, over a cold solve of the same step.

Prints for each case: operator applications on the finest grid of a cold solve, of one started from
the step before, and of the linear solve alone if the contact were known beforehand, which is what
no search for the contact can beat; then the time of the started solve over that of the cold one.

    python tests/benchmarks/next_step.py --points 512 --steps 0.05 0.01
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from itertools import product

import cost
import numpy as np
import scipy.fft

import pellicle as pl
from pellicle.numerics.initial_guess import with_force
from pellicle.operators import Array
from pellicle.problem import Problem, height_scale
from pellicle_plugins.solvers.contact_cg import inner_solve
from pellicle_plugins.solvers.preconditioner import Preconditioner


def solved(
    problem: Problem, tolerance: float, start: Array | None, repeats: int
) -> tuple[Array, int, float]:
    """Return the pressure, the operator applications and the least processor time."""
    best = np.inf
    for _ in range(repeats):
        before, started = problem.operator.applications, time.process_time()
        solver = pl.solver("active_set", tolerance=tolerance)
        state = None if start is None else pl.State(start, start, problem.value)
        pressure = solver.solve(problem, state, lambda *_: None).pressure
        best = min(best, time.process_time() - started)
        used = problem.operator.applications - before
    return pressure, used, best


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
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cases", nargs="+", default=["rough", "punch", "smooth"])
    parser.add_argument("--points", type=int, nargs="+", default=[512])
    parser.add_argument("--tension", type=float, nargs="+", default=[0.0, 0.02, 1.0])
    parser.add_argument("--steps", type=float, nargs="+", default=[0.05, 0.01])
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    print("| case | s/L | N | step | cold | started | contact known | time, started ÷ cold |")
    print("|" + " --- |" * 8)
    for case, tension, points, step in product(
        options.cases, options.tension, options.points, options.steps
    ):
        given, tolerance, _ = cost.problem(case, points, tension)
        with scipy.fft.set_workers(1):
            before, _, _ = solved(given, tolerance, None, 1)
            following = replace(given, value=given.value * (1 + step))
            answer, cold, cold_time = solved(following, tolerance, None, options.repeats)
            _, warm, warm_time = solved(following, tolerance, before, options.repeats)
            known = with_known_contact(following, tolerance, before, answer)
        print(
            f"| {case} | {tension:g} | {points} | {step:.0%} | {cold} | {warm} | {known} "
            f"| {warm_time / cold_time:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
