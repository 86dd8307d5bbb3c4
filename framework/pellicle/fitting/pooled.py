"""One modulus and one tension for several curves, of other radii or depths."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import chdtrc

from pellicle.components import Executor, HasForceCurve, Indenter
from pellicle.errors import ConfigError, PellicleError
from pellicle.operators import Array

from .curve import Curve, Segment
from .design import percent
from .estimate import Estimate, of_log, youngs_modulus
from .explained import Explained, explain
from .fit import comparison
from .interval import CONFIDENCE, Better, Minimum, allowed_rise, interval
from .likelihood import MODULUS, OFFSET, POINT, SLOPE, TENSION
from .plausible import plausible
from .pool import Pool
from .posed import cleaned, modelled
from .profiled import widened
from .question import Baseline, question
from .simulated import described
from .simulation import GRID_POINTS
from .sources import Curves, gather
from .start import KEPT
from .written import write_json

_SHARED = [MODULUS, TENSION]
_CHANCE = 1e-3
"""A disagreement less likely than this is no chance."""


@dataclass(frozen=True)
class PooledCurve:
    """What a pooled fit says of one of its curves."""

    name: str
    model: dict[str, Any]
    """Indenter, and the kernel if it was simulated, as JSON has them."""
    contact_point: Estimate
    """Position of first touch [m]; its interval is not looked for."""
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
    messages: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return vars(self) | {
            "contact_point": self.contact_point.to_dict(),
            "messages": list(self.messages),
        }


@dataclass(frozen=True)
class PooledFit:
    """What several curves say together of one solid."""

    reduced_modulus: Estimate
    """E* [Pa]."""
    tension: Estimate
    """τ₀ [N/m]."""
    youngs_modulus: Estimate | None
    """E = (1 − ν²) E* [Pa], if Poisson's ratio was given."""
    curves: tuple[PooledCurve, ...]
    chi_squared: float
    """Least sum of squared residuals over the noise, of all curves."""
    chi_squared_without_tension: float
    """The same with tension held at 0."""
    comparison: str
    """Whether tension is needed, in words."""
    agreement: str
    """Whether the curves agree on one modulus and one tension, in words."""
    advice: str
    """The bound that was reached."""
    messages: tuple[str, ...]
    """What to be careful of."""
    pool: Pool
    """The curves and their χ²."""
    parameters: Array
    """Parameters of the fit, in the order of `pool`."""
    parameters_without_tension: Array
    """The same with tension held at 0."""
    rise: float
    """Rise of χ² at the ends of the intervals."""

    def estimates(self) -> dict[str, Estimate]:
        """Return the shared parameters by name."""
        return {name: each for name, each in vars(self).items() if isinstance(each, Estimate)}

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        gain = self.chi_squared_without_tension - self.chi_squared
        return {name: value.to_dict() for name, value in self.estimates().items()} | {
            "confidence": CONFIDENCE,
            "chi_squared": self.chi_squared,
            "without_tension": {"delta_chi_squared": gain, "delta_aic": gain - 2},
            "comparison": self.comparison,
            "agreement": self.agreement,
            "advice": self.advice,
            "messages": list(self.messages),
            "curves": [curve.to_dict() for curve in self.curves],
        }

    def save(self, path: str | Path) -> Path:
        """Write what `to_dict` returns to a JSON file, and return its name.

        Raises
        ------
        StorageError
            The file cannot be written.
        """
        return write_json(self.to_dict(), Path(path))


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
    if "contact_point" in (fix or {}):
        raise ConfigError(
            "is not shared, each curve has its own; leave it out", "fix.contact_point"
        )
    sources = gather(curves, segment, fields)
    if len(sources) < 2:
        raise ConfigError("holds one curve, and a pool needs two; use fit", "curves")
    rows, every, ratio = [], [], None
    for source in sources:
        measured = source.curve
        if isinstance(measured, PellicleError):
            raise measured
        asked = question(
            indenter,
            source.fields,
            is_depth=measured.depth is not None,
            kernel=kernel,
            poissons_ratio=poissons_ratio,
            fix=fix,
            baseline=baseline,
            segment=segment,
        )
        ratio = asked.poissons_ratio
        try:
            rows.append(cleaned(measured, segment))
            asked = modelled(
                asked,
                rows[-1],
                cache=cache,
                executor=executor,
                grid_points=grid_points,
                progress=progress,
            )
            every.append(explain(rows[-1], asked))
        except ConfigError as error:
            raise ConfigError(f"{source.name}: {error}; leave it out") from None
    return _fitted([source.name for source in sources], rows, every, ratio)


def _fitted(
    names: list[str], rows: list[Curve], every: list[Explained], ratio: float | None
) -> PooledFit:
    pool = Pool.of([each.likelihood for each in every])
    begun = _begun(pool, every)
    singles = [
        _alone(each, part) for each, part in zip(every, pool.parts(begun.parameters), strict=True)
    ]
    degrees = sum(k in pool.free for k in _SHARED) * (len(every) - 1)
    rise = allowed_rise(sum(each.freedom for each in every))
    spread = max(begun.chi_squared - sum(single.chi_squared for single in singles), 0.0)
    factor = max(spread / degrees, 1.0) if chdtrc(degrees, spread) < _CHANCE else 1.0
    best, without, ends = _profiled(pool, begun, rise * factor)
    messages: list[str] = []
    ends = widened(ends, pool, best, messages)
    bound = pool.deviations(best.parameters)

    def estimate(which: int, unit: str) -> Estimate:
        value = float(best.parameters[which])
        if which not in pool.free:
            return Estimate(value, value, value, unit, 0.0, held=True)
        return Estimate(value, *ends[which], unit, float(bound[which]))

    modulus, tension = of_log(estimate(MODULUS, "Pa")), estimate(TENSION, "N/m")
    bounds = pool.parts(bound)
    curves = []
    for number, part in enumerate(pool.parts(best.parameters)):
        member, own = pool.members[number], list(every[number].messages)
        plausible(
            rows[number],
            member.indenter,
            float(part[POINT]),
            modulus.value,
            tension.value,
            own,
        )
        point, held = float(part[POINT]), POINT not in member.free
        end = point if held else None
        curves.append(
            PooledCurve(
                name=names[number],
                model=described(member.indenter),
                contact_point=Estimate(point, end, end, "m", float(bounds[number][POINT]), held),
                offset=float(part[OFFSET]),
                slope=float(part[SLOPE]),
                noise=member.noise,
                points=member.force.size,
                chi_squared=member.chi_squared(part),
                chi_squared_alone=singles[number].chi_squared,
                reduced_modulus_alone=float(np.exp(singles[number].parameters[MODULUS])),
                tension_alone=float(singles[number].parameters[TENSION]),
                messages=tuple(own),
            )
        )
    return PooledFit(
        reduced_modulus=modulus,
        tension=tension,
        youngs_modulus=youngs_modulus(modulus, ratio),
        curves=tuple(curves),
        chi_squared=best.chi_squared,
        chi_squared_without_tension=without.chi_squared,
        comparison=comparison(tension, without.chi_squared - best.chi_squared),
        agreement=_agreement(curves, spread, degrees, factor),
        advice=_advice(modulus, tension),
        messages=(*messages, *_open(modulus, tension)),
        pool=pool,
        parameters=best.parameters,
        parameters_without_tension=without.parameters,
        rise=rise * factor,
    )


def _begun(pool: Pool, every: Sequence[Explained]) -> Minimum:
    """Return the least χ² near what the curves that tell most say alone, or near their median."""
    told = sorted(every, key=lambda each: _uncertainty(each))[:KEPT]
    median = np.median([each.parameters[_SHARED] for each in every], axis=0)
    tries = [*(each.parameters[_SHARED] for each in told), median]
    return _least(_from(pool, [each.parameters for each in every], shared) for shared in tries)


def _uncertainty(each: Explained) -> float:
    return float(each.likelihood.deviations(each.parameters)[MODULUS])


def _from(pool: Pool, parts: Sequence[Array], shared: Array) -> Minimum:
    """Return the least χ² near parameters of each curve, modulus and tension replaced."""
    begun = []
    for member, part in zip(pool.members, parts, strict=True):
        start = part.copy()
        start[_SHARED] = shared
        begun.append(member.minimise(start, _SHARED)[0])
    return Minimum(*pool.minimise(pool.joined(begun)))


def _least(found: Iterable[Minimum]) -> Minimum:
    return min(found, key=lambda each: each.chi_squared)


def _alone(each: Explained, part: Array) -> Minimum:
    """Return the least χ² of a curve by itself."""
    return _least(Minimum(*each.likelihood.minimise(start)) for start in (each.parameters, part))


def _profiled(
    pool: Pool, best: Minimum, rise: float
) -> tuple[Minimum, Minimum, dict[int, tuple[float | None, float | None]]]:
    """Return the minimum with and without tension, and the intervals of what is shared."""
    while True:
        without = _without_tension(pool, best)
        if TENSION in pool.free and without.chi_squared <= best.chi_squared + 1e-6:
            best = without
        try:
            shared = [k for k in _SHARED if k in pool.free]
            return best, without, {k: interval(pool, best, k, rise) for k in shared}
        except Better as better:
            found = Minimum(*pool.minimise(better.minimum.parameters))
            best = _least([found, better.minimum])


def _without_tension(pool: Pool, best: Minimum) -> Minimum:
    """Return the least χ² without tension, near the pool's and near each curve's by itself."""
    held = pool.without_tension()
    parts = pool.parts(best.parameters)
    for part in parts:
        part[TENSION] = 0.0
    own = [
        member.minimise(part, (TENSION,))[0]
        for member, part in zip(pool.members, parts, strict=True)
    ]
    shared = np.median([each[_SHARED] for each in own], axis=0)
    return _least([Minimum(*held.minimise(held.joined(parts))), _from(held, own, shared)])


def _agreement(curves: Sequence[PooledCurve], spread: float, degrees: int, factor: float) -> str:
    figures = f"Δχ² = {spread:.3g} for {degrees} degrees of freedom"
    if factor == 1:
        return f"the curves agree ({figures} against each on its own)"
    worst = max(curves, key=lambda curve: curve.chi_squared - curve.chi_squared_alone)
    return (
        f"the curves do not agree on what they share ({figures} against each on its own), "
        f"{worst.name} least of all; the intervals are widened by {np.sqrt(factor):.2g}"
    )


def _advice(modulus: Estimate, tension: Estimate) -> str:
    """Return the bound of what was asked for."""
    bounds = [
        f"± {percent(each.bound / each.value)} of the {name}"
        for name, each in (("modulus", modulus), ("tension", tension))
        if not each.held and each.value
    ]
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
