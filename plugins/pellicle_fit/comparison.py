"""The explanations of curves, how well each describes them, and the verdict on a tension."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from pellicle.units import decimal

from .parameters import Coordinates
from .statistics.noise import FailedCheck, doubt_of_tension
from .statistics.profile import Estimate
from .statistics.rival import Rival
from .statistics.rivals import MARGIN, NONE, TENSED
from .wording import in_words, words

EFFECT_MARGIN = 6.0
"""Difference of AIC by which an effect must beat its absence: chance alone does so in 0.2 %."""
_PAIR_MARGIN = 2.0
"""Difference of AIC that a pair of effects which is not needed exceeds in 5 % of curves."""
Intervals = Literal["none", "profile", "curvature"]
Verdict = Literal["needed", "not shown", "undecided", "other"]


@dataclass(frozen=True)
class RivalFit:
    """One explanation of the curves, and how well it describes them."""

    rival: Rival
    chi_squared: float
    aic: float
    """Akaike's criterion, over that of the best that is compared."""
    bic: float
    """Bayes' criterion (Schwarz), over that of the best."""
    parameters: Coordinates
    estimates: dict[str, Estimate]
    """The parameters by name; their intervals only if the model is chosen, or if the comparison was
    requested."""
    intervals: Intervals = "none"
    """How the intervals were found."""
    compared: bool = True
    """Whether it is weighed; others are only listed, and decide nothing."""

    def to_dict(self) -> dict[str, Any]:
        """Return the explanation as JSON data."""
        return {
            "name": self.rival.code,
            "tension": self.rival.has_tension,
            "chi_squared": self.chi_squared,
            "delta_aic": self.aic,
            "delta_bic": self.bic,
            "intervals": self.intervals,
            "compared": self.compared,
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
    untried: str = ""
    """An explanation that may be right and has no model, in words: nothing has an interval then."""
    margin: float = MARGIN
    """Difference of AIC below which explanations cannot be told apart."""
    unseen: tuple[str, ...] = ()
    """Codes of pairs whose effect a measurement of this kind does not show beside a tension."""
    modulus: Estimate | None = None
    """E* [Pa] with the least interval that contains those of all `alternatives`, if several."""
    tension: Estimate | None = None
    """The same of τ₀ [N/m], if a tension is needed."""

    @property
    def is_decided(self) -> bool:
        """Whether the curves tell tension and none apart, and an explanation describes them."""
        return self.verdict != "undecided" and not doubt_of_tension(self.failed_checks)

    @property
    def tied(self) -> tuple[RivalFit, ...]:
        """The explanations that the curves cannot tell from the best, the best included."""
        return tuple(fit for fit in self.fits if fit.compared and fit.aic < self.margin)

    @property
    def alternatives(self) -> tuple[RivalFit, ...]:
        """The explanation whose estimates count, and those that are tied with it.

        A pair, which is never far behind one of its effects, counts if both are less likely than
        it, and always if its effect is `unseen`: that bends a curve as a tension does, so that
        neither shows as long as the other is free.  Of curves that need no tension only other
        shapes count, which have no parameter more, and what is better than no effect by the margin.
        A shape of unknown size, which determines no modulus, counts only if it is the one.
        """
        aic = {fit.rival.code: fit.aic for fit in self.fits}

        def counts(fit: RivalFit) -> bool:
            if not (fit.compared and fit.rival.has_size):
                return False
            if self.verdict == "not shown":
                return fit.rival.of_shape or fit.aic + EFFECT_MARGIN <= aic[NONE.code]
            if fit.rival.code in self.unseen:
                return True
            single = fit.rival.code.partition("+")[2]
            effects = aic[TENSED.code], aic.get(single, np.inf)
            return not single or fit.aic + _PAIR_MARGIN <= min(effects)

        chosen = TENSED.code if self.chosen is None else self.chosen.rival.code
        return tuple(
            fit
            for fit in self.fits
            if fit.rival.code == chosen or (fit.aic < self.margin and counts(fit))
        )

    def rows(self, *, si: bool = False) -> list[dict[str, str]]:
        """Return a line of a table for each explanation, and which the modulus is told over."""
        counted = [] if self.modulus is None else [fit.rival.code for fit in self.alternatives]
        return [
            {
                "model": fit.rival.words,
                "counts": "yes" if fit.rival.code in counted else "",
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
            "margin": self.margin,
            "chosen": None if self.chosen is None else self.chosen.rival.code,
            "pull_off": self.pull_off,
            "alternatives": [fit.rival.code for fit in self.alternatives],
            "reduced_modulus": None if self.modulus is None else self.modulus.to_dict(),
            "tension": None if self.tension is None else self.tension.to_dict(),
            "models": [fit.to_dict() for fit in self.fits],
        }
