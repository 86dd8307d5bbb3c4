"""Pooled fits: one modulus and one tension for curves of several radii or depths."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from pellicle.batch import status_line
from pellicle.errors import ConfigError, PellicleError
from pellicle.units import decimal

from .compare import compare
from .config import FitConfig
from .files.measurement import Note
from .files.sources import Curves, Source
from .parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION, Coordinates, Parameter
from .problem import FitProblem, problems
from .record import Stopwatch, data_of
from .result import FitResult, thickness_of
from .statistics.checks import SingleFit, check_plausible, check_shape, fit_single
from .statistics.chi_squared import Minimum, best_minimum
from .statistics.design import pooled_advice
from .statistics.likelihood import Likelihood
from .statistics.noise import FailedCheck, doubt_of_tension, is_beyond_chance
from .statistics.pooled_likelihood import Excess, Pool
from .statistics.profile import (
    Estimate,
    ProfileResult,
    chi_squared_threshold,
    profile_likelihood,
)
from .wording import column_scale, interval_text


@dataclass(frozen=True)
class PooledCurve:
    """One curve of a pooled fit."""

    name: str
    model: dict[str, Any]
    """Indenter, and the kernel if it was simulated, as JSON data."""
    contact_point: Estimate
    """Position of first touch [m]; its interval only if requested."""
    offset: float
    """Force of the baseline at the first position [N]."""
    slope: float
    """Slope of the baseline [N/m]."""
    noise: float
    """Standard deviation of the force [N]."""
    points: int
    chi_squared: float
    """Sum of its squared residuals over its noise."""
    chi_squared_alone: float
    """χ² of the curve with a modulus and a tension of its own."""
    reduced_modulus_alone: float
    """The modulus of its own, E* [Pa]."""
    tension_alone: float
    """The tension of its own, τ₀ [N/m]."""
    failed_checks: tuple[FailedCheck, ...]
    """Checks that its residuals fail; their sentences are among the messages."""
    messages: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the curve as JSON data."""
        return vars(self) | {
            "contact_point": self.contact_point.to_dict(),
            "failed_checks": [check._asdict() for check in self.failed_checks],
            "messages": list(self.messages),
            "notes": [text for text in self.messages if isinstance(text, Note)],
        }


@dataclass(frozen=True, repr=False)
class PooledFit(FitResult):
    """Modulus and tension that several curves of one solid share."""

    _subject: ClassVar[str] = "these curves do"

    curves: tuple[PooledCurve, ...]
    agreement: str
    """Whether the curves agree on one modulus and one tension, in words."""
    agree: bool
    """Whether the curves agree; if they do not, the intervals are widened."""
    contact_points: bool
    """Whether the intervals of the contact points were requested."""
    pool: Pool
    """The curves and their χ²."""

    @property
    def sentences(self) -> list[str]:
        """The verdicts of the fit in words."""
        pull_off = "" if self.rivals is None else self.rivals.pull_off
        return list(filter(None, [self.comparison, pull_off, self.agreement, self.advice]))

    @property
    def all_messages(self) -> list[str]:
        """Warnings and notes, those of single curves with their names."""
        own = [
            type(text)(f"{curve.name}: {text}") for curve in self.curves for text in curve.messages
        ]
        return [*self.messages, *own]

    def curve_rows(self, *, si: bool = False) -> list[dict[str, str]]:
        """Return a line of a table for each curve."""
        points = [curve.contact_point for curve in self.curves]
        columns = {
            **_column("contact point", [point.value for point in points], "m", si, digits=6),
            **_column("noise", [curve.noise for curve in self.curves], "N", si),
            "points": [str(curve.points) for curve in self.curves],
            "χ²": [decimal(curve.chi_squared, 5) for curve in self.curves],
            **_column(
                "modulus alone", [curve.reduced_modulus_alone for curve in self.curves], "Pa", si
            ),
            **_column("tension alone", [curve.tension_alone for curve in self.curves], "N/m", si),
        }
        if self.contact_points:
            scale = column_scale([point.value for point in points], "m", si=si)
            columns["95 % of contact point"] = [
                "fixed" if point.held else interval_text(point.low, point.high, scale)
                for point in points
            ]
        return [
            {"curve": curve.name} | {name: cells[number] for name, cells in columns.items()}
            for number, curve in enumerate(self.curves)
        ]

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as JSON data."""
        curves = [curve.to_dict() for curve in self.curves]
        if self.record is not None:
            curves = [
                curve | {"data": data} for curve, data in zip(curves, self.record.data, strict=True)
            ]
        return super().to_dict() | {"agreement": self.agreement, "curves": curves}


def _column(
    name: str, values: Sequence[float], unit: str, si: bool, digits: int = 4
) -> dict[str, list[str]]:
    """Return a column under its name and unit, which has a prefix unless ``si``."""
    scale = column_scale(values, unit, si=si)
    return {f"{name} [{scale.unit}]": [scale.number(value, digits) for value in values]}


def fit_pooled(
    curves: Curves | None = None,
    *,
    config: FitConfig | str | Path | None = None,
    progress: bool = False,
    **options: Any,
) -> PooledFit:
    """Fit one reduced modulus and one tension to several curves together.

    Each curve has its own contact point, baseline and noise. Curves of small and of large contacts
    tell modulus and tension apart better than any of them alone.

    Parameters
    ----------
    curves
        As for `fit_many`.
    progress
        Show the progress of studies and of the fit on a terminal or in a notebook.
    config, **options
        As for `fit_many`, but a contact point cannot be fixed.  ``contact_points=True`` determines
        the interval of each contact point too.  Each needs searches over the parameters of all
        curves, so the time grows with the square of their number.

    Raises
    ------
    ConfigError
        A curve cannot be read or fitted, there is only one, or an argument is not allowed.
    StorageError
        A folder cannot be read.
    """
    config = FitConfig.merged(config, pool=True, **options)
    return pool_sources(config, config.sources(curves), progress=progress)


def pool_sources(config: FitConfig, sources: Sequence[Source], *, progress: bool) -> PooledFit:
    """Return the pooled fit of several curves."""
    if "contact_point" in config.fix:
        raise ConfigError(
            "is not shared, each curve has its own; leave it out", "fix.contact_point"
        )
    if len(sources) < 2:
        raise ConfigError("holds one curve, and a pool needs two; use fit", "curves")
    singles, watch = [], Stopwatch()
    for source, problem in zip(sources, problems(config, sources), strict=True):
        try:
            if isinstance(problem, PellicleError):
                raise problem
            problem = problem.simulated(config, progress=progress)
            singles.append((problem, fit_single(problem.likelihood(), problem.fixed)))
        except ConfigError as error:
            raise source.named(error, "; leave it out") from None
    with status_line("fitting", progress) as report:
        fit = _fit_pool(singles, config.contact_points, report, config.compare)
    data = [data_of(problem.curve, config) for problem, _ in singles]
    return replace(fit, config=config, record=watch.record(config, data))


def _fit_pool(
    singles: Sequence[tuple[FitProblem, SingleFit]],
    contact_points: bool,
    report: Callable[[str], None],
    compared: bool,
) -> PooledFit:
    """Return the pooled fit of curves that were each fitted on their own."""
    report("least squares")
    members = [single.likelihood for _, single in singles]
    # Where times are not known, all curves have one speed, at which the longest takes 1 s.
    longest = max(float(np.ptp(member.base)) for member in members)
    pool = Pool.of([replace(m, duration=float(np.ptp(m.base)) / longest) for m in members])
    start = pool.initial_minimum([single.parameters for _, single in singles])
    own = [
        best_minimum(single.likelihood, (single.parameters, part))
        for (_, single), part in zip(singles, pool.parts(start.parameters), strict=True)
    ]
    shared = [p for p in pool.free if p.shared]
    excess = Excess.of(pool, start.chi_squared, [minimum.chi_squared for minimum in own])
    usual = chi_squared_threshold(sum(single.freedom for _, single in singles))
    threshold = excess.factor * usual
    points = [CONTACT_POINT.of_curve(index) for index in range(len(singles))]
    parameters = [*shared, *(p for p in points if contact_points and p in pool.free)]
    without = partial(pool.least_without, TENSION)
    profile = profile_likelihood(pool, start, threshold, parameters, without, report)
    modulus, tension = profile.estimate(MODULUS), profile.estimate(TENSION)
    curves = [
        _curve(*single, *member, alone, point, profile)
        for single, member, alone, point in zip(
            singles, pool.curves(profile.best.parameters), own, points, strict=True
        )
    ]
    _, shapes = check_shape(pool, profile.best)
    advice, undecided = pooled_advice(modulus, tension)
    rivals, failing = None, sum(map(_fails, curves))
    agree = excess.factor == 1
    worst = max(curves, key=lambda curve: curve.chi_squared - curve.chi_squared_alone)
    fails = doubt_of_tension(shapes) or is_beyond_chance(failing, len(curves)) or not agree
    is_doubtful = fails or tension.low is not None
    if TENSION in pool.free and (compared or is_doubtful):
        rivals = compare(
            pool,
            profile.best,
            profile.without_tension,
            threshold=usual,
            elastic_fails=fails,
            full=compared,
            pairs=not agree,
            counts=is_doubtful,
            report=report,
        )
    if rivals is not None and rivals.untried:
        modulus, tension = modulus.without_interval(), tension.without_interval()
    return PooledFit(
        reduced_modulus=modulus,
        tension=tension,
        poissons_ratio=singles[0][0].poissons_ratio,
        chi_squared=profile.best.chi_squared,
        chi_squared_without_tension=profile.without_tension.chi_squared,
        advice=advice,
        messages=(*(check.message for check in shapes), *profile.messages, *undecided),
        parameters=profile.best.parameters,
        parameters_without_tension=profile.without_tension.parameters,
        rise=threshold,
        failed_checks=tuple(shapes),
        rivals=rivals,
        curves=tuple(curves),
        agreement=excess.agreement(worst.name),
        agree=agree,
        contact_points=contact_points,
        pool=pool,
        thickness=thickness_of(pool.members[0].force_model, profile),
    )


def _curve(
    problem: FitProblem,
    single: SingleFit,
    member: Likelihood,
    part: Coordinates,
    alone: Minimum,
    contact_point: Parameter,
    profile: ProfileResult,
) -> PooledCurve:
    """Return a curve at its ``part`` of the pooled parameters, beside its minimum ``alone``."""
    plausible = check_plausible(member, part, profile.estimate)
    return PooledCurve(
        name=problem.name,
        model=member.force_model.description(),
        contact_point=profile.estimate(contact_point),
        offset=part[OFFSET],
        slope=part[SLOPE],
        noise=member.noise,
        points=member.force.size,
        chi_squared=member.chi_squared(part),
        chi_squared_alone=alone.chi_squared,
        reduced_modulus_alone=float(np.exp(alone.parameters[MODULUS])),
        tension_alone=alone.parameters[TENSION],
        failed_checks=single.failed_checks,
        messages=(*problem.curve.messages, *single.messages, *plausible),
    )


def _fails(curve: PooledCurve) -> bool:
    """Return whether a curve fails a check of the model on its own."""
    # The shape is judged for all curves together.
    return doubt_of_tension([check for check in curve.failed_checks if check.code != "shape"])
