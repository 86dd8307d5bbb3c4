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

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from itertools import product
from pathlib import Path
from typing import Any

from cost import THREAD_VARIABLES

EXECUTORS = ("serial", "processes", "dask")
_EQUAL = {"cases": ["punch"], "tension": [0.02]}


def run_of(case: str, points: int, tension: float, steps: int = 1) -> dict[str, Any]:
    """Return a run: pressed in `steps` equal steps, to 1e-6."""
    boundary, load = {
        "rough": ("periodic", ("mean_pressure", 0.02)),
        "punch": ("free", ("depth", 0.1)),
    }[case]
    name, last = load
    rough = {"rms_height": 0.01, "hurst": 0.8, "cutoff_wavelength": 16 / points, "seed": 1}
    return {
        "grid": {"points": points, "size": 1.0, "boundary": boundary},
        "kernel": {"type": "tensed_membrane", "reduced_modulus": 1.0, "tension": tension / 2},
        "indenter": {"type": "self_affine", **rough},
        "loading": {name: [last * (step + 1) / steps for step in range(steps)]},
        "solver": {"type": "active_set", "tolerance": 1e-6},
        "outputs": [],
    }


def study_of(run: dict[str, Any], runs: int, executor: str, workers: int, address: str) -> Any:
    """Return a study of equal runs."""
    import pellicle as pl

    tension = run["kernel"]["tension"]
    more: dict[str, dict[str, Any]] = {
        "serial": {},
        "processes": {"workers": workers},
        "dask": {"address": address},
    }
    how = {"type": executor, **more[executor]}
    values = [tension * (1 + 1e-9 * number) for number in range(runs)]
    return pl.Study(run=run, vary={"kernel.tension": values}, executor=how)


def carry_out(options: argparse.Namespace) -> dict[str, float]:
    """Carry out a study in this process and return its times [s]."""
    import pellicle as pl

    run = run_of(options.cases[0], options.points[0], options.tension[0], options.steps)
    study = study_of(run, options.runs, options.executor, options.workers, options.address)
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        table = pl.run_study(study, folder, progress=False, threads=1)
        seconds = time.perf_counter() - started
    assert table["converged"].all()
    return {"seconds": seconds, "solving": float(table["wall_time"].sum())}


def run_alone(options: argparse.Namespace) -> dict[str, Any]:
    """Carry out a run in this process and return what it costs."""
    import pellicle as pl
    from pellicle import memory

    def carried_out(points: int) -> Any:
        case, tension = options.cases[0], options.tension[0]
        given = run_of(case, points, tension, options.steps) | {"outputs": []}
        with tempfile.TemporaryDirectory() as folder:
            return pl.run(given, directory=folder, progress=False, threads=1)

    # Libraries are loaded by then.
    carried_out(32)
    before, started = _peak(), time.process_time()
    data = carried_out(options.points[0]).dataset
    seconds, peak = time.process_time() - started, _peak() - before
    grid = pl.Grid(**run_of(options.cases[0], options.points[0], 0.0)["grid"])
    return {
        "converged": bool(data["converged"].all()),
        "contact": float(data["contact_fraction"][-1]),
        "applications": float(data["operator_applications"].mean()),
        "seconds": seconds / options.steps,
        "peak": peak,
        "estimate": memory.estimate(grid, options.steps),
    }


def _peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0


def print_efficiency(options: argparse.Namespace) -> None:
    """Print how well workers share a study of equal runs."""
    _head("executor", "workers", "N", "runs", "seconds", "serial ÷ (workers × seconds)")
    for points in options.points:
        alone = 0.0
        for executor in options.executors:
            workers = 1 if executor == "serial" else options.workers
            costs = _measured("carry_out", options, **_EQUAL, points=[points], executor=executor)
            alone = costs["seconds"] if executor == "serial" else alone
            share = alone / (workers * costs["seconds"])
            _row(executor, workers, points, options.runs, f"{costs['seconds']:.2f}", f"{share:.3f}")


def print_overhead(options: argparse.Namespace) -> None:
    """Print what an executor takes for each run beside its solves."""
    _head("executor", "workers", "runs", "seconds of one run", "seconds of all", "ms beside, each")
    for executor in options.executors:
        workers = 1 if executor == "serial" else options.workers
        tiny = {**_EQUAL, "points": [16], "executor": executor}
        one = _measured("carry_out", options, **tiny, runs=1)
        all_ = _measured("carry_out", options, **tiny)
        solving = all_["solving"] - one["solving"]
        overhead = (workers * (all_["seconds"] - one["seconds"]) - solving) / (options.runs - 1)
        shown = f"{one['seconds']:.2f}", f"{all_['seconds']:.2f}", f"{overhead * 1e3:.1f}"
        _row(executor, workers, options.runs, *shown)


def print_cost(options: argparse.Namespace) -> None:
    """Print what a run costs."""
    _head(
        *("boundary", "s/L", "N", "steps", "contact", "applications a step", "seconds a step"),
        *("peak MB", "MB by --dry-run"),
    )
    for case, tension, points in product(options.cases, options.tension, options.points):
        one = {"cases": [case], "tension": [tension], "points": [points]}
        costs = _measured("run_alone", options, **one)
        boundary = run_of(case, points, tension)["grid"]["boundary"]
        _row(
            boundary if costs["converged"] else f"{boundary} not converged",
            *(f"{tension:g}", points, options.steps, f"{costs['contact']:.3f}"),
            *(f"{costs['applications']:.1f}", f"{costs['seconds']:.3f}"),
            *(f"{costs['peak'] / 1e6:.0f}", f"{costs['estimate'] / 1e6:.0f}"),
        )


def _head(*names: str) -> None:
    _row(*names)
    print("|" + " --- |" * len(names), flush=True)


def _row(*cells: object) -> None:
    print(f"| {' | '.join(map(str, cells))} |", flush=True)


def _measured(what: str, options: argparse.Namespace, **changes: Any) -> dict[str, Any]:
    """Return what a function above returns in a process of its own."""
    given = json.dumps([what, {**vars(options), **changes}])
    done = subprocess.run(
        [sys.executable, __file__, "one", given],
        env=os.environ | dict.fromkeys(THREAD_VARIABLES, "1"),
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        cwd=Path(__file__).parent,
    )
    times: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return times


TABLES = {"efficiency": print_efficiency, "overhead": print_overhead, "cost": print_cost}


def main() -> None:
    """Print the table that is asked for."""
    if sys.argv[1:2] == ["one"]:
        what, given = json.loads(sys.argv[2])
        measure = {"carry_out": carry_out, "run_alone": run_alone}[what]
        print(json.dumps(measure(argparse.Namespace(**given))))
        return
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("table", choices=list(TABLES))
    parser.add_argument("--cases", nargs="+", default=["rough", "punch"])
    parser.add_argument("--points", type=int, nargs="+", default=[512])
    parser.add_argument("--tension", type=float, nargs="+", default=[0.0, 0.02, 1.0])
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
