"""All that the freeze reads of the program; nothing else in this folder may import pellicle.

A rewrite that names or nests its results otherwise changes this file and no stored value. Values
are in SI, by name; effects that bend a force curve have names of their own, and explanations are
sets of them.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal

import cost
import kernels
import numpy as np
import xarray as xr
from numpy.typing import NDArray

import pellicle as pl
from pellicle_fit.config import FitConfig
from pellicle_fit.files.measurement import Measurement
from pellicle_fit.files.sources import Source, SourceStream
from pellicle_fit.many import fit_sources
from pellicle_fit.one_curve import fit_source
from pellicle_fit.parameters import TENSION, Coordinates
from pellicle_fit.pooled import pool_sources
from pellicle_fit.population.table import table
from pellicle_fit.problem import FitProblem, problems
from pellicle_fit.statistics.checks import judged
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.pooled_likelihood import Pool
from pellicle_fit.statistics.rivals import rivals, sloped
from tests import adhesive_paths
from tests.physics.frozen.fit_curves import RADIUS, Case
from tests.physics.frozen.not_frozen import VARIABLES

Array = NDArray[np.float64]
_CODES = {"slope": "baseline_slope", "layer": "thickness"}
"""Names of effects in the program, where they differ."""
_NAMES = {code: name for name, code in _CODES.items()}


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
    return problem.operator.applications - before


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


# --- Fits ------------------------------------------------------------------------------------


def _effects(code: str) -> list[str]:
    """Return the effects of an explanation."""
    return sorted(_NAMES.get(part, part) for part in code.split("+") if part != "none")


def _key(code: str) -> str:
    """Return the effects of an explanation as one word."""
    return " + ".join(_effects(code)) or "none"


def _config(case: Case, **options: Any) -> FitConfig:
    given = {"indenter": "paraboloid", "radius": RADIUS, **case.options, **options}
    return FitConfig.merged(None, **given)


def _sources(config: FitConfig, case: Case) -> list[Source]:
    """Return the curves of a case as the program reads them."""
    numbers = {str(n): (curve.position, curve.force) for n, curve in enumerate(case.curves)}
    sources = []
    for source, curve in zip(config.sources(numbers), case.curves, strict=True):
        assert isinstance(source.curve, Measurement)
        sources.append(source._replace(curve=replace(source.curve, time=curve.time)))
    return sources


def _likelihoods(
    case: Case, effects: Collection[str], values: Mapping[str, float]
) -> list[tuple[Likelihood, Coordinates]]:
    """Return the likelihood of each curve under an explanation, and the coordinates of values."""
    pairs = []
    config = _config(case)
    for problem in problems(config, _sources(config, case)):
        assert isinstance(problem, FitProblem)
        member = replace(problem.likelihood(), noise=case.noise)
        if TENSION not in member.free:
            member = replace(member, free=(*member.free, TENSION))
        known = {p: p.coordinate(values.get(p.name, 0.0)) for p in member.parameters}
        explanations = {_key(r.code): r for r in rivals(member, known)}
        wanted = {*effects} - {"slope"}
        explanation = explanations[" + ".join(sorted(wanted)) or "none"]
        if "slope" in effects:
            explanation = sloped(explanation)
        member = explanation.of_curve(member)
        given = {p: values.get(p.name, 0.0) for p in member.parameters}
        without = {} if "tension" in effects else {TENSION: 0.0}
        coordinates = {p: p.coordinate(v) for p, v in (given | without).items()}
        pairs.append((member, coordinates))
    return pairs


def forces(case: Case, effects: Collection[str], values: Mapping[str, float]) -> Array:
    """Return the force [N] of a model at the rows of a curve, baseline included."""
    ((member, coordinates),) = _likelihoods(case, effects, values)
    return np.asarray(member.force + member.misfit(coordinates))


def chi_squared(
    case: Case,
    effects: Collection[str],
    values: Mapping[str, float],
    memory: float = 0.0,
    condensed: bool = False,
) -> float:
    """Return χ² of curves at given values and the true noise.

    With a memory d, noise has a power that falls as f^(−2d); a condensed χ² is that of searches.
    """
    pairs = _likelihoods(case, effects, values)
    pool = Pool.of([replace(member, memory=memory) for member, _ in pairs])
    coordinates = pool.joined([part for _, part in pairs])
    whole = pool.condensed(coordinates, 0.1) if condensed else pool
    assert condensed == (whole is not pool)
    return float(whole.chi_squared(coordinates))


def noise(case: Case, effects: Collection[str], values: Mapping[str, float]) -> dict[str, Any]:
    """Return the noise [N] that the residuals of the first curve show, and checks that they fail.

    They are about a model at given values.
    """
    estimate, _ = judged(*_likelihoods(case, effects, values)[0])
    return {
        "deviation": estimate.noise.deviation,
        "freedom": estimate.noise.freedom,
        "failed": sorted(check.code for check in estimate.failed),
    }


def fit(case: Case) -> dict[str, Any]:
    """Return what a fit of curves answers.

    ``headline`` is the elastic solid under tension, its intervals left out where those of the
    comparison are of another noise; ΔAIC are over the explanation without any effect.
    """
    config = _config(case, compare=case.full, pool=len(case.curves) > 1)
    sources = _sources(config, case)
    if config.pool:
        result: Any = pool_sources(config, sources, progress=False)
        noises = [curve.noise for curve in result.curves]
        failed = {check.code for curve in result.curves for check in curve.failed_checks}
    else:
        result = fit_source(config, sources[0], progress=False)
        noises, failed = [result.noise], {check.code for check in result.failed_checks}
    headline = {k: v for k, v in result.estimates().items() if k != "youngs_modulus"}
    answer: dict[str, Any] = {
        "noise": noises,
        "failed": sorted(failed),
        "threshold": result.rise,
        "chi_squared": [result.chi_squared, result.chi_squared_without_tension],
        "headline": {name: _estimate(value) for name, value in headline.items()},
    }
    found = result.rivals
    if found is None:
        return answer
    aic = {rival.rival.code: rival.aic for rival in found.fits}
    least = next(r.chi_squared for r in found.fits if r.rival.code == "tension")
    if abs(result.chi_squared / least - 1) > 1e-3:
        for values in answer["headline"].values():
            values[1:] = ["another noise", "another noise", values[3]]
    return answer | {
        "verdict": found.verdict,
        "margin": found.margin,
        "chosen": _key("tension" if found.chosen is None else found.chosen.rival.code),
        "tied": sorted(_key(rival.rival.code) for rival in found.tied),
        "alternatives": sorted(_key(rival.rival.code) for rival in found.alternatives),
        "over_alternatives": {
            name: None if value is None else [value.low, value.high]
            for name, value in (("reduced_modulus", found.modulus), ("tension", found.tension))
        },
        "explanations": {
            _key(rival.rival.code): {
                "chi_squared": rival.chi_squared,
                "delta_aic": rival.aic - aic["none"],
                "parameters": {
                    name: _estimate(e)
                    for name, e in rival.estimates.items()
                    if rival.intervals != "curvature"
                },
            }
            for rival in found.fits
        },
    }


def _estimate(estimate: pl.Estimate) -> list[Any]:
    """Return value, both ends of the interval and the Cramér–Rao bound; None for what is open."""
    bound = estimate.bound if np.isfinite(estimate.bound) else None
    return [estimate.value, estimate.low, estimate.high, bound]


def tables(cases: list[list[Case]]) -> dict[str, dict[str, Any]]:
    """Return the columns of a population, and the images of the force map that its curves are.

    Curves are at the places of a lattice; of a column of texts only the name is told.
    """
    with tempfile.TemporaryDirectory() as name:
        folder, lines = Path(name), ["file,x [um],y [um]"]
        for y, row in enumerate(cases):
            for x, case in enumerate(row):
                (curve,) = case.curves
                np.savetxt(
                    folder / f"{x}{y}.csv",
                    np.column_stack([curve.position, curve.force]),
                    delimiter=",",
                    header="position [m],force [N]",
                    comments="",
                )
                lines.append(f"{x}{y}.csv,{x},{y}")
        (folder / "map.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        config = _config(cases[0][0], curves=folder / "map.csv")
        fits = fit_sources(config, SourceStream(config.files()), None, progress=False)
    (images,) = fits.maps.values()
    return {"population": _columns(table(fits.rows)), "map": _columns(images)}


def _columns(dataset: Any) -> dict[str, Any]:
    return {
        str(name): {"unit": values.attrs.get("units", ""), "values": _numbers(values.values)}
        for name, values in dataset.variables.items()
    }


def _numbers(values: Any) -> list[Any] | None:
    """Return numbers in a list, None for NaN; None for texts."""
    if values.dtype.kind not in "fib":
        return None
    return [None if np.isnan(value) else float(value) for value in values.ravel()]
