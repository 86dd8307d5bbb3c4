"""What a run costs, in units of the bare Fourier transforms that it contains.

Prints, for conjugate gradients on a tensed contact: operator applications, seconds, the ratio of
the whole solve to (applications × one bare scipy.fft pair of the padded size), the set-up in
operator applications, and the peak memory in arrays of the padded size. Each row is a process of
its own. Ratios are what is comparable: the machine is not.

    python tests/benchmarks/cost.py                # N = 256, 512, 1024; one thread and two
    python tests/benchmarks/cost.py --points 256
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def measure(boundary: str, points: int, threads: int, tolerance: float) -> dict[str, float]:
    """Return the costs of one solve in this process."""
    import numpy as np
    import scipy.fft

    import pellicle as pl
    from pellicle.operators import make_operator
    from pellicle.problem import Problem

    grid = pl.Grid(points=points, size=1.0, boundary=boundary)
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=0.01)
    indenter = pl.indenter(
        "self_affine", rms_height=0.01, hurst=0.8, cutoff_wavelength=16 / points, seed=1
    )
    solver = pl.solver("conjugate_gradient", tolerance=tolerance)
    before = _peak()
    with scipy.fft.set_workers(threads):
        started = time.perf_counter()
        operator = make_operator(kernel, grid)
        setup = time.perf_counter() - started
        problem = Problem(grid, operator, indenter.profile(*grid.coordinates()), "force", 0.02)
        operator(np.ones(grid.shape))
        one = _best(lambda: operator(np.ones(grid.shape)))
        used = operator.applications
        started = time.perf_counter()
        solution = solver.solve(problem, None, lambda iteration, excess: None)
        seconds = time.perf_counter() - started
        used = operator.applications - used
        peak = _peak() - before
        padded = [scipy.fft.next_fast_len(2 * points - 1, real=True)] * 2
        field = np.random.default_rng(0).normal(size=padded if boundary == "free" else grid.shape)
        pair = _best(lambda: scipy.fft.irfft2(scipy.fft.rfft2(field), s=field.shape))
    return {
        "iterations": solution.iterations,
        "applications": used,
        "seconds": seconds,
        "solve / bare pairs": seconds / (used * pair),
        "set-up / application": setup / one,
        "peak / padded array": peak / field.nbytes,
    }


def _best(work: object, repeats: int = 7) -> float:
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        work()  # type: ignore[operator]
        times.append(time.perf_counter() - started)
    return sorted(times)[len(times) // 2]


def _peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0


def main() -> None:
    """Measure every case in a process of its own and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--points", type=int, nargs="+", default=[256, 512, 1024])
    parser.add_argument("--tolerance", type=float, default=1e-4)
    parser.add_argument("--one", nargs=3, metavar=("BOUNDARY", "POINTS", "THREADS"))
    options = parser.parse_args()
    if options.one:
        boundary, points, threads = options.one
        found = measure(boundary, int(points), int(threads), options.tolerance)
        print(json.dumps(found))
        return
    print("boundary     N threads  iter  appl  seconds  solve/pairs  set-up/appl  peak/arrays")
    for boundary in ("free", "periodic"):
        for points in options.points:
            for threads in (1, 2):
                environment = os.environ | dict.fromkeys(THREAD_VARIABLES, str(threads))
                arguments = ["--tolerance", str(options.tolerance), "--one", boundary]
                done = subprocess.run(
                    [sys.executable, __file__, *arguments, str(points), str(threads)],
                    env=environment,
                    capture_output=True,
                    text=True,
                    check=True,
                )
                row = json.loads(done.stdout)
                print(
                    f"{boundary:9}{points:5}{threads:8}"
                    f"{row['iterations']:6}{row['applications']:6}{row['seconds']:9.2f}"
                    f"{row['solve / bare pairs']:13.2f}{row['set-up / application']:13.2f}"
                    f"{row['peak / padded array']:13.1f}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
