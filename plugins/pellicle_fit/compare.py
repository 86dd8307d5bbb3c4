"""Compare explanations of curves: an elastic solid under tension, and its rivals."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np

from pellicle.errors import ConvergenceError
from pellicle.units import readable

from .alternatives import over_alternatives, reported_estimates, reported_parameters, unseen_pairs
from .comparison import Comparison, Intervals, RivalFit
from .models.adhesive import WORK_OF_ADHESION, AdhesiveModel
from .parameters import MODULUS, TENSION, Coordinates
from .statistics.checks import judged
from .statistics.chi_squared import ChiSquared, Minimum
from .statistics.likelihood import Likelihood
from .statistics.noise import FailedCheck, is_beyond_chance
from .statistics.pooled_likelihood import Excess
from .statistics.profile import OPEN, curvature_interval
from .statistics.rival import Rival
from .statistics.rivals import MARGIN, NONE, SLOPED, TENSED, rivals, sloped
from .verdict import MANY_MARGIN, judge

_FIRST_TENSIONS = (0.03, 0.3)
"""Tensions from which a search for one starts, over modulus and depth."""
_FAR = 100.0
"""Difference of AIC beyond which intervals come from the curvature of χ²: their models describe the
curves so badly that profiles, a third of the time of a comparison, would say nothing more."""
_Minima = dict[str, tuple[Rival, Minimum]]
"""Explanations with their minima of χ², by code."""


def compare(
    chi_squared: ChiSquared,
    best: Minimum,
    without: Minimum,
    *,
    threshold: float,
    elastic_fails: bool = False,
    full: bool = False,
    pairs: bool = False,
    counts: bool = True,
    report: Callable[[str], None] = lambda stage: None,
) -> Comparison:
    """Return how rivals of a tension describe the curves.

    Parameters
    ----------
    chi_squared
        That of the elastic solid under tension, whose tension is free.
    best, without
        Its minima with and without tension.
    threshold
        Δχ² at the ends of intervals.
    elastic_fails
        Whether the elastic solid under tension fails a check of its residuals.
    full
        Whether all explanations get intervals, and a tension is fitted beside each other effect, to
        be listed; what is chosen, and over which models the modulus is told, does not depend on it.
    pairs
        Whether a tension is compared beside each other effect; otherwise only if no single effect
        passes its checks, or beside one that leads, adhesion, and relaxation at one speed.
    counts
        Whether there is a tension to doubt; otherwise explanations are only listed.
    report
        Called with the name of each explanation.
    """
    minima = _minima(chi_squared, best, without, pairs=pairs, report=report)
    quiet, failed = _at_its_noise(chi_squared, minima)
    best_rival, best_minimum = _best(chi_squared, minima)
    excess = _disagreement(quiet, best_rival, best_minimum)
    if excess is not None:
        widened = float(np.sqrt(excess.factor))
        quiet = quiet.with_members([replace(m, noise=widened * m.noise) for m in quiet.members])
    report("intervals")
    fits = _ranked(quiet, minima, minima)
    comparison = Comparison(tuple(fits), "not shown", "", "", (), margin=max(MARGIN, threshold))
    if counts:
        comparison = judge(quiet, fits, failed, threshold, elastic_fails)
        comparison = replace(comparison, unseen=unseen_pairs(chi_squared))
        if excess is not None and comparison.sentence:
            sentence = f"{comparison.sentence}; under {best_rival.words}, too, {excess.agreement()}"
            comparison = replace(comparison, sentence=sentence)
        if comparison.chosen is not None and not comparison.untried:
            comparison = _with_chosen(quiet, comparison, comparison.chosen, threshold)
        if not comparison.untried:
            comparison = over_alternatives(quiet, comparison, threshold)
    if not full:
        return comparison
    listed = dict(minima)
    for rival in rivals(chi_squared, best.parameters):
        if rival.code not in minima and rival.has_tension:
            report(rival.words)
            _, single = minima.get(rival.code.partition("+")[2], (NONE, without))
            starts = [best.parameters, *_tensed(chi_squared, single)]
            if pair := rival.minimum(chi_squared, starts):
                listed[rival.code] = pair
    further = [fit for fit in _ranked(quiet, listed, minima) if not fit.compared]
    every = [*comparison.fits, *further]
    if not comparison.untried:
        every = [_with_intervals(quiet, fit, threshold) for fit in every]
    return replace(comparison, fits=tuple(sorted(every, key=lambda fit: fit.aic)))


def _minima(
    chi_squared: ChiSquared,
    best: Minimum,
    without: Minimum,
    *,
    pairs: bool,
    report: Callable[[str], None],
) -> _Minima:
    """Return the minima of all explanations that are compared; see `compare`."""
    every = rivals(chi_squared, best.parameters)
    minima: _Minima = {NONE.code: (NONE, without), TENSED.code: (TENSED, best)}

    def add(rival: Rival, starts: Sequence[Coordinates]) -> None:
        report(rival.words)
        pair, known = rival.minimum(chi_squared, starts), minima.get(rival.code)
        if pair and (known is None or pair[1].chi_squared < known[1].chi_squared):
            minima[rival.code] = pair

    for rival in every:
        if rival.code not in minima and not rival.has_tension:
            add(rival, [without.parameters, best.parameters])
    _, failed = _at_its_noise(chi_squared, minima)
    alone = {code: _criterion(chi_squared, pair) for code, pair in minima.items()}
    singles = {rival.code: rival for rival in every if rival.is_single}
    every_pair = pairs or any(check.of_model for check in failed)
    for rival in every:
        single = rival.code.partition("+")[2]
        # What leads alone may hide a tension beside it, as a tension may hide adhesion.
        leads = (
            single == min(alone, key=alone.__getitem__)
            or (
                single == "adhesion" and alone.get(single, np.inf) + MANY_MARGIN <= alone[NONE.code]
            )
            or (single == "power_law" and rival.code in unseen_pairs(chi_squared))
        )
        if single and (every_pair or leads):
            start = minima.get(single, (NONE, without))[1]
            add(rival, [best.parameters, *_tensed(chi_squared, start)])
            pair = minima.get(rival.code)
            # χ² of adhesion jumps as the contact point passes a row, and a search may stop there:
            # so a pair with next to no tension had beaten the adhesion in it by 15.
            if pair and single in minima and _criterion(chi_squared, pair) < alone[single]:
                add(singles[single], [pair[1].parameters])
    leading, least = _best(chi_squared, minima)
    if leading.code in (SLOPED.code, sloped(TENSED).code):
        # A slope that was found may hide what bends the curves, as one that is given does not.
        for effect in singles.values():
            if effect.code in minima and effect not in (NONE, TENSED, SLOPED):
                known = minima[effect.code][1].parameters
                add(sloped(effect), [least.parameters | {p: known[p] for p in effect.own}])
    return minima


def _with_chosen(
    chi_squared: ChiSquared, comparison: Comparison, chosen: RivalFit, threshold: float
) -> Comparison:
    """Return the comparison with intervals of the chosen explanation, and its pull-off force."""
    better = _with_intervals(chi_squared, chosen, threshold)
    fits = tuple(better if fit is chosen else fit for fit in comparison.fits)
    member, part = better.rival.of(chi_squared).curves(better.parameters)[0]
    return replace(comparison, fits=fits, chosen=better, pull_off=_pull_off(member, part))


def _with_intervals(chi_squared: ChiSquared, fit: RivalFit, threshold: float) -> RivalFit:
    """Return an explanation with intervals, if it has none.

    A profile may find a better minimum.  The criteria stay those by which the verdict was made.
    """
    if fit.intervals != "none":
        return fit
    of_rival, minimum = fit.rival.of(chi_squared), Minimum(fit.parameters, fit.chi_squared)
    reported = reported_parameters(of_rival)
    intervals: Intervals = "profile" if fit.aic <= _FAR else "curvature"
    if intervals == "profile":
        minimum, ends = fit.rival.intervals(chi_squared, minimum, threshold, reported)
    else:
        bounds = of_rival.deviations(minimum.parameters)
        ends = {p: curvature_interval(p, minimum, bounds, threshold) for p in reported}
    if not fit.rival.has_size:
        ends[MODULUS] = OPEN
    return replace(
        fit,
        parameters=minimum.parameters,
        estimates=reported_estimates(of_rival, minimum, ends),
        intervals=intervals,
    )


def _pull_off(member: Likelihood, part: Coordinates) -> str:
    """Return the pull-off force of an adhesive contact with a radius, over its limits."""
    model = member.force_model
    if not isinstance(model, AdhesiveModel):
        return ""
    radius = getattr(model.elastic.indenter, "radius", None)
    if radius is None:
        return ""
    values = {p: p.value(part[p]) for p in model.parameters}
    force = -model.pull_off(values)
    share = force / (np.pi * values[WORK_OF_ADHESION] * radius)
    where = "between" if 0.999 <= share <= 1.501 else "outside"
    return (
        f"under a dead load it pulls off at {readable(force, 'N', 3)}, {share:.3g} πWR: {where} "
        "the limits of a paraboloid, 1 πWR where tension resists alone and 1.5 πWR where "
        "elasticity does"
    )


def _tensed(chi_squared: ChiSquared, single: Minimum) -> list[Coordinates]:
    """Return starts with some tension from a minimum without."""
    scale = chi_squared.ranges[TENSION].scale
    return [single.parameters | {TENSION: share * scale} for share in _FIRST_TENSIONS]


def _criterion(chi_squared: ChiSquared, pair: tuple[Rival, Minimum]) -> float:
    """Return Akaike's criterion for noise of unknown size, since models that fail widen it."""
    rival, minimum = pair
    of_rival = rival.of(chi_squared)
    misfit = sum(
        member.force.size * float(np.log(member.chi_squared(part) * member.noise**2))
        for member, part in of_rival.curves(minimum.parameters)
    )
    return _aic(misfit, _size(rival, of_rival))


def _aic(misfit: float, size: int) -> float:
    """Return the criterion of Akaike (1974) of a misfit, −2 log L, by ``size`` parameters."""
    return misfit + 2 * size


def _at_its_noise(chi_squared: ChiSquared, minima: _Minima) -> tuple[ChiSquared, list[FailedCheck]]:
    """Return χ² with the noise of each curve as the best explanation shows it, and failed checks.

    Checks of the model are left out if no more curves fail them than do so by chance.  Tolerances
    of searches are absolute in χ²: at the noise of a model that fails, a hundred times as large,
    they would hide the minimum.
    """
    rival, minimum = _best(chi_squared, minima)
    members: list[Likelihood] = []
    failed: list[tuple[FailedCheck, ...]] = []
    best = rival.of(chi_squared).curves(minimum.parameters)
    for member, (of_rival, part) in zip(chi_squared.members, best, strict=True):
        estimate, _ = judged(of_rival, part)
        members.append(replace(member, noise=estimate.noise.deviation))
        failed.append(estimate.failed)
    failing = sum(any(check.of_model for check in checks) for checks in failed)
    doubts = is_beyond_chance(failing, len(members))
    kept = [check for checks in failed for check in checks if doubts or not check.of_model]
    return chi_squared.with_members(members), kept


def _best(chi_squared: ChiSquared, minima: _Minima) -> tuple[Rival, Minimum]:
    """Return the explanation of least criterion, and its minimum."""
    return min(minima.values(), key=partial(_criterion, chi_squared))


def _disagreement(chi_squared: ChiSquared, rival: Rival, minimum: Minimum) -> Excess | None:
    """Return the excess of χ² by which disagreement of curves under an explanation raises noise.

    The noise is raised by the root of its factor (quasi-likelihood, Wedderburn 1974).  None is
    returned if the curves agree.
    """
    of_rival = rival.of(chi_squared)
    curves = of_rival.curves(minimum.parameters)
    if len(curves) == 1:
        return None
    together = [member.chi_squared(part) for member, part in curves]
    alone = []
    for (member, part), shared in zip(curves, together, strict=True):
        with suppress(ConvergenceError):
            shared = min(shared, member.minimise(part, rough=True).chi_squared)
        alone.append(shared)
    excess = Excess.of(of_rival, sum(together), alone)
    return excess if excess.factor > 1 else None


def _ranked(chi_squared: ChiSquared, minima: _Minima, compared: Container[str]) -> list[RivalFit]:
    """Return the explanations, best first; criteria are over the best of those ``compared``."""
    points = sum(member.force.size for member in chi_squared.members)
    fits = []
    for rival, minimum in minima.values():
        of_rival = rival.of(chi_squared)
        misfit, size = of_rival.chi_squared(minimum.parameters), _size(rival, of_rival)
        fits.append(
            RivalFit(
                rival,
                misfit,
                _aic(misfit, size),
                misfit + float(np.log(points)) * size,
                minimum.parameters,
                reported_estimates(of_rival, minimum, {}),
                compared=rival.code in compared,
            )
        )
    weighed = [fit for fit in fits if fit.compared]
    aic, bic = min(fit.aic for fit in weighed), min(fit.bic for fit in weighed)
    fits = [replace(fit, aic=fit.aic - aic, bic=fit.bic - bic) for fit in fits]
    return sorted(fits, key=lambda fit: fit.aic)


def _size(rival: Rival, chi_squared: ChiSquared) -> int:
    """Return the number of fitted parameters as criteria count them."""
    return len(chi_squared.free) + rival.searched
