"""What solvers cost, in units of the bare Fourier transforms that they contain.

Prints for each case: applications of the operator on the finest grid, seconds, the ratio of the
whole solve to the bare scipy.fft pairs in double precision of all its applications of operator and
preconditioner on all its grids, the same to pairs in the precision that each application has, the
set-up in operator applications, and the peak memory in arrays of the transform's real size. Each
row is a process of its own; one thread is timed by its processor time. Ratios are what is
comparable: the machine is not.

    python tests/benchmarks/cost.py                                  # active_set, N = 256 … 1024
    python tests/benchmarks/cost.py --solvers active_set conjugate_gradient --points 256 512
    python tests/benchmarks/cost.py --cases punch --points 4096 --tension 0.02 --threads 2
    python tests/benchmarks/cost.py --cases rough --cutoff 0.0625    # one surface on every grid

Cases, lengths in units of the domain L, E* = 1, s = 2τ₀/E*:
rough   periodic, self-affine (H = 0.8, cut-off 16 cells or as given), to 1e-6 at a mean pressure of
        0.1 × rms slope
punch   free, self-affine (H = 0.7, rms 0.01, cut-off 16 cells), depth 0.1, to 1e-6
smooth  free, paraboloid of radius 2.236, depth 0.1118 (domain 2 a_H), to 1e-8
"""

import argparse
import resource
import time
from collections import Counter
from collections.abc import Callable
from itertools import product
from statistics import median
from typing import Any

import numpy as np
import scipy.fft
from tables import in_process, print_head, print_row

import pellicle as pl
from pellicle.contact import Problem
from pellicle.contact import measure as measure_pressure
from pellicle.surface import operator_of, operators
from pellicle_plugins.solvers import preconditioner


def problem(
    case: str, points: int, tension: float, cutoff: float | None = None
) -> tuple[Problem, float, float]:
    """Return the problem of a case, its tolerance, and the seconds that its operator took."""
    grid = pl.Grid(points=points, size=1.0, boundary="periodic" if case == "rough" else "free")
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=tension / 2)
    rough = {"rms_height": 0.01, "cutoff_wavelength": cutoff or 16 / points, "seed": 1}
    indenter = {
        "rough": lambda: pl.indenter("self_affine", hurst=0.8, **rough),
        "punch": lambda: pl.indenter("self_affine", hurst=0.7, **rough),
        "smooth": lambda: pl.indenter("paraboloid", radius=2.236),
    }[case]()
    profile = indenter.profile(*grid.coordinates())
    started = time.process_time()
    operator = operator_of(kernel, grid)
    setup = time.process_time() - started
    if case == "rough":
        slope = np.hypot(*np.gradient(profile, 1 / points))
        force = 0.1 * float(np.sqrt(np.mean(slope**2)))
        return Problem(grid, operator, profile, pl.Force(force)), 1e-6, setup
    depth, tolerance = (0.1, 1e-6) if case == "punch" else (0.1118, 1e-8)
    return Problem(grid, operator, profile, pl.Depth(depth)), tolerance, setup


def measure(
    case: str, tension: float, points: int, solver: str, threads: int, cutoff: float | None
) -> dict[str, object]:
    """Return the costs of one solve in this process."""
    clock = time.process_time if threads == 1 else time.perf_counter

    def seconds(work: Callable[[], object], repeats: int = 5) -> float:
        times = []
        for _ in range(repeats):
            started = clock()
            work()
            times.append(clock() - started)
        return median(times)

    with scipy.fft.set_workers(threads):
        # What is loaded on the way is not the solve's.
        small, loose, _ = problem(case, 32, tension)
        pl.solver(solver, tolerance=loose).solve(small, None, lambda *_: None)
        before = peak()
        given, tolerance, setup = problem(case, points, tension, cutoff)
        operator = given.operator
        operator(np.ones(given.grid.shape))
        one = seconds(lambda: operator(np.ones(given.grid.shape)))
        transforms: Counter[tuple[tuple[int, ...], str]] = Counter()
        for module in (operators, preconditioner):
            _count(module, transforms)
        used = operator.applications
        started = clock()
        solution = pl.solver(solver, tolerance=tolerance).solve(given, None, lambda *_: None)
        whole = clock() - started
        used = operator.applications - used
        highest = peak() - before
        double, own = (
            sum(
                number * seconds(_bare_pair(shape, dtype if in_own else "float64"))
                for (shape, dtype), number in list(transforms.items())
            )
            for in_own in (False, True)
        )
    state = measure_pressure(given, solution.pressure)
    return {
        "solved": solution.stop.name == "DONE" and bool(state.residual_contact <= tolerance),
        "iterations": solution.iterations,
        "applications": used,
        "seconds": whole,
        "ratio": whole / double,
        "own": whole / own,
        "setup": setup / one,
        "peak": highest / (8 * float(np.prod(operator.padded))),
        "contact": float(state.contact.mean()),
    }


def _count(module: Any, counts: Counter[tuple[tuple[int, ...], str]]) -> None:
    """Count the pairs of transforms that a module asks for, by their shape and type."""
    original = module.convolve

    def counted(field: Any, symbol: Any, padded: tuple[int, int], *others: Any) -> object:
        counts[padded, str(field.dtype)] += 1
        return original(field, symbol, padded, *others)

    module.convolve = counted


def _bare_pair(shape: tuple[int, ...], dtype: str) -> Callable[[], object]:
    # A free operator's pair is counted whole, though half of its rows are zeros and skipped.
    field = np.random.default_rng(0).normal(size=shape).astype(dtype)
    return lambda: scipy.fft.irfft2(scipy.fft.rfft2(field), s=shape)


def peak() -> float:
    """Return the largest memory that this process has had [byte]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0


def main() -> None:
    """Measure every case in a process of its own and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", nargs="+", default=["rough", "punch", "smooth"])
    parser.add_argument("--points", type=int, nargs="+", default=[256, 512, 1024])
    parser.add_argument("--tension", type=float, nargs="+", default=[0.0, 0.02, 1.0])
    parser.add_argument("--solvers", nargs="+", default=["active_set"])
    parser.add_argument("--cutoff", type=float, help="shortest wavelength over L, on every grid")
    parser.add_argument("--threads", type=int, nargs="+", default=[1])
    options = parser.parse_args()
    print_head(
        *("case", "s/L", "N", "solver", "threads", "contact", "iterations", "applications"),
        *("seconds", "solve ÷ pairs", "in own precision", "set-up ÷ application", "peak arrays"),
    )
    for case, tension, points, solver, threads in product(
        options.cases, options.tension, options.points, options.solvers, options.threads
    ):
        given = case, tension, points, solver, threads, options.cutoff
        row, _ = in_process(measure, *given, threads=threads)
        print_row(
            *(case, f"{tension:g}", points, solver if row["solved"] else f"{solver} not solved"),
            *(threads, f"{row['contact']:.3f}", row["iterations"], row["applications"]),
            *(f"{row['seconds']:.2f}", f"{row['ratio']:.2f}", f"{row['own']:.2f}"),
            *(f"{row['setup']:.1f}", f"{row['peak']:.1f}"),
        )


if __name__ == "__main__":
    main()
