"""All that the freeze reads of the program; nothing else in this folder may import pellicle.

A rewrite that names or nests its results otherwise changes this file and no stored value. Values
are in SI, by name; effects that bend a force curve have names of their own, and explanations are
sets of them.
"""

import tempfile
import warnings
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
import operator_counts
import xarray as xr

import pellicle as pl
from pellicle.arrays import Array
from pellicle.contact import Problem
from pellicle.surface import operator_of
from pellicle_fit.config import FitConfig
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Effect, Sizes, Solid
from pellicle_fit.estimation.candidate import Candidate
from pellicle_fit.estimation.intervals import Estimate
from pellicle_fit.estimation.objective import Objective
from pellicle_fit.estimation.search import Ending, Minimum
from pellicle_fit.explanation import Explanation
from pellicle_fit.files.cleaning import clean
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.selection.recipe import answer, with_estimates
from tests import adhesive_paths
from tests.physics.frozen.fit_curves import RADIUS, Case
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
        if dataset["step"].item() == self.after:
            raise KeyboardInterrupt

    def write(self, runs: pl.Runs, stem: Path) -> tuple[Path, ...]:
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


def unit_applications(case: str, tension: float, points: int) -> int:
    """Return the applications on the finest grid of a case in units of the domain L, E* = 1.

    Rough surfaces have a cut-off of 16 cells: periodic, at a mean pressure of 0.1 × rms slope, or a
    free punch at a depth of 0.1. A smooth paraboloid is in a domain of twice the radius of Hertz.
    """
    grid = pl.Grid(points=points, size=1.0, boundary="periodic" if case == "rough" else "free")
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=tension / 2)
    rough = {"rms_height": 0.01, "cutoff_wavelength": 16 / points, "seed": 1}
    indenter = {
        "rough": lambda: pl.indenter("self_affine", hurst=0.8, **rough),
        "punch": lambda: pl.indenter("self_affine", hurst=0.7, **rough),
        "smooth": lambda: pl.indenter("paraboloid", radius=2.236),
    }[case]()
    profile = indenter.profile(*grid.coordinates())
    slope = np.sqrt(np.mean(np.hypot(*np.gradient(profile, 1 / points)) ** 2))
    load = pl.Depth(0.1118 if case == "smooth" else 0.1)
    control = pl.Force(0.1 * float(slope)) if case == "rough" else load
    problem = Problem(grid, operator_of(kernel, grid), profile, control)
    solver = pl.solver("active_set", tolerance=1e-8 if case == "smooth" else 1e-6)
    solver.solve(problem, None, lambda *_: None)
    return problem.operator.applications


def kernel_applications(case: str, kernel: str, points: int) -> int:
    """Return the applications of a case of `operator_counts`."""
    with _caveats_hidden():
        step = operator_counts.solve(case, operator_counts.KERNELS[kernel], points)
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


# --- Fits ------------------------------------------------------------------------------------


def _effect(name: str, **fields: Any) -> Effect:
    return pl.registry().make(Effect, {"type": name, **fields})


def _given(case: Case) -> list[Effect]:
    """Return what all explanations of a case have: baseline and layer."""
    options = case.options
    baseline = options.get("baseline", "none")
    found = [_effect(n) for n in ("offset", "slope")[: ("none", "offset", "slope").index(baseline)]]
    if "thickness" in options:
        known = {} if options["thickness"] == "free" else {"thickness": options["thickness"]}
        found.append(_effect("layer", poissons_ratio=options["poissons_ratio"], **known))
    return found


def _curves(case: Case) -> tuple[Curve, ...]:
    """Return the curves of a case as fits see them."""
    options = {"indenter": "paraboloid", "radius": RADIUS, **case.options}
    shape = {k: options[k] for k in ("radius", "half_angle") if options.get(k) is not None}
    body: Any = pl.indenter(options["indenter"], **shape)
    curves = []
    for curve in case.curves:
        raw = Measurement(
            curve.position,
            curve.force,
            time=curve.time,
            stiffness=options.get("spring_constant"),
        )
        seen = clean(raw, options.get("segment", "approach"))
        arrays = seen.position, seen.force, body, seen.time, seen.unloading, seen.stiffness
        curves.append(Curve(*arrays))
    return tuple(curves)


def _explanation(case: Case, effects: Collection[str]) -> Explanation:
    """Return an explanation of a case, with a baseline and with all its quantities open."""
    wanted = {*effects, "offset", "slope"}
    given = _given(case)
    taken = {effect.type_name for effect in given}
    return Explanation(Solid(), (*given, *(_effect(name) for name in sorted(wanted - taken))))


def _objective(
    case: Case, effects: Collection[str], values: Mapping[str, float], memory: float = 0.0
) -> tuple[Objective, Any]:
    """Return χ² of a case under an explanation, and the coordinates of values."""
    curves = _curves(case)
    objective = Objective(
        _explanation(case, effects),
        curves,
        Sizes.of_curve(curves[0]),
        1.0,
        (case.noise,) * len(curves),
        (memory,) * len(curves),
    )
    at = np.array([s.coordinate(values.get(s.name, 0.0)) for s in objective.slots])
    if (modulus := objective.index("reduced_modulus")) is not None:
        # The coordinate is the logarithm of what is left of E* at the end of the loading.
        relaxed = values["reduced_modulus"] / objective.known(at, 0).solid.reduced_modulus
        at[modulus] += np.log(relaxed)
    return objective, at


def _sorted(case: Case) -> bool:
    """Return whether the stored forces of a case are in the order of positions."""
    return bool(case.options.get("segment", "approach") == "retract")


def forces(case: Case, effects: Collection[str], values: Mapping[str, float]) -> Array:
    """Return the force [N] of a model at the rows of a curve, baseline included."""
    objective, at = _objective(case, effects, values)
    (force,) = objective.forces(at)
    return force[np.argsort(objective.curves[0].base, kind="stable")] if _sorted(case) else force


def chi_squared(
    case: Case, effects: Collection[str], values: Mapping[str, float], memory: float = 0.0
) -> float:
    """Return χ² of curves at given values and the true noise.

    With a memory d, noise has a power that falls as f^(−2d).
    """
    objective, at = _objective(case, effects, values, memory)
    return objective.chi_squared(at)


def noise(case: Case, effects: Collection[str], values: Mapping[str, float]) -> dict[str, Any]:
    """Return the noise [N] that the residuals of the first curve show, and checks that they fail.

    They are about a model at given values.
    """
    objective, at = _objective(case, effects, values)
    fit = Candidate(frozenset(effects), objective, Minimum(at, (0.0,)), objective.curves)
    judged = fit.judgements[0]
    return {
        "deviation": judged.noise.deviation,
        "freedom": judged.noise.freedom,
        "failed": sorted(flaw.name.lower() for flaw in judged.flaws),
    }


def fit(case: Case) -> dict[str, Any]:
    """Return what a fit of curves answers; ΔAIC are over the explanation without any effect."""
    fixed = dict(case.options.get("fix", {}))
    known = {"tension": fixed.pop("tension")} if "tension" in fixed else {}
    found = answer(
        _curves(case),
        [_effect("tension", **known), *_given(case)],
        FitConfig(indenter={"type": "cone", "half_angle": 1.2}).rivals,
        fix=fixed,
    )
    explanations = found.explanations
    if case.full:
        explanations = tuple(with_estimates(fit, found.threshold, (), ()) for fit in explanations)
    none = next(fit.aic for fit in found.explanations if not fit.types)
    return {
        "noise": [judged.noise.deviation for judged in found.judgements],
        "failed": sorted({f.name.lower() for judged in found.judgements for f in judged.flaws}),
        "threshold": found.threshold,
        "verdict": found.verdict.value,
        "chosen": _key(found.selected.types),
        "tied": sorted(_key(fit.types) for fit in found.tied),
        "over_tied": {
            "reduced_modulus": _estimate(found.over_tied("reduced_modulus")),
            "tension": _estimate(found.over_tied("tension")),
        },
        "explanations": {
            _key(fit.types): {
                "chi_squared": fit.chi_squared,
                "delta_aic": fit.aic - none,
                "given_up": fit.minimum.ending is Ending.GIVEN_UP,
                "parameters": {name: _estimate(e) for name, e in fit.estimates.items()},
            }
            for fit in explanations
        },
    }


def _key(types: Collection[str]) -> str:
    """Return the effects of an explanation as one word."""
    return " + ".join(sorted(types)) or "none"


def _estimate(estimate: Estimate) -> list[float | None]:
    """Return value and both ends of the interval; None for what is open, or not quoted."""
    return [estimate.to_dict()["value"], estimate.low, estimate.high]
