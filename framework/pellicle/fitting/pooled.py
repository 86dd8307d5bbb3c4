"""One modulus and one tension for several curves, of other radii or depths."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from scipy.special import bdtrc, chdtrc

from pellicle.components import Executor, HasForceCurve, Indenter
from pellicle.errors import ConfigError, PellicleError

from .curves.curve import Segment
from .curves.sources import Curves, Source, gather
from .models.force_model import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION
from .models.simulation import GRID_POINTS
from .plausible import plausible
from .posed import Posed, likelihood, posed
from .problem import Baseline
from .result import Answer, doubt
from .statistics.checks import SingleFit, check_pooled_shape, fit_single
from .statistics.design import percent
from .statistics.likelihood import best_minimum
from .statistics.noise import FailedCheck
from .statistics.pooled_likelihood import Pool
from .statistics.profile import Estimate, chi_squared_threshold, profile_likelihood
from .status import Report, status

_CHANCE = 1e-3
"""A disagreement less likely than this is no chance."""
_FAILING = 0.01
"""Share of curves without fault that fail some check of the model."""
_RARE = 0.05
"""More failing curves than are likely with this chance are no chance."""
_NAMED = 5
"""Failing curves that a message names."""


@dataclass(frozen=True)
class PooledCurve:
    """What a pooled fit says of one of its curves."""

    name: str
    model: dict[str, Any]
    """Indenter, and the kernel if it was simulated, as JSON has them."""
    contact_point: Estimate
    """Position of first touch [m]; its interval only if it was asked for."""
    offset: float
    """Force of the baseline at the first position [N]."""
    slope: float
    """Slope of the baseline [N/m]."""
    noise: float
    """Standard deviation of the force [N]."""
    points: int
    chi_squared: float
    """Its share of χ²."""
    chi_squared_alone: float
    """χ² of the curve with a modulus and a tension of its own."""
    reduced_modulus_alone: float
    """That modulus [Pa]."""
    tension_alone: float
    """That tension [N/m]."""
    failed_checks: tuple[FailedCheck, ...]
    """What its residuals alone show besides noise; the messages say it too."""
    messages: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return vars(self) | {
            "contact_point": self.contact_point.to_dict(),
            "failed_checks": [check.to_dict() for check in self.failed_checks],
            "messages": list(self.messages),
        }


@dataclass(frozen=True)
class PooledFit(Answer):
    """What several curves say together of one solid."""

    _does: ClassVar[str] = "these curves do"
    _look_alikes: ClassVar[str] = (
        "curves of one speed on a solid that relaxes, or that adheres, can look the same: a second "
        "speed or a dwell, and the retract would tell"
    )

    curves: tuple[PooledCurve, ...]
    agreement: str
    """Whether the curves agree on one modulus and one tension, in words."""
    agree: bool
    """The same; where they do not, the intervals are widened."""
    contact_points: bool
    """Whether the intervals of the contact points were asked for."""
    pool: Pool
    """The curves and their χ²."""

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return super().to_dict() | {
            "agreement": self.agreement,
            "curves": [curve.to_dict() for curve in self.curves],
        }


def fit_pooled(
    curves: Curves,
    *,
    indenter: str | Mapping[str, Any] | Indenter | HasForceCurve,
    kernel: str | Mapping[str, Any] | None = None,
    poissons_ratio: float | None = None,
    fix: Mapping[str, Any] | None = None,
    baseline: Baseline = "none",
    segment: Segment = "approach",
    cache: str | Path | None = None,
    executor: str | Mapping[str, Any] | Executor = "serial",
    grid_points: int = GRID_POINTS,
    progress: bool = False,
    contact_points: bool = False,
    **fields: Any,
) -> PooledFit:
    """Fit one reduced modulus and one tension to several curves together.

    Each curve has its own contact point, baseline and noise. Curves of small and of large contacts
    tell modulus and tension apart better than any of them alone.

    Parameters
    ----------
    curves
        As for `fit_many`.
    indenter, kernel, poissons_ratio, baseline, segment, cache, executor, grid_points, progress
        As for `fit`.
    fix
        Parameters to hold, of those that are shared: reduced_modulus, tension.
    contact_points
        Look for the interval of each contact point too. Each takes searches over the parameters of
        all curves, so that the time grows with the square of their number.
    **fields
        Of the indenter and, if asked for by files, spring_constant and sensitivity; a list has a
        value for each file: ``radius=["5 um", "20 um"]``.

    Raises
    ------
    ConfigError
        A curve cannot be read or fitted, there is only one, or an argument is not allowed.
    StorageError
        A folder cannot be read.
    """
    options = {
        "kernel": kernel,
        "poissons_ratio": poissons_ratio,
        "fix": fix,
        "baseline": baseline,
        "segment": segment,
    }
    return pool_sources(
        gather(curves, segment, fields),
        indenter,
        options,
        contact_points=contact_points,
        cache=cache,
        executor=executor,
        grid_points=grid_points,
        progress=progress,
    )


def pool_sources(
    sources: Sequence[Source],
    indenter: str | Mapping[str, Any] | Indenter | HasForceCurve,
    options: Mapping[str, Any],
    *,
    contact_points: bool = False,
    **study: Any,
) -> PooledFit:
    """Return the pooled fit of sources, asked as `fit_source` asks.

    Raises
    ------
    PellicleError
        As for `fit_pooled`.
    """
    if "contact_point" in (options["fix"] or {}):
        raise ConfigError(
            "is not shared, each curve has its own; leave it out", "fix.contact_point"
        )
    if len(sources) < 2:
        raise ConfigError("holds one curve, and a pool needs two; use fit", "curves")
    every = []
    for source, each in zip(sources, posed(sources, indenter, options), strict=True):
        try:
            if isinstance(each, PellicleError):
                raise each
            modelled = each.modelled(**study)
            every.append((modelled, fit_single(likelihood(modelled), modelled.asked.fixed)))
        except ConfigError as error:
            raise source.named(error, "; leave it out") from None
    with status(study.get("progress", False)) as report:
        return _fitted(every, contact_points, report)


def _fitted(
    every: Sequence[tuple[Posed, SingleFit]], contact_points: bool, report: Report
) -> PooledFit:
    report("least squares")
    pool = Pool.of([single.likelihood for _, single in every])
    start = pool.initial_minimum([single.parameters for _, single in every])
    parts = pool.parts(start.parameters)
    singles = [
        best_minimum(single.likelihood, (single.parameters, part))
        for (_, single), part in zip(every, parts, strict=True)
    ]
    shared = [p for p in pool.free if p.shared]
    degrees = len(shared) * (len(every) - 1)
    spread = max(start.chi_squared - sum(single.chi_squared for single in singles), 0.0)
    factor = max(spread / degrees, 1.0) if chdtrc(degrees, spread) < _CHANCE else 1.0
    freedom = sum(single.freedom for _, single in every)
    threshold = factor * chi_squared_threshold(freedom)
    points = [CONTACT_POINT.of_curve(index) for index in range(len(every))]
    wanted = [*shared, *(p for p in points if contact_points and p in pool.free)]
    profile = profile_likelihood(pool, start, threshold, wanted, pool.without_tension, report)
    modulus, tension = profile.estimate(MODULUS), profile.estimate(TENSION)
    curves = []
    for number, part in enumerate(pool.parts(profile.best.parameters)):
        (posed, own), member, single = every[number], pool.members[number], singles[number]
        point = profile.estimate(points[number])
        curves.append(
            PooledCurve(
                name=posed.name,
                model=member.force_model.description(),
                contact_point=point,
                offset=part[OFFSET],
                slope=part[SLOPE],
                noise=member.noise,
                points=member.force.size,
                chi_squared=member.chi_squared(part),
                chi_squared_alone=single.chi_squared,
                reduced_modulus_alone=float(np.exp(single.parameters[MODULUS])),
                tension_alone=single.parameters[TENSION],
                failed_checks=own.failed_checks,
                messages=(
                    *posed.curve.messages,
                    *own.messages,
                    *(check.message for check in own.failed_checks),
                    *plausible(posed, point.value, modulus.value, tension.value),
                ),
            )
        )
    shapes = tuple(check_pooled_shape(pool, profile.best))
    return PooledFit(
        reduced_modulus=modulus,
        tension=tension,
        poissons_ratio=every[0][0].asked.poissons_ratio,
        chi_squared=profile.best.chi_squared,
        chi_squared_without_tension=profile.without_tension.chi_squared,
        advice=_advice(modulus, tension),
        messages=(
            *(check.message for check in shapes),
            *profile.messages,
            *_open(modulus, tension),
        ),
        parameters=profile.best.parameters,
        parameters_without_tension=profile.without_tension.parameters,
        rise=threshold,
        failed_checks=shapes,
        doubt=_doubt(curves) or doubt(shapes),
        curves=tuple(curves),
        agreement=_agreement(curves, spread, degrees, factor),
        agree=factor == 1,
        contact_points=contact_points,
        pool=pool,
    )


def _agreement(curves: Sequence[PooledCurve], spread: float, degrees: int, factor: float) -> str:
    figures = f"Δχ² = {spread:.3g} for {degrees} degrees of freedom"
    if factor == 1:
        return f"the curves agree ({figures} against each on its own)"
    worst = max(curves, key=lambda curve: curve.chi_squared - curve.chi_squared_alone)
    return (
        f"the curves do not agree on what they share ({figures} against each on its own), "
        f"{worst.name} least of all; the intervals are widened by {np.sqrt(factor):.2g}"
    )


def _failures(curve: PooledCurve) -> list[FailedCheck]:
    return [check for check in curve.failed_checks if check.of_model and check.code != "shape"]


def _doubt(curves: Sequence[PooledCurve]) -> str:
    """Return why these curves are no evidence of a tension, if more of them fail than by chance."""
    # The shape is judged for all curves together.
    failing = [curve for curve in curves if _failures(curve)]
    if not failing or bdtrc(len(failing) - 1, len(curves), _FAILING) > _RARE:
        return ""
    names = ", ".join(curve.name for curve in failing[:_NAMED])
    more = ", …" if len(failing) > _NAMED else ""
    reason = doubt([check for curve in failing for check in _failures(curve)])
    return f"{reason}; {len(failing)} of {len(curves)} curves fail it: {names}{more}"


def _advice(modulus: Estimate, tension: Estimate) -> str:
    """Return the bound of what was asked for."""
    bounds = [
        f"± {percent(each.bound / each.value)} of the {name}"
        for name, each in (("modulus", modulus), ("tension", tension))
        if not each.held and each.value and np.isfinite(each.bound)
    ]
    if not bounds:
        return ""
    return (
        f"no unbiased fit of these curves could beat {' and '.join(bounds)} (Cramér–Rao bound, "
        "one standard deviation)"
    )


def _open(modulus: Estimate, tension: Estimate) -> tuple[str, ...]:
    """Say what an open interval means."""
    if modulus.held or tension.held:
        return ()
    if None not in (modulus.low, modulus.high, tension.high):
        return ()
    return (
        "the curves together cannot tell modulus and tension apart: an interval is open, its value "
        "is one of many; add curves of another radius or range",
    )
