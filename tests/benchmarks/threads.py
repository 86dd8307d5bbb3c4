"""What threads gain in a whole solve, and in the bare Fourier transforms that it contains.

Prints for each case the seconds of a solve on one thread and on several, the ratio of the two, the
same ratio of a bare scipy.fft.rfft2 and irfft2 of the transform's size in single and in double
precision, and the solve's gain over the larger of those. All are timed in turn, in one process;
each number is a median. The pressures have to be equal to the last bit.

    OMP_NUM_THREADS=1 python tests/benchmarks/threads.py --points 32 64 128 256 512 1024 2048

The cases are those of cost.py. Run it on an idle machine: the times are those of a clock.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import product
from statistics import median

import cost
import numpy as np
import scipy.fft
from tables import print_head, print_row

import pellicle as pl


def seconds(work: Callable[[], object], threads: int) -> float:
    """Return the time of one call on a number of threads."""
    with scipy.fft.set_workers(threads):
        started = time.perf_counter()
        work()
        return time.perf_counter() - started


def bare_pair(shape: tuple[int, int], precision: str) -> Callable[[], object]:
    """Return a function that transforms an array forth and back, in as many pairs as take 2 ms."""
    field = np.random.default_rng(0).normal(size=shape).astype(precision)
    number = max(1, 2**17 // field.size)

    def transform() -> None:
        for _ in range(number):
            scipy.fft.irfft2(scipy.fft.rfft2(field), s=shape)

    return transform


def row(case: str, points: int, tension: float, threads: int, repeats: int) -> None:
    """Print the row of a case."""
    problem, tolerance, _ = cost.problem(case, points, tension)
    solver = pl.solver("active_set", tolerance=tolerance)
    pressures = []

    def solve() -> None:
        pressures.append(solver.solve(problem, None, lambda *_: None).pressure)

    padded = problem.operator.padded
    works = [solve, bare_pair(padded, "float32"), bare_pair(padded, "float64")]
    times: list[list[list[float]]] = [[[], []] for _ in works]
    for repeat in range(repeats + 1):
        for work, both in zip(works, times, strict=True):
            for number, measured in zip((1, threads), both, strict=True):
                taken = seconds(work, number)
                # What the first time takes besides is not part of it.
                if repeat:
                    measured.append(taken)
    one, several = (median(measured) for measured in times[0])
    gains = [median(both[0]) / median(both[1]) for both in times]
    same = all(np.array_equal(pressure, pressures[0]) for pressure in pressures)
    print_row(
        *(case, f"{tension:g}", points, threads, f"{one:.3f}", f"{several:.3f}"),
        *(f"{gain:.2f}" for gain in (*gains, gains[0] / max(gains[1:]))),
        "same" if same else "DIFFERENT",
    )


def main() -> None:
    """Measure every case and print the table."""
    parser = cost.case_options(__doc__, [256, 512, 1024], [0.0, 0.02])
    parser.add_argument("--threads", type=int, nargs="+", default=[2])
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    print_head(
        *("case", "s/L", "N", "threads", "one [s]", "several [s]", "one ÷ several"),
        *("pair, single", "pair, double", "gain ÷ pair's", "bits"),
    )
    for case, tension, points, threads in product(
        options.cases, options.tension, options.points, options.threads
    ):
        row(case, points, tension, threads, options.repeats)


if __name__ == "__main__":
    main()
