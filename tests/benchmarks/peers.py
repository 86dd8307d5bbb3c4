"""Pellicle and its peers on identical surfaces, at an accuracy measured by pellicle.

Each row is a process of its own: one code presses a self-affine surface under a given force. What
it returns is judged by `pellicle.contact.measure`; its own tolerance starts at a value found by
trial and is halved, eight times at most, until complementarity is under ``--target``. Seconds are
those from heights to pressure, plans and kernels included, imports not, after a small problem to
warm up. Iterations are as each code counts them, applications those of the operator; of nested
grids those on the finest. Tension reaches a peer through its own Fourier coefficients alone.

The tamaas wheel on PyPI is built with an FFTW 3.3.10 without SIMD (it has scalar codelets only)
and without threads; a tamaas built against a SIMD FFTW is faster.

    python -m pip install "pellicle[bench]"
    apt-get install -y g++ libeigen3-dev && python -m pip install ASPHER==0.1.3.post1

    python tests/benchmarks/peers.py                     # N = 256, 512; one thread
    python tests/benchmarks/peers.py --points 1024 2048 --threads 1 2
    python tests/benchmarks/peers.py --points --free 512 1024 --peers ASPHER
"""

import argparse
import re
import subprocess
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from importlib.metadata import version
from importlib.util import find_spec
from itertools import product
from typing import Any

import numpy as np
import scipy.fft
from tables import in_process, print_head, print_row

import pellicle as pl
from pellicle.contact import Problem
from pellicle.contact import measure as judge
from pellicle.surface import operator_of

RMS_HEIGHT = 0.01  # in L; the edge L and the reduced modulus E* are 1
LOAD = 0.1  # mean pressure over E* × rms slope
WARM_UP = 64  # N of the problem solved before the clock runs
RESIDUALS = ("complementarity", "contact", "penetration")
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

    @cached_property
    def problem(self) -> Any:
        """What pellicle solves, and what every pressure is measured against."""
        grid = pl.Grid(points=self.points, size=1.0, boundary=self.boundary)
        spectrum = {"hurst": 0.8, "cutoff_wavelength": self.cutoff / self.points}
        indenter = pl.indenter("self_affine", rms_height=RMS_HEIGHT, seed=1, **spectrum)
        heights = indenter.profile(*grid.coordinates())
        q = 2 * np.pi * scipy.fft.fftfreq(self.points, 1 / self.points)
        modes = np.abs(scipy.fft.fft2(heights, norm="forward"))
        slope = float(np.sqrt(np.sum((q[:, None] ** 2 + q**2) * modes**2)))
        kernel = pl.kernel("half_space", reduced_modulus=1.0)
        if self.skin_length:
            kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=self.skin_length / 2)
        return Problem(grid, operator_of(kernel, grid), heights, pl.Force(LOAD * slope))


Answer = tuple[Any, int, int]
"""Pressure, iterations and applications of the operator; 0 where the code does not say."""


@dataclass(frozen=True)
class Code:
    """How a code is driven."""

    module: str
    solve: Callable[[Case, float], Answer]  # from a case and the code's own tolerance
    tolerance: float  # where its own tolerance starts: found by trial for a target of 1e-6
    requirement: str
    has_threads: bool = False
    before: str = ""  # what to do before installing


def pellicle(solver: str, case: Case, tolerance: float) -> Answer:
    """Solve with a solver of pellicle."""
    operator = case.problem.operator
    before = operator.applications
    method = pl.solver(solver, tolerance=tolerance)
    outcome = method.solve(case.problem, None, lambda *progress: None)
    return outcome.pressure, outcome.iterations, operator.applications - before


def tamaas(case: Case, tolerance: float) -> Answer:
    """Solve with PolonskyKeerRey."""
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
        # The solver made this operator and applies it: an earlier change would not reach it.
        influence = model.operators["westergaard_neumann"]["influence"]
        influence[...] = tensed(influence, case.skin_length)
    solver.solve(case.problem.value)
    return np.array(model.traction), 0, 0


def contact_mechanics(case: Case, tolerance: float) -> Answer:
    """Solve with constrained_conjugate_gradients; the tolerance is that of penetration."""
    from ContactMechanics import FreeFFTElasticHalfSpace, PeriodicFFTElasticHalfSpace
    from ContactMechanics.Optimization import constrained_conjugate_gradients

    class Tensed(PeriodicFFTElasticHalfSpace):  # type: ignore[misc]
        def _compute_greens_function(self) -> Any:
            return tensed(super()._compute_greens_function(), case.skin_length)

    half_space = FreeFFTElasticHalfSpace if case.boundary == "free" else Tensed
    substrate = half_space((case.points, case.points), 1.0, (1.0, 1.0))
    aim = {"external_force": case.problem.value, "pentol": tolerance * RMS_HEIGHT}
    outcome = constrained_conjugate_gradients(substrate, case.problem.profile, **aim)
    return outcome.jac / substrate.area_per_pt, outcome.nit, outcome.nfev


def aspher(case: Case, tolerance: float) -> Answer:
    """Solve on nested grids, operator and preconditioner by FFT: the quickest of its own here."""
    import aspher as peer

    if case.skin_length:
        raise UnsolvedError("has no tension")
    backend = "fft" if case.boundary == "free" else "periodic"
    nesting = {"backend": backend, "coarsest": 32, "precond_engine": "fft", "tol": tolerance}
    gap, load = -case.problem.profile.ravel(), case.problem.value
    outcome = peer.solve_nested(case.points, gap, load, **nesting)
    if not outcome.converged:
        raise UnsolvedError(f"{outcome.status} at its tolerance {tolerance:.1e}")
    return outcome.pressure, outcome.iterations, outcome.matvec_count


def tensed(compliance: Any, skin_length: float) -> Any:
    """Return coefficients 2/q multiplied by 1/(1 + s q), in whatever order they are stored."""
    return compliance**2 / (compliance + 2 * skin_length + (compliance == 0))


EIGEN = "apt-get install -y g++ libeigen3-dev && "
PEERS = {
    "tamaas": Code("tamaas", tamaas, 1.5e-5, "tamaas==2.9.0"),
    "ContactMechanics": Code(
        "ContactMechanics", contact_mechanics, 1.6e-5, "ContactMechanics==1.8.3"
    ),
    "ASPHER": Code("aspher", aspher, 1.6e-5, "ASPHER==0.1.3.post1", True, EIGEN),
}


def code_of(name: str) -> Code:
    """Return the code of a row: a peer or ``"pellicle <solver>"``."""
    solve = partial(pellicle, name.removeprefix("pellicle "))
    return PEERS.get(name) or Code("pellicle", solve, 8e-6, "pellicle", True)


def measure(name: str, given: dict[str, Any], repeats: int, target: float) -> dict[str, Any]:
    """Return what one code takes and reaches in this process, or why there is nothing."""
    code, case = code_of(name), Case(**given)
    try:
        return measured(code, case, repeats, target)
    except UnsolvedError as error:
        return {"note": str(error)}


def measured(code: Code, case: Case, repeats: int, target: float) -> dict[str, Any]:
    """Return seconds, iterations and residuals of one code in this process."""
    seconds: list[float] = []
    tolerance = code.tolerance
    with scipy.fft.set_workers(case.threads):
        code.solve(replace(case, points=WARM_UP), 1e-3)
        problem = case.problem
        while len(seconds) < repeats:
            clock = time.process_time if case.threads == 1 else time.perf_counter
            started = clock()
            pressure, iterations, applications = code.solve(case, tolerance)
            elapsed = clock() - started
            if not seconds:
                outcome = judge(problem, pressure)
                if not max(outcome.residual_complementarity, outcome.residual_load) <= target:
                    tolerance /= 2
                    if tolerance < code.tolerance / 256:
                        raise UnsolvedError(f"reaches {outcome.residual_complementarity:.1e} only")
                    continue
            seconds.append(elapsed)
    residuals = {name: getattr(outcome, f"residual_{name}") for name in RESIDUALS}
    median = sorted(seconds)[len(seconds) // 2]
    counts = {"iterations": iterations, "applications": applications}
    return {"version": version(code.module), "seconds": median, **counts, **residuals}


def row(name: str, case: Case, options: argparse.Namespace) -> dict[str, Any]:
    """Return what a process of its own measures, or {"note": why there is nothing}."""
    code = code_of(name)
    if not find_spec(code.module):
        return {"note": f"not installed: {code.before}python -m pip install {code.requirement}"}
    if case.threads > 1 and not code.has_threads:
        return {"note": "has no threads: see one"}
    given = name, asdict(case), options.repeats, options.target
    outcome: dict[str, Any]
    try:
        outcome, log = in_process(measure, *given, threads=case.threads, timeout=options.limit)
    except subprocess.TimeoutExpired:
        return {"note": f"not done after {options.limit:g} s"}
    except RuntimeError as error:
        return {"note": f"failed: {str(error).strip().splitlines()[-1]}"}
    if logged := re.findall(r"^ *(\d+)(?: +\S+e[-+]\d+){2}$", log, re.MULTILINE):
        outcome["iterations"] = int(logged[-1])  # only the log of tamaas says them
    return outcome


def print_outcome(name: str, case: Case, outcome: dict[str, Any], reference: float | None) -> None:
    """Print a row of the table; its ratio is that to ``reference`` [s]."""
    start = (name, outcome.get("version", ""), case.boundary, case.points, case.skin_length)
    if "note" in outcome:
        print_row(*start, case.threads, *[""] * 6, outcome["note"])
        return
    print_row(
        *(*start, case.threads, outcome["iterations"] or "–", outcome["applications"] or "–"),
        f"{outcome['seconds']:.2f}",
        *(f"{outcome[name]:.1e}" for name in RESIDUALS),
        f"{outcome['seconds'] / reference:.2f}" if reference else "–",
    )


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
    add("--repeats", type=int, default=3, help="solves per row; their median counts")
    add("--target", type=float, default=1e-6, help="complementarity residual to reach")
    add("--limit", type=float, default=1800.0, help="seconds after which a row is given up")
    return parser.parse_args()


def main() -> None:
    """Measure every case in a process of its own and print the table."""
    options = command_line()
    print_head(
        *("code", "version", "boundary", "N", "s/L", "threads", "iterations", "applications"),
        *("seconds", *RESIDUALS, "ratio"),
    )
    surfaces = [("periodic", *choice) for choice in product(options.points, options.skin_length)]
    surfaces += [("free", points, 0.0) for points in options.free]
    names = [*(f"pellicle {solver}" for solver in options.solvers), *options.peers]
    for threads, (boundary, points, skin_length) in product(options.threads, surfaces):
        case = Case(boundary, points, skin_length, threads, options.cutoff)
        reference = None
        for name in names:
            outcome = row(name, case, options)
            if name.startswith("pellicle "):
                reference = reference or outcome.get("seconds")
            print_outcome(name, case, outcome, reference)
    print(FOOTER)


if __name__ == "__main__":
    main()
