"""All that the freeze reads of the program; nothing else in this folder may import pellicle.

A rewrite that names or nests its results otherwise changes this file and no stored value. Values
are in SI, by name.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar, Literal

import cost
import kernels
import numpy as np
import xarray as xr

import pellicle as pl
from tests import adhesive_paths
from tests.physics.frozen.not_frozen import VARIABLES


@contextmanager
def _caveats_hidden() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pl.ConvergenceWarning)
        yield


# --- Runs ------------------------------------------------------------------------------------


class Interrupting(pl.Output):
    """Stands for Ctrl-C after a step."""

    type: Literal["interrupting"] = "interrupting"
    after: ClassVar[int]

    def step(self, dataset: xr.Dataset, stem: Path) -> None:
        """Raise KeyboardInterrupt if the step is the one."""
        if dataset["step"].item() == self.after:
            raise KeyboardInterrupt

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
        """Write nothing."""
        return ()


def run_values(configuration: Mapping[str, Any], *, interrupted_after: int = 0) -> dict[str, Any]:
    """Return every variable of a run that is frozen, [step] or [step, x, y], and of its path.

    With ``interrupted_after``, the run is interrupted after that step and resumed.
    """
    with _caveats_hidden():
        if interrupted_after:
            result = _resumed(configuration, interrupted_after)
        else:
            result = pl.run(configuration, progress=False)
    steps = result.dataset
    values = {str(name): steps[name].values for name in steps.data_vars}
    values |= {name: np.array(value) for name, value in result.path_summary.items()}
    return {name: value for name, value in values.items() if name not in VARIABLES}


def _resumed(configuration: Mapping[str, Any], after: int) -> pl.Result:
    Interrupting.after = after
    with tempfile.TemporaryDirectory() as folder:
        try:
            run = pl.Run(**configuration, outputs=[Interrupting()])
            pl.run(run, directory=folder, progress=False)
        except KeyboardInterrupt:
            pass
        return pl.run({**configuration, "outputs": []}, directory=folder, progress=False)


def solver_tolerance(configuration: Mapping[str, Any]) -> float:
    """Return the bound on the residuals of a run."""
    return pl.Run(**configuration).solver.tolerance


# --- Operator applications of the benchmarks -------------------------------------------------


def cost_applications(case: str, tension: float, points: int) -> int:
    """Return the applications on the finest grid of a case of `cost`."""
    problem, tolerance, _ = cost.problem(case, points, tension)
    before = problem.operator.applications
    pl.solver("active_set", tolerance=tolerance).solve(problem, None, lambda *_: None)
    return problem.operator.applications - before  # type: ignore[no-any-return]


def kernel_applications(case: str, kernel: str, points: int) -> int:
    """Return the applications of a case of `kernels`."""
    with _caveats_hidden():
        step = kernels.solve(case, kernels.KERNELS[kernel], points)
    return int(step["operator_applications"])


def adhesive_applications(case: str, tension: float, points: int) -> int:
    """Return the applications of all steps of a path there and back, of `adhesion`."""
    down = np.linspace(0.1, 1.3, 7)
    with _caveats_hidden():
        if case == "rough punch":
            steps = adhesive_paths.rough_path(points, tension)
        else:
            steps = adhesive_paths.solved(points, tension, [*down, *down[-2::-1], -0.2, -0.4])
    return int(steps["operator_applications"].sum())
