"""Reduced modulus, tension and contact point of one measured curve, with their intervals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, cast

from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.batch import status_line
from pellicle.errors import ConfigError, PellicleError
from pellicle.units import readable

from .compare import compare
from .config import FitConfig
from .files.measurement import Measurement
from .files.sources import Source
from .parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION
from .problem import FitProblem, problems
from .record import Stopwatch, data_of
from .result import FitResult, thickness_of
from .statistics.checks import check_plausible, fit_single
from .statistics.chi_squared import Minimum, best_minimum
from .statistics.design import advice
from .statistics.initial_guess import initial_guesses
from .statistics.likelihood import Likelihood
from .statistics.noise import doubt_of_tension
from .statistics.profile import Estimate, chi_squared_threshold, profile_likelihood


@dataclass(frozen=True, repr=False)
class Fit(FitResult):
    """Modulus, tension and contact point of one curve, with their intervals."""

    contact_point: Estimate
    """Position of first touch [m]."""
    offset: Estimate
    """Force of the baseline at the first position [N]."""
    slope: Estimate
    """Slope of the baseline [N/m]."""
    noise: float
    """Standard deviation of the force [N]."""
    noise_from: str
    """Source of the noise estimate."""
    points: int
    """Number of rows that were used."""
    likelihood: Likelihood
    """The curve and its χ²."""

    @property
    def sentences(self) -> list[str]:
        """The noise and the verdicts of the fit in words."""
        noise = (
            f"noise: {readable(self.noise, 'N', 3)}, from {self.noise_from}; {self.points} points"
        )
        return [noise, *super().sentences]

    def model(self) -> dict[str, Any]:
        """Return the indenter and the kernel of the fit as JSON data.

        The kernel, without modulus and tension, is included unless it is a half-space.
        """
        return self.likelihood.force_model.description()

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as JSON data."""
        data = {} if self.record is None else {"data": self.record.data[0]}
        return (
            super().to_dict()
            | data
            | {
                "model": self.model(),
                "noise": {"value": self.noise, "unit": "N", "from": self.noise_from},
                "points": self.points,
            }
        )


def fit(
    position: ArrayLike | str | Path | None = None,
    force: ArrayLike | None = None,
    *,
    depth: ArrayLike | None = None,
    time: ArrayLike | None = None,
    config: FitConfig | str | Path | None = None,
    progress: bool = False,
    **options: Any,
) -> Fit:
    """Fit reduced modulus, tension and contact point to one measured curve.

    The solid is a half-space under tension unless a kernel is given; the contact is frictionless
    and without adhesion.  Errors of the force are assumed to be normal and independent, with equal
    variance at all points; the intervals have a confidence of 95 %.

    An indenter that has a force curve of its own (paraboloid, sphere, cone, flat_punch) is fitted
    at once, on a half-space and on a layer bonded to a rigid base (``thickness``).  Any other
    indenter, or any on another kernel, first needs a study of some 150 runs, which is kept in
    ``cache`` and serves all curves of the same proportions.

    Parameters
    ----------
    position, force
        Position of the indenter [m], growing into the solid, and force [N], both of shape (n,).
        With the option ``spring_constant`` [N/m], position is that of the cantilever's base less
        its deflection, so that the noise of the deflection is in both.  Instead of both, a file:
        ``pl.fit("bead.csv", …)``.
    depth
        Depth [m] instead of position: the contact point is then fixed at 0.
    time
        Time [s] of each row, in order; without it the option ``speed`` [m/s] gives a constant one.
    config
        A configuration or its TOML file.  Without position and force, the curve that it names is
        fitted.
    progress
        Show the progress of a study and of the fit on a terminal or in a notebook.
    **options
        Fields of `FitConfig`, which replace those of ``config``, and fields of the indenter:
        ``indenter="paraboloid", radius="5 um", fix={"tension": 0}``.

    Raises
    ------
    ConfigError, PluginError
        The curve cannot be fitted, or an argument is not allowed.
    ConvergenceError, StorageError
        A study failed, or its folder cannot be used.
    """
    if isinstance(position, (str, Path)):
        file, position = Path(position), None
        if file.suffix.lower() == ".toml" and config is None:
            config = file
        else:
            options["curves"] = file
    config = FitConfig.merged(config, **options)
    curves = None
    positions = [values for values in (position, depth) if values is not None]
    if positions or force is not None or not config.curves:
        if len(positions) != 1:
            raise ConfigError("give either position or depth")
        if force is None:
            raise ConfigError("is missing; give the force [N] at each position", "force")
        curves = {"": (positions[0], force)}
    source, *others = config.sources(curves)
    if others:
        count = 1 + len(others)
        raise ConfigError(f"names {count} curves; use fit_many or fit_pooled", "curves")
    if depth is not None and isinstance(source.curve, Measurement):
        source = source._replace(curve=replace(source.curve, is_depth=True))
    if time is not None and isinstance(source.curve, Measurement):
        # `clean` checks the array.
        source = source._replace(curve=replace(source.curve, time=cast("Array", time)))
    return fit_source(config, source, progress=progress)


def fit_source(config: FitConfig, source: Source, *, progress: bool) -> Fit:
    """Return the fit of one curve."""
    watch = Stopwatch()
    (problem,) = problems(config, [source])
    if isinstance(problem, PellicleError):
        raise problem
    simulated = problem.simulated(config, progress=progress)
    with status_line("fitting", progress) as report:
        result = fit_problem(simulated, report)
    record = watch.record(config, [data_of(problem.curve, config)])
    return replace(result, config=config, record=record)


def fit_problem(problem: FitProblem, report: Callable[[str], None] = lambda stage: None) -> Fit:
    """Return the fit of a curve whose indenter has a force curve.

    ``report`` is called with a description of each stage.  Rivals of a tension are compared where
    the curve seems to need one or fails a check, and always if the problem says so.
    """
    report("least squares")
    single = fit_single(problem.likelihood(), problem.fixed)
    likelihood, threshold = single.likelihood, chi_squared_threshold(single.freedom)
    profile = profile_likelihood(
        likelihood,
        likelihood.minimise(single.parameters),
        threshold,
        likelihood.free,
        partial(_without_tension, likelihood),
        report,
    )
    best = profile.best.parameters
    modulus, tension = profile.estimate(MODULUS), profile.estimate(TENSION)
    rivals, fails = None, doubt_of_tension(single.failed_checks)
    is_doubtful = fails or tension.low is not None
    if TENSION in likelihood.free and (problem.compare or is_doubtful):
        rivals = compare(
            likelihood,
            profile.best,
            profile.without_tension,
            threshold=threshold,
            elastic_fails=fails,
            full=problem.compare,
            counts=is_doubtful,
            report=report,
        )
    if rivals is not None and rivals.untried:
        modulus, tension = modulus.without_interval(), tension.without_interval()
    words, undecided = advice(likelihood, best, modulus, tension)
    return Fit(
        reduced_modulus=modulus,
        tension=tension,
        poissons_ratio=problem.poissons_ratio,
        chi_squared=profile.best.chi_squared,
        chi_squared_without_tension=profile.without_tension.chi_squared,
        advice=words,
        messages=(
            *problem.curve.messages,
            *single.messages,
            *profile.messages,
            *check_plausible(likelihood, best, profile.estimate),
            *undecided,
        ),
        parameters=best,
        parameters_without_tension=profile.without_tension.parameters,
        rise=threshold,
        failed_checks=single.failed_checks,
        rivals=rivals,
        contact_point=profile.estimate(CONTACT_POINT),
        offset=profile.estimate(OFFSET),
        slope=profile.estimate(SLOPE),
        noise=likelihood.noise,
        noise_from=single.noise_from,
        points=problem.curve.force.size,
        likelihood=likelihood,
        thickness=thickness_of(likelihood.force_model, profile),
    )


def _without_tension(likelihood: Likelihood, best: Minimum) -> Minimum:
    """Return the minimum of χ² without tension, from ``best`` and from the best initial guess."""
    start = best.parameters | {TENSION: 0.0}
    fixed = replace(likelihood, free=tuple(p for p in likelihood.free if p != TENSION))
    return best_minimum(fixed, (start, *initial_guesses(fixed, start)[:1]))
