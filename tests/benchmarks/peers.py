"""Pellicle and its peers on identical surfaces, at an accuracy measured by pellicle.

Prints the seconds and iterations that each code takes to press the same self-affine surface under
the same force. What a code returns is judged by `pellicle.problem.measure`: its own tolerance
starts at a value found by trial and is halved until the complementarity residual is under
``--target``; the residuals reached stand in the table. Each row is a process of its own.

Seconds are those from heights to pressure: operator, kernel and transform plans are made within
them, imports are not, and a small problem is solved first. Iterations are as each code counts them
and applications those of the operator, if it says; of nested grids those on the finest. Tension
reaches a peer through its own table of Fourier coefficients; the peers' solvers are untouched.

The tamaas wheel on PyPI is built with an FFTW 3.3.10 without SIMD (it has scalar codelets only)
and without threads; a tamaas built against a SIMD FFTW is faster.

    python -m pip install tamaas==2.9.0 ContactMechanics==1.8.3
    apt-get install -y g++ libeigen3-dev && python -m pip install ASPHER==0.1.3.post1

    python tests/benchmarks/peers.py                               # N = 256, 512; one thread
    python tests/benchmarks/peers.py --points 1024 2048 --threads 1 2
    python tests/benchmarks/peers.py --points --free 512 1024 --peers ASPHER
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
RMS_HEIGHT = 0.01  # in L; the edge L and the reduced modulus E* are 1
WARM_UP = 64
COLUMNS = {
    **{"code": "<28", "version": ">12", "boundary": ">9", "points": ">6", "s/L": ">6"},
    **{"threads": ">8", "iterations": ">11", "applications": ">13", "seconds": ">9.2f"},
    **{"complementarity": ">16.1e", "contact": ">9.1e", "penetration": ">12.1e", "ratio": ">7.2f"},
}
FOOTER = """
complementarity: Σ p|gap| / (Σ p × height range in contact); contact: max |gap| in contact and
penetration: max −gap outside, over the same range; all by a fresh application of pellicle's
operator. ratio: seconds over those of the first pellicle row of the same problem.
tamaas: the PyPI wheel ships an FFTW without SIMD; one built against a SIMD FFTW is faster."""


class UnsolvedError(Exception):
    """The code cannot solve this case; the message says why."""


@dataclass(frozen=True)
class Case:
    """A surface to press."""

    boundary: str
    points: int
    skin_length: float  # s/L, s = 2τ₀/E*
    threads: int
    cutoff: float  # shortest wavelength in cells
    load: float  # mean pressure over E* × rms slope
    seed: int

    @cached_property
    def problem(self) -> Any:
        """What pellicle solves, and what every pressure is measured against."""
        import numpy as np
        import scipy.fft

        import pellicle as pl
        from pellicle.operators import make_operator
        from pellicle.problem import Problem

        grid = pl.Grid(points=self.points, size=1.0, boundary=self.boundary)
        spectrum = {"hurst": 0.8, "cutoff_wavelength": self.cutoff / self.points}
        indenter = pl.indenter("self_affine", rms_height=RMS_HEIGHT, seed=self.seed, **spectrum)
        heights = indenter.profile(*grid.coordinates())
        q = 2 * np.pi * scipy.fft.fftfreq(self.points, 1 / self.points)
        modes = np.abs(scipy.fft.fft2(heights, norm="forward"))
        slope = float(np.sqrt(np.sum((q[:, None] ** 2 + q**2) * modes**2)))
        kernel = pl.kernel("half_space", reduced_modulus=1.0)
        if self.skin_length:
            kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=self.skin_length / 2)
        return Problem(grid, make_operator(kernel, grid), heights, "force", self.load * slope)


Solve = Callable[[Case, float], tuple[Any, int | None, int | None]]
"""From a case and the code's own tolerance to pressure, iterations and operator applications."""


@dataclass(frozen=True)
class Code:
    """How a code is driven."""

    module: str
    solve: Solve
    tolerance: float  # where its own tolerance starts: found by trial for a target of 1e-6
    has_threads: bool
    install: str = ""


def pellicle(solver: str) -> Code:
    """Return how one of pellicle's solvers is driven."""

    def solve(case: Case, tolerance: float) -> tuple[Any, int | None, int | None]:
        import pellicle as pl
        from pellicle.operators import make_operator

        try:
            method = pl.solver(solver, tolerance=tolerance)
        except pl.ConfigError:
            raise UnsolvedError("not registered") from None
        operator = make_operator(case.problem.operator.kernel, case.problem.grid)
        problem = replace(case.problem, operator=operator)
        found = method.solve(problem, None, lambda iteration, excess: None)
        return found.pressure, found.iterations, operator.applications

    return Code("pellicle", solve, 8e-6, has_threads=True)


def tamaas(case: Case, tolerance: float) -> tuple[Any, int | None, int | None]:
    """Solve with PolonskyKeerRey, whose log alone says the iterations."""
    import numpy as np
    import tamaas as tm

    tm.initialize(case.threads)
    tm.set_log_level(tm.LogLevel.info)
    model = tm.Model(tm.model_type.basic_2d, [1.0, 1.0], [case.points] * 2)
    model.E, model.nu = 1.0, 0.0
    solver = tm.PolonskyKeerRey(model, case.problem.profile, tolerance)
    solver.max_iter = solver.dump_freq = 1_000_000
    if case.boundary == "free":
        tm.ModelFactory.registerNonPeriodic(model, "free")
        solver.setIntegralOperator("free")
    else:
        # Made by the solver, and what it applies: an earlier change would not reach it.
        influence = model.operators["westergaard_neumann"]["influence"]
        influence[...] = tensed(influence, case.skin_length)
    solver.solve(case.problem.value)
    return np.array(model.traction), None, None


def contact_mechanics(case: Case, tolerance: float) -> tuple[Any, int | None, int | None]:
    """Solve with constrained_conjugate_gradients; the tolerance is that of penetration."""
    from ContactMechanics import FreeFFTElasticHalfSpace, PeriodicFFTElasticHalfSpace
    from ContactMechanics.Optimization import constrained_conjugate_gradients

    class Tensed(PeriodicFFTElasticHalfSpace):  # type: ignore[misc]
        def _compute_greens_function(self) -> Any:
            return tensed(super()._compute_greens_function(), case.skin_length)

    half_space = FreeFFTElasticHalfSpace if case.boundary == "free" else Tensed
    substrate = half_space((case.points, case.points), 1.0, (1.0, 1.0))
    aim = {"external_force": case.problem.value, "pentol": tolerance * RMS_HEIGHT}
    found = constrained_conjugate_gradients(substrate, case.problem.profile, **aim)
    if not found.success:
        raise UnsolvedError(found.message)
    return found.jac / substrate.area_per_pt, found.nit, found.nfev


def aspher(case: Case, tolerance: float) -> tuple[Any, int | None, int | None]:
    """Solve on nested grids, FFT operator and FFT preconditioner: what is quickest here."""
    import aspher as peer

    if case.skin_length:
        raise UnsolvedError("has no tension")
    found = peer.solve_nested(
        grid_size=case.points,
        gap=-case.problem.profile.ravel(),
        p_nominal=case.problem.value,
        coarsest=32,
        backend="fft" if case.boundary == "free" else "periodic",
        precond_engine="fft",
        tol=tolerance,
    )
    if not found.converged:
        raise UnsolvedError(f"{found.status} at its tolerance {tolerance:.1e}")
    pressure = found.pressure.reshape(case.problem.grid.shape)
    return pressure, found.iterations, found.matvec_count


def tensed(compliance: Any, skin_length: float) -> Any:
    """Return coefficients 2/q multiplied by 1/(1 + s q), in whatever order they are stored."""
    return compliance**2 / (compliance + 2 * skin_length + (compliance == 0))


NEEDS_COMPILER = "apt-get install -y g++ libeigen3-dev && pip install ASPHER==0.1.3.post1"
PEERS = {
    "tamaas": Code("tamaas", tamaas, 1.5e-5, False, "pip install tamaas==2.9.0"),
    "ContactMechanics": Code(
        "ContactMechanics", contact_mechanics, 1.6e-5, False, "pip install ContactMechanics==1.8.3"
    ),
    "ASPHER": Code("aspher", aspher, 1.6e-5, True, NEEDS_COMPILER),
}


def measure(code: Code, case: Case, repeats: int, target: float) -> dict[str, Any]:
    """Return seconds, iterations and residuals of one code in this process."""
    import scipy.fft

    from pellicle.problem import measure as judge

    times: list[float] = []

    def timed(tolerance: float) -> tuple[Any, int | None, int | None]:
        started = time.perf_counter()
        answer = code.solve(case, tolerance)
        times.append(time.perf_counter() - started)
        return answer

    with scipy.fft.set_workers(case.threads):
        code.solve(replace(case, points=WARM_UP), 1e-3)
        problem, tolerance, residual = case.problem, 2 * code.tolerance, float("inf")
        while not residual <= target:
            tolerance /= 2
            times.clear()
            pressure, iterations, applications = timed(tolerance)
            found = judge(problem, pressure)
            residual = max(found.residual_complementarity, found.residual_load)
        for _ in range(repeats - 1):
            timed(tolerance)
    return {
        "version": version(code.module),
        "iterations": iterations,
        "applications": applications,
        "seconds": sorted(times)[len(times) // 2],
        "complementarity": found.residual_complementarity,
        "contact": found.residual_contact,
        "penetration": found.residual_penetration,
    }


def row(name: str, case: Case, options: argparse.Namespace) -> dict[str, Any]:
    """Return what a process of its own measures, or {"note": why there is nothing}."""
    code = code_of(name)
    if not find_spec(code.module):
        return {"note": f"not installed: {code.install}"}
    if case.threads > 1 and not code.has_threads:
        return {"note": "has no threads: see one"}
    command = [sys.executable, __file__, "--one", name, json.dumps(asdict(case))]
    command += ["--repeats", str(options.repeats), "--target", str(options.target)]
    threads = dict.fromkeys(THREAD_VARIABLES, str(case.threads))
    try:
        done = subprocess.run(
            command, env=os.environ | threads, capture_output=True, text=True, timeout=options.limit
        )
    except subprocess.TimeoutExpired:
        return {"note": f"not done after {options.limit:g} s"}
    if done.returncode:
        return {"note": f"failed: {(done.stderr.strip() or str(done.returncode)).splitlines()[-1]}"}
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    if found.get("iterations", 0) is None:
        logged = re.findall(r"^ *(\d+)(?: +\S+e[-+]\d+){2}$", done.stderr, re.MULTILINE)
        found["iterations"] = int(logged[-1]) if logged else None
    return found


def code_of(name: str) -> Code:
    """Return the code of a row."""
    return PEERS.get(name) or pellicle(name.removeprefix("pellicle "))


def line(found: dict[str, Any]) -> str:
    """Return a row of the table."""
    cells = (
        format("–", width.partition(".")[0]) if found.get(name) is None else f"{found[name]:{width}}"
        for name, width in COLUMNS.items()
        if "note" not in found or name in found
    )
    return "".join(cells) + (f"  {found['note']}" if "note" in found else "")


def cases(options: argparse.Namespace) -> Iterator[Case]:
    """Yield every case asked for: periodic at each skin length, free without tension."""
    common = (options.cutoff, options.load, options.seed)
    for threads in options.threads:
        for points in options.points:
            for skin_length in options.skin_length:
                yield Case("periodic", points, skin_length, threads, *common)
        for points in options.free:
            yield Case("free", points, 0.0, threads, *common)


def command_line() -> argparse.Namespace:
    """Return the options."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    add = parser.add_argument
    add("--solvers", nargs="*", default=["conjugate_gradient", "active_set"])
    add("--peers", nargs="*", choices=PEERS, default=list(PEERS))
    add("--points", type=int, nargs="*", default=[256, 512], help="N of the periodic cases")
    add("--free", type=int, nargs="*", default=[512], help="N of the free cases")
    add("--skin-length", type=float, nargs="+", default=[0.0, 0.02], help="s/L, periodic")
    add("--threads", type=int, nargs="+", default=[1])
    add("--cutoff", type=float, default=8.0, help="shortest wavelength in cells")
    add("--load", type=float, default=0.1, help="mean pressure over E* × rms slope")
    add("--seed", type=int, default=1)
    add("--repeats", type=int, default=3, help="solves per row; their median counts")
    add("--target", type=float, default=1e-6, help="complementarity residual to reach")
    add("--limit", type=float, default=1800.0, help="seconds after which a row is given up")
    add("--one", nargs=2, help=argparse.SUPPRESS)
    return parser.parse_args()


def main() -> None:
    """Measure every case in a process of its own and print the table."""
    options = command_line()
    if options.one:
        name, case = options.one[0], Case(**json.loads(options.one[1]))
        try:
            found = measure(code_of(name), case, options.repeats, options.target)
        except UnsolvedError as error:
            found = {"note": str(error)}
        print(json.dumps(found))
        return
    print("".join(format(name, width.partition(".")[0]) for name, width in COLUMNS.items()))
    for case in cases(options):
        reference = None
        shown = {"boundary": case.boundary, "points": case.points, "s/L": case.skin_length}
        for name in [*(f"pellicle {solver}" for solver in options.solvers), *options.peers]:
            found = {"code": name, "version": "", **shown, "threads": case.threads}
            found |= row(name, case, options)
            if name.startswith("pellicle "):
                reference = reference or found.get("seconds")
            if reference and "seconds" in found:
                found["ratio"] = found["seconds"] / reference
            print(line(found), flush=True)
    print(FOOTER)


if __name__ == "__main__":
    main()
