"""What a study costs beside its solves, and what its runs cost.

Prints one of three tables, each timed in processes of their own, one thread a run:

efficiency  a study of equal runs by `serial`, by as many processes as it is given, and by the
            workers of a dask scheduler if its address is given: seconds, and the time by `serial`
            over that of all workers together
overhead    a study of tiny runs by each executor: seconds before the first run ends, and what each
            further run takes of a worker beside its solves, on average
cost        a run as a user has it, result file included, against N, boundary and tension: solves
            and seconds of each step, and the peak memory, measured and as `--dry-run` says it

    python tests/benchmarks/study.py efficiency --points 512 --runs 16
    python tests/benchmarks/study.py overhead --runs 200
    python tests/benchmarks/study.py cost --points 256 512 1024 2048

Runs are like those of cost.py: `rough` is periodic, `punch` free, both self-affine; lengths in
units of the domain L, E* = 1, s = 2τ₀/E*. The runs of a study are punches with s/L = 0.02 that
differ by 1e-9 in tension, so that they cost the same and are not the same.
"""

import argparse
import tempfile
import time
from itertools import product
from typing import Any

from cost import case_options, peak
from tables import in_process, print_head, print_row

import pellicle as pl
from pellicle.runs.memory_estimate import memory_of

EXECUTORS = ("serial", "processes", "dask")


def run_of(case: str, points: int, tension: float, steps: int = 1) -> dict[str, Any]:
    """Return a run: pressed in `steps` equal steps, to 1e-6."""
    boundary, name, last = {
        "rough": ("periodic", "mean_pressure", 0.02),
        "punch": ("free", "depth", 0.1),
    }[case]
    rough = {"rms_height": 0.01, "hurst": 0.8, "cutoff_wavelength": 16 / points, "seed": 1}
    return {
        "grid": {"points": points, "size": 1.0, "boundary": boundary},
        "kernel": {"type": "tensed_membrane", "reduced_modulus": 1.0, "tension": tension / 2},
        "indenter": {"type": "self_affine", **rough},
        "loading": {name: [last * (step + 1) / steps for step in range(steps)]},
        "solver": {"type": "active_set", "tolerance": 1e-6},
        "outputs": [],
    }


def carry_out(executor: dict[str, Any], points: int, runs: int, steps: int) -> tuple[float, float]:
    """Return the time of a study of equal runs, and that of its solves [s]."""
    run = run_of("punch", points, 0.02, steps)
    tensions = [run["kernel"]["tension"] * (1 + 1e-9 * number) for number in range(runs)]
    study = pl.Study(run=run, vary={"kernel.tension": tensions}, executor=executor)
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        table = pl.run_study(study, folder, progress=False, threads=1)
        seconds = time.perf_counter() - started
    assert table["converged"].all()
    return seconds, float(table["wall_time"].sum())


def run_alone(case: str, tension: float, points: int, steps: int) -> dict[str, Any]:
    """Return what a run in this process costs."""

    def carried_out(points: int) -> Any:
        with tempfile.TemporaryDirectory() as folder:
            given = run_of(case, points, tension, steps)
            return pl.run(given, directory=folder, progress=False, threads=1)

    # Libraries are loaded by then.
    carried_out(32)
    before, started = peak(), time.process_time()
    data = carried_out(points).dataset
    seconds, highest = time.process_time() - started, peak() - before
    return {
        "converged": bool(data["converged"].all()),
        "contact": float(data["contact_fraction"][-1]),
        "applications": float(data["operator_applications"].mean()),
        "seconds": seconds / steps,
        "peak": highest,
        "estimate": memory_of(pl.Run(**run_of(case, points, tension, steps))),
    }


def executors(options: argparse.Namespace) -> list[tuple[str, int, dict[str, Any]]]:
    """Return name, number of workers and configuration of each executor."""
    more = {"processes": {"workers": options.workers}, "dask": {"address": options.address}}
    return [
        (name, options.workers if name in more else 1, {"type": name, **more.get(name, {})})
        for name in options.executors
    ]


def print_efficiency(options: argparse.Namespace) -> None:
    """Print how well workers share a study of equal runs."""
    print_head("executor", "workers", "N", "runs", "seconds", "serial ÷ (workers × seconds)")
    for points in options.points:
        alone = 0.0
        for name, workers, executor in executors(options):
            given = executor, points, options.runs, options.steps
            (seconds, _), _ = in_process(carry_out, *given)
            alone = seconds if name == "serial" else alone
            share = alone / (workers * seconds)
            print_row(name, workers, points, options.runs, f"{seconds:.2f}", f"{share:.3f}")


def print_overhead(options: argparse.Namespace) -> None:
    """Print what an executor takes for each run beside its solves."""
    print_head(
        *("executor", "workers", "runs", "seconds of one run", "seconds of all"),
        "ms beside, each",
    )
    for name, workers, executor in executors(options):
        (one, solving_one), _ = in_process(carry_out, executor, 16, 1, options.steps)
        (all_, solving), _ = in_process(carry_out, executor, 16, options.runs, options.steps)
        overhead = (workers * (all_ - one) - solving + solving_one) / (options.runs - 1)
        shown = f"{one:.2f}", f"{all_:.2f}", f"{overhead * 1e3:.1f}"
        print_row(name, workers, options.runs, *shown)


def print_cost(options: argparse.Namespace) -> None:
    """Print what a run costs."""
    print_head(
        *("boundary", "s/L", "N", "steps", "contact", "applications a step", "seconds a step"),
        *("peak MB", "MB by --dry-run"),
    )
    for case, tension, points in product(options.cases, options.tension, options.points):
        costs, _ = in_process(run_alone, case, tension, points, options.steps)
        boundary = run_of(case, points, tension)["grid"]["boundary"]
        print_row(
            boundary if costs["converged"] else f"{boundary} not converged",
            *(f"{tension:g}", points, options.steps, f"{costs['contact']:.3f}"),
            *(f"{costs['applications']:.1f}", f"{costs['seconds']:.3f}"),
            *(f"{costs['peak'] / 1e6:.0f}", f"{costs['estimate'] / 1e6:.0f}"),
        )


TABLES = {"efficiency": print_efficiency, "overhead": print_overhead, "cost": print_cost}


def main() -> None:
    """Print the table that is asked for."""
    parser = case_options(__doc__, [512], [0.0, 0.02, 1.0])
    parser.add_argument("table", choices=list(TABLES))
    parser.add_argument("--steps", type=int, default=1)
    parser.add_argument("--runs", type=int, default=16)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--executors", nargs="+", default=EXECUTORS[:2], choices=EXECUTORS)
    parser.add_argument("--address", help="dask scheduler that has --workers workers of one thread")
    options = parser.parse_args()
    if "dask" in options.executors and not options.address:
        parser.error("--executors dask needs --address")
    TABLES[options.table](options)


if __name__ == "__main__":
    main()
