"""Whether a tension is needed: its rivals, how well each describes the curves, and the verdict."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from typing import Any, Literal, NamedTuple

import numpy as np

from pellicle.units import decimal, readable

from .models.adhesive import WORK_OF_ADHESION, AdhesiveModel
from .models.relaxing import EXPONENT
from .parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION, Coordinates, Parameter
from .statistics.checks import judged
from .statistics.experiments import advised
from .statistics.likelihood import ChiSquared, Likelihood, Minimum
from .statistics.noise import FailedCheck, doubt_of_tension
from .statistics.pooled_likelihood import Pool
from .statistics.profile import (
    Ends,
    Estimate,
    curvature_interval,
    estimate_of,
    united,
)
from .statistics.rivals import MARGIN, NONE, TENSED, Rival, rivals
from .wording import in_words, words

_OF_PARAMETER = 6.0
"""Difference of AIC by which an effect must beat its absence: chance alone does so in 0.2 %."""
_OF_MANY = 12.0
"""Difference of AIC by which the best of many rivals must beat no effect at all."""
_LIKELIER = 2.0
"""Difference of AIC that a pair of effects which is not needed exceeds in 5 % of curves."""
_FIRST_TENSIONS = (0.03, 0.3)
"""Tensions from which a search for one starts, over modulus and depth."""
_FAR = 100.0
"""Difference of AIC beyond which intervals come from the curvature of χ²: their models describe the
curves so badly that profiles, a third of the time of a comparison, would say nothing more."""
_RELAXING = "tension+power_law"
"""The pair that approaches at one speed cannot exclude, though they may not need it."""
_ONE_SPEED = 1.5
"""Ratio of speeds up to which curves count as measured at one."""
_BESIDE = {CONTACT_POINT.name, OFFSET.name, SLOPE.name}
"""Parameters of every curve, of which a comparison tells nothing."""
Intervals = Literal["none", "profile", "curvature"]
Verdict = Literal["needed", "not shown", "undecided", "other"]


@dataclass(frozen=True)
class RivalFit:
    """One explanation of the curves, and how well it describes them."""

    rival: Rival
    chi_squared: float
    aic: float
    """Akaike's criterion, over that of the best."""
    bic: float
    """Bayes' criterion (Schwarz), over that of the best."""
    parameters: Coordinates
    estimates: dict[str, Estimate]
    """The parameters by name; their intervals only if the model is chosen, or if the comparison was
    requested."""
    intervals: Intervals = "none"
    """How the intervals were found."""

    def to_dict(self) -> dict[str, Any]:
        """Return the explanation as JSON data."""
        return {
            "name": self.rival.code,
            "tension": self.rival.has_tension,
            "chi_squared": self.chi_squared,
            "delta_aic": self.aic,
            "delta_bic": self.bic,
            "intervals": self.intervals,
            "parameters": {name: value.to_dict() for name, value in self.estimates.items()},
        }


@dataclass(frozen=True)
class Comparison:
    """The explanations of the curves, best first, and whether they need a tension."""

    fits: tuple[RivalFit, ...]
    verdict: Verdict
    sentence: str
    advice: str
    """The measurement that would separate the explanations, if they are tied."""
    failed_checks: tuple[FailedCheck, ...]
    """Checks that the best explanation fails."""
    chosen: RivalFit | None = None
    """The explanation whose estimates count, if it is not an elastic solid under tension."""
    pull_off: str = ""
    """The pull-off force of an adhesive contact against its limits, in words."""
    at_one_speed: bool = False
    """Whether the curves are approaches at one speed, without a dwell."""
    modulus: Estimate | None = None
    """E* [Pa] with the least interval that contains those of all `alternatives`, if several."""
    tension: Estimate | None = None
    """The same of τ₀ [N/m], if a tension is needed and several alternatives have one."""

    @property
    def best(self) -> RivalFit:
        """The explanation with the least AIC."""
        return self.fits[0]

    @property
    def tied(self) -> tuple[RivalFit, ...]:
        """The explanations that the curves cannot tell from the best, the best included."""
        return tuple(fit for fit in self.fits if fit.aic < MARGIN)

    @property
    def alternatives(self) -> tuple[RivalFit, ...]:
        """The explanation whose estimates count, and those that are tied with it.

        A pair, which is never far behind one of its effects, counts if both are less likely than
        it.  That of a tension and relaxation always counts at one speed, at which a power law bends
        the curve as a tension does, so that neither shows as long as the other is free.  Of curves
        that need no tension only other shapes count, which have no parameter more, and what is
        better than no effect by the margin.
        """
        aic = {fit.rival.code: fit.aic for fit in self.fits}

        def counts(fit: RivalFit) -> bool:
            if self.verdict == "not shown":
                return fit.rival.of_shape or fit.aic + _OF_PARAMETER <= aic[NONE.code]
            single = fit.rival.code.partition("+")[2]
            effects = aic[TENSED.code], aic.get(single, np.inf)
            if self.at_one_speed and fit.rival.code == _RELAXING:
                return True
            return not single or fit.aic + _LIKELIER <= min(effects)

        chosen = TENSED.code if self.chosen is None else self.chosen.rival.code
        return tuple(
            fit
            for fit in self.fits
            if fit.rival.code == chosen or (fit.aic < MARGIN and counts(fit))
        )

    def rows(self, *, si: bool = False) -> list[dict[str, str]]:
        """Return a line of a table for each explanation."""
        return [
            {
                "model": fit.rival.words,
                "χ²": decimal(fit.chi_squared, 4),
                "ΔAIC": decimal(fit.aic, 3),
                "ΔBIC": decimal(fit.bic, 3),
                "parameters": ", ".join(
                    f"{words(name)} {in_words(estimate, si=si, sought=False)}"
                    for name, estimate in fit.estimates.items()
                )
                + ("; intervals by curvature" if fit.intervals == "curvature" else ""),
            }
            for fit in self.fits
        ]

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison as JSON data."""
        return {
            "verdict": self.verdict,
            "sentence": self.sentence,
            "advice": self.advice,
            "tied": [fit.rival.code for fit in self.tied],
            "margin": MARGIN,
            "chosen": None if self.chosen is None else self.chosen.rival.code,
            "pull_off": self.pull_off,
            "alternatives": [fit.rival.code for fit in self.alternatives],
            "reduced_modulus": None if self.modulus is None else self.modulus.to_dict(),
            "tension": None if self.tension is None else self.tension.to_dict(),
            "models": [fit.to_dict() for fit in self.fits],
        }


def compare(
    chi_squared: ChiSquared,
    best: Minimum,
    without: Minimum,
    *,
    threshold: float,
    full: bool = True,
    pairs: bool = True,
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
    full
        Whether all explanations get intervals; otherwise only the one that is chosen.
    pairs
        Whether a tension is compared beside each other effect; otherwise only if no single effect
        passes its checks, or beside one that leads, and adhesion.
    report
        Called with the name of each explanation.
    """
    every = rivals(chi_squared, best.parameters)
    minima: dict[str, tuple[Rival, Minimum]] = {
        NONE.code: (NONE, without),
        TENSED.code: (TENSED, best),
    }

    def add(rival: Rival, starts: Sequence[Coordinates]) -> None:
        report(rival.words)
        pair, known = rival.minimum(chi_squared, starts), minima.get(rival.code)
        if pair and (known is None or pair[1].chi_squared < known[1].chi_squared):
            minima[rival.code] = pair

    for rival in every:
        if rival.code not in minima and not rival.has_tension:
            add(rival, [without.parameters, best.parameters])
    quiet, failed = _at_its_noise(chi_squared, minima)
    at_one_speed = _at_one_speed(chi_squared)
    alone = {code: _criterion(chi_squared, pair) for code, pair in minima.items()}
    singles = {rival.code: rival for rival in every if rival.is_single}
    every_pair = pairs or any(check.of_model for check in failed)
    for rival in every:
        single = rival.code.partition("+")[2]
        # What leads alone may hide a tension beside it, as a tension may hide adhesion.
        leads = (
            single == min(alone, key=alone.__getitem__)
            or (single == "adhesion" and alone.get(single, np.inf) + _OF_MANY <= alone[NONE.code])
            or (rival.code == _RELAXING and at_one_speed)
        )
        if single and (every_pair or leads):
            start = minima.get(single, (NONE, without))[1]
            add(rival, [best.parameters, *_tensed(chi_squared, start)])
            pair = minima.get(rival.code)
            # χ² of adhesion jumps as the contact point passes a row, and a search may stop there:
            # so a pair with next to no tension had beaten the adhesion in it by 15.
            if pair and single in minima and _criterion(chi_squared, pair) < alone[single]:
                add(singles[single], [pair[1].parameters])
    quiet, failed = _at_its_noise(chi_squared, minima)
    report("intervals")
    fits = _ranked(quiet, minima, threshold if full else None)
    comparison = replace(_judge(quiet, fits, failed), at_one_speed=at_one_speed)
    if comparison.chosen is not None:
        comparison = _with_intervals(quiet, comparison, comparison.chosen, threshold)
    return _over_alternatives(quiet, comparison, threshold)


def _at_one_speed(chi_squared: ChiSquared) -> bool:
    """Whether the curves are approaches at one speed, without a dwell."""
    speeds = []
    for member, _ in chi_squared.curves(dict.fromkeys(chi_squared.parameters, 0.0)):
        if member.segment != "approach" or member.history.dwells:
            return False
        speeds.append(float(np.median(member.history.velocity)))
    return max(speeds) <= _ONE_SPEED * min(speeds)


def _over_alternatives(
    chi_squared: ChiSquared, comparison: Comparison, threshold: float
) -> Comparison:
    """Return the comparison with intervals of modulus and tension over all tied explanations."""
    if len(comparison.alternatives) < 2:
        return comparison
    chosen = TENSED.code if comparison.chosen is None else comparison.chosen.rival.code
    needed = comparison.verdict == "needed"
    estimates = {
        fit.rival.code: _shared_estimates(chi_squared, fit, threshold, tension=needed)
        for fit in comparison.alternatives
    }

    def over_all(name: str) -> Estimate:
        parts = [own[name] for own in estimates.values() if name in own]
        low, high = reduce(united, ((part.low, part.high) for part in parts))
        return replace(estimates[chosen][name], low=low, high=high)

    comparison = replace(comparison, modulus=over_all(MODULUS.name))
    if not needed:
        return comparison
    comparison = replace(comparison, tension=over_all(TENSION.name))
    if chosen == _RELAXING or _RELAXING not in estimates:
        return comparison
    exponent = estimates[_RELAXING][EXPONENT.name].high
    size = "" if exponent is None else f" of an exponent up to {decimal(exponent, 2)}"
    beside = (
        f"at one speed power-law relaxation{size} beside it would not show, at a second it would"
    )
    return replace(comparison, sentence=f"{comparison.sentence}; {beside}")


def _shared_estimates(
    chi_squared: ChiSquared, fit: RivalFit, threshold: float, *, tension: bool
) -> dict[str, Estimate]:
    """Return the modulus of an explanation, and its tension if requested, with intervals."""
    if fit.intervals == "profile":
        return fit.estimates
    mine = fit.rival.of(chi_squared)
    parameters = [MODULUS, *[p for p in (TENSION, EXPONENT) if tension and p in mine.free]]
    minimum = Minimum(fit.parameters, fit.chi_squared)
    minimum, ends = fit.rival.intervals(chi_squared, minimum, threshold, parameters)
    return _estimates(mine, minimum, ends)


def _with_intervals(
    chi_squared: ChiSquared, comparison: Comparison, chosen: RivalFit, threshold: float
) -> Comparison:
    """Return the comparison with intervals of the chosen explanation, and its pull-off force."""
    mine = chosen.rival.of(chi_squared)
    fits, better = comparison.fits, chosen
    if chosen.intervals != "profile":
        minimum = Minimum(chosen.parameters, chosen.chi_squared)
        minimum, ends = chosen.rival.intervals(chi_squared, minimum, threshold, _reported(mine))
        better = replace(
            chosen,
            chi_squared=minimum.chi_squared,
            parameters=minimum.parameters,
            estimates=_estimates(mine, minimum, ends),
            intervals="profile",
        )
        fits = tuple(better if fit is chosen else fit for fit in fits)
    member, part = mine.curves(better.parameters)[0]
    return replace(comparison, fits=fits, chosen=better, pull_off=_pull_off(member, part))


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
    mine = rival.of(chi_squared)
    parts = mine.curves(minimum.parameters)
    misfit = sum(
        member.force.size * float(np.log(member.chi_squared(part) * member.noise**2))
        for member, part in parts
    )
    return misfit + 2 * _size(rival, mine)


def _at_its_noise(
    chi_squared: ChiSquared, minima: dict[str, tuple[Rival, Minimum]]
) -> tuple[ChiSquared, list[FailedCheck]]:
    """Return χ² with the noise of each curve as the best explanation shows it, and failed checks.

    Tolerances of searches are absolute in χ²: at the noise of a model that fails, a hundred times
    as large, they would hide the minimum.
    """
    rival, minimum = min(minima.values(), key=partial(_criterion, chi_squared))
    members: list[Likelihood] = []
    failed: list[FailedCheck] = []
    best = rival.of(chi_squared).curves(minimum.parameters)
    for (member, _), (own, part) in zip(
        chi_squared.curves(dict.fromkeys(chi_squared.parameters, 0.0)), best, strict=True
    ):
        estimate, _ = judged(own, part)
        members.append(replace(member, noise=estimate.noise.deviation))
        failed += estimate.failed
    if isinstance(chi_squared, Pool):
        return replace(chi_squared, members=tuple(members)), failed
    return members[0], failed


def _ranked(
    chi_squared: ChiSquared, minima: dict[str, tuple[Rival, Minimum]], threshold: float | None
) -> list[RivalFit]:
    """Return the explanations, best first; with intervals if there is a threshold of them."""
    points = sum(
        member.force.size
        for member, _ in chi_squared.curves(dict.fromkeys(chi_squared.parameters, 0.0))
    )
    rows = []
    for rival, minimum in minima.values():
        mine = rival.of(chi_squared)
        here = minimum._replace(chi_squared=mine.chi_squared(minimum.parameters))
        rows.append((rival, mine, here))
    first = min(start.chi_squared + 2 * _size(rival, mine) for rival, mine, start in rows)
    fits = []
    for rival, mine, start in rows:
        minimum, size = start, _size(rival, mine)
        ends: dict[Parameter, Ends] = {}
        intervals: Intervals = "none"
        if threshold is not None and start.chi_squared + 2 * size - first <= _FAR:
            minimum, ends = rival.intervals(chi_squared, start, threshold, _reported(mine))
            intervals = "profile"
        elif threshold is not None:
            bounds = mine.deviations(start.parameters)
            ends = {p: curvature_interval(p, start, bounds, threshold) for p in _reported(mine)}
            intervals = "curvature"
        bic = minimum.chi_squared + float(np.log(points)) * size
        fits.append(
            RivalFit(
                rival,
                minimum.chi_squared,
                minimum.chi_squared + 2 * size,
                bic,
                minimum.parameters,
                _estimates(mine, minimum, ends),
                intervals,
            )
        )
    aic, bic = min(fit.aic for fit in fits), min(fit.bic for fit in fits)
    fits = [replace(fit, aic=fit.aic - aic, bic=fit.bic - bic) for fit in fits]
    return sorted(fits, key=lambda fit: fit.aic)


def _size(rival: Rival, chi_squared: ChiSquared) -> int:
    """Return the number of fitted parameters as criteria count them."""
    return len(chi_squared.free) + rival.searched


def _reported(chi_squared: ChiSquared) -> list[Parameter]:
    """Return the fitted parameters of which a comparison tells the values."""
    return [p for p in chi_squared.parameters if p in chi_squared.free and p.name not in _BESIDE]


def _estimates(
    chi_squared: ChiSquared, minimum: Minimum, ends: dict[Parameter, Ends]
) -> dict[str, Estimate]:
    """Return estimates by name, with intervals that are known; none of a tension that is fixed."""
    bounds = chi_squared.deviations(minimum.parameters)
    return {
        p.name: estimate_of(p, chi_squared, minimum, ends.get(p, (None, None)), bounds)
        for p in chi_squared.parameters
        if p.name not in _BESIDE and (p in chi_squared.free or p != TENSION)
    }


class Decision(NamedTuple):
    """What criteria of explanations say of a tension."""

    verdict: Verdict
    tensed: str
    """Name of the best explanation with a tension."""
    other: str
    """Name of the best explanation without."""
    lead: float
    """AIC of the latter over that of the former."""


def decision(aic: Mapping[str, float], *, doubted: bool, margin: float) -> Decision:
    """Return what Akaike's criteria of explanations, by name, say of a tension.

    ``doubted`` tells whether the best fails a check of its residuals.  Explanations that differ by
    less than ``margin`` cannot be told apart.
    """
    ranked = sorted(aic, key=aic.__getitem__)

    def describes(code: str) -> bool:
        # A tension beside an effect explains the curves only if neither does as well alone.
        tension, _, effect = code.partition("+")
        alone = min(aic[TENSED.code], aic.get(effect, np.inf))
        return code == TENSED.code or (
            tension == TENSED.code and alone - aic[code] >= _OF_PARAMETER
        )

    tensed = next(code for code in ranked if describes(code))
    other = next(code for code in ranked if code.partition("+")[0] != TENSED.code)
    lead = aic[other] - aic[tensed]
    verdict: Verdict = "undecided"
    if doubted:
        verdict = "other"
    elif aic[NONE.code] - aic[tensed] < _OF_PARAMETER:
        # The best of many rivals beats a clean curve by more than one of them does.
        verdict = "other" if aic[other] + _OF_MANY <= aic[NONE.code] else "not shown"
    elif abs(lead) >= margin:
        verdict = "needed" if lead > 0 else "other"
    return Decision(verdict, tensed, other, lead)


def _judge(
    chi_squared: ChiSquared,
    fits: Sequence[RivalFit],
    failed: Sequence[FailedCheck],
) -> Comparison:
    """Return the verdict on ranked explanations."""
    by_code = {fit.rival.code: fit for fit in fits}
    doubted = bool(doubt_of_tension(failed))
    aic = {code: fit.aic for code, fit in by_code.items()}
    verdict, tensed_name, other_name, lead = decision(aic, doubted=doubted, margin=MARGIN)
    with_tension, first = by_code[tensed_name], by_code[other_name]
    tensed, none = by_code[TENSED.code], by_code[NONE.code]
    curves = "this curve" if isinstance(chi_squared, Likelihood) else "these curves"
    advice = ""
    chosen = None
    sentence = ""
    if doubted:
        chosen = fits[0] if tensed.aic >= MARGIN else None
        sentence = (
            f"no model describes {curves}: that of least AIC is {fits[0].rival.words}, and it "
            f"fails a check ({', '.join(dict.fromkeys(c.code for c in failed if c.of_model))})"
        )
        if "adhesion" in {check.code for check in failed}:
            sentence += "; the force dips before contact, which is adhesion"
    elif verdict == "needed":
        chosen = with_tension
        gain = none.chi_squared - with_tension.chi_squared
        sentence = (
            f"tension is needed (Δχ² = {decimal(gain, 3)}, "
            f"ΔAIC = {decimal(none.aic - with_tension.aic, 3)} against none; "
            f"ΔAIC = {decimal(lead, 3)} against {first.rival.words}, the best without it)"
        )
        if with_tension.rival != TENSED:
            beside = with_tension.rival.words.removeprefix("tension and ")
            sentence += f"; beside it there is {beside}"
    elif verdict == "other":
        chosen = first
        sentence = f"{first.rival.words} describes {curves}, without tension"
        if none.aic - with_tension.aic >= _OF_PARAMETER:
            sentence = (
                f"{first.rival.words} describes {curves} better than tension "
                f"(ΔAIC = {decimal(-lead, 3)}), so this is not evidence of a tension"
            )
    elif verdict == "undecided":
        without = [fit for fit in fits if not fit.rival.has_tension]
        tied = [fit for fit in without if abs(fit.aic - with_tension.aic) < MARGIN]
        names = [
            f"{fit.rival.words} (Δχ² = {decimal(fit.chi_squared - with_tension.chi_squared, 2)})"
            for fit in tied
        ]
        sentence = f"{curves} cannot tell {with_tension.rival.words} from {_listed(names)}"
        advice = advised(
            chi_squared,
            (with_tension.rival, with_tension.parameters),
            [(fit.rival, fit.parameters) for fit in tied],
        )
    if chosen is not None and chosen.rival == TENSED:
        chosen = None
    return Comparison(tuple(fits), verdict, sentence, advice, tuple(failed), chosen)


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} or {names[-1]}"
