"""The fit of one curve or of several: modulus and tension, and what else the curves say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pellicle.arrays import Array

from .config import FitConfig
from .config_input import describe_indenter
from .estimation.candidate import Candidate
from .estimation.coordinates import MODULUS
from .estimation.intervals import CONFIDENCE, Estimate
from .estimation.moduli import of_sines
from .files.measurement import Measurement, Note
from .record import Record
from .selection.advice import Advice
from .selection.recipe import TENSION, Answer
from .words.advice import step
from .words.names import in_words, words_of
from .words.story import agreement, calibration, headline, remarks, story_lines, verdict_in_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Fit(Record):
    """Modulus and tension of one curve, or of several curves of one solid, with 95 % intervals."""

    def __init__(self, data: Mapping[str, Any], answer: Answer, config: FitConfig) -> None:
        super().__init__(data)
        self.answer = answer
        """All explanations that were compared, with their curves, and the verdict."""
        self.config = config
        """The configuration of the fit."""

    @property
    def reduced_modulus(self) -> Estimate:
        """E* [Pa], with an interval over all that the curves cannot tell apart."""
        return self.estimates()["reduced_modulus"]

    @property
    def youngs_modulus(self) -> Estimate | None:
        """E = (1 − ν²) E* [Pa], if Poisson's ratio was given."""
        return self.estimates().get("youngs_modulus")

    @property
    def tension(self) -> Estimate:
        """τ₀ [N/m], with an interval over all that the curves cannot tell apart."""
        return self.estimates()["tension"]

    @property
    def contact_point(self) -> Estimate:
        """Position of first touch [m], of the first curve."""
        return self.estimates()["contact_point"]

    @property
    def tension_needed(self) -> bool:
        """Whether tension beats all rivals, and what has it passes the checks of residuals."""
        return bool(self.data["tension_needed"])

    @property
    def chi_squared(self) -> float:
        """Sum of squared residuals over the noise, of the chosen explanation."""
        return float(self.data["chi_squared"])

    def forces(self) -> list[Array]:
        """Return the force [N] of the chosen explanation at the rows of each curve."""
        return self.answer.selected.forces()

    def __repr__(self) -> str:
        """Return numbers, verdict and next step; the arrays of a curve would fill a screen."""
        return "\n".join(story_lines(self))

    def _repr_html_(self) -> str:
        """Return HTML for a notebook: a sentence, the estimates, and the curve with its fit."""
        from .report.page import html_of_fit

        return html_of_fit(self)

    def plot(self) -> Figure:
        """Return a figure of pyplot with the data, the fit, and how well it determines it."""
        from .report.figures import plot

        return plot(self)


def data_of_fit(
    answer: Answer,
    curves: Sequence[tuple[str, Measurement]],
    needs: Sequence[Advice],
    poissons_ratio: float | None,
    config: FitConfig,
) -> dict[str, Any]:
    """Return what is known of curves, each with its name, as JSON data: all that a fit shows."""
    selected, question = answer.selected, answer.question
    over_tied = {name: answer.over_tied(name) for name in (MODULUS, TENSION)}
    if_present = dict(answer.if_present)
    if poissons_ratio is not None:
        for moduli in filter(None, (over_tied, if_present)):
            moduli["youngs_modulus"] = moduli[MODULUS].times(1 - poissons_ratio**2)
    parameters = {**answer.if_present, **selected.all_estimates}
    of_all = [*remarks(answer)]
    messages = [*_messages(answer, curves), *of_all]
    target = [question.target] if question.target else []
    return {
        **{name: estimate.to_dict() for name, estimate in over_tied.items()},
        "parameters": {name: estimate.to_dict() for name, estimate in parameters.items()},
        "correlations": [
            {"of": [*pair], "value": value} for pair, value in selected.correlations.items()
        ],
        "if_present": {name: estimate.to_dict() for name, estimate in if_present.items()},
        "target": {
            "effects": sorted(question.of_target),
            "words": in_words(target),
            "quantities": [
                name for name in question.open_quantities if name in selected.parameters
            ],
        },
        "baseline": [effect.type_name for effect in answer.baseline],
        "model": {"effects": sorted(selected.types), "words": words_of(selected)},
        "verdict": answer.verdict.value,
        "headline": headline(answer),
        "comparison": verdict_in_words(answer),
        "tension_needed": answer.tension_needed,
        "at_this_speed": answer.at_this_speed,
        "agreement": agreement(answer, [name for name, _ in curves]),
        "widening": answer.agreement.factor,
        "next": [step(advice)._asdict() for advice in needs],
        "confidence": CONFIDENCE,
        "calibration": calibration(config.uncertainty),
        "chi_squared": answer.chi_squared(selected),
        "threshold": answer.threshold,
        "margin": answer.decision.margin,
        "lead": answer.decision.delta_aic,
        "poissons_ratio": poissons_ratio,
        "explanations": [_explanation(answer, fit) for fit in answer.explanations],
        "excused": [
            {"effects": sorted(types), "reason": reason} for types, reason in answer.excused.items()
        ],
        "not_weighed": [sorted(types) for types in answer.not_weighed],
        "curves": [_curve(answer, i, *curve, config) for i, curve in enumerate(curves)],
        "remarks": of_all,
        "messages": messages,
        "notes": [text for text in messages if isinstance(text, Note)],
        "configuration": config.to_dict(),
    }


def _messages(answer: Answer, curves: Sequence[tuple[str, Measurement]]) -> list[str]:
    """Return what is said of each curve; of one of several with its name."""
    found = list[str]()
    for (name, measured), checked in zip(curves, answer.judgements, strict=True):
        own = *measured.messages, *checked.failed_checks.values()
        found += own if len(curves) == 1 else [type(text)(f"{name}: {text}") for text in own]
    return found


def _explanation(answer: Answer, fit: Candidate) -> dict[str, Any]:
    """Return one of the explanations; quantities whose intervals were not sought lack ends."""
    bare = {name: {"value": e.value, "unit": e.unit} for name, e in fit.parameters.items()}
    return {
        "effects": sorted(fit.types),
        "words": words_of(fit),
        "chi_squared": answer.chi_squared(fit),
        "delta_aic": fit.aic - answer.explanations[0].aic,
        "tied": fit in answer.tied,
        "search": fit.minimum.ending.name.lower(),
        "holds_modulus": fit not in answer.not_held,
        "parameters": bare | {name: e.to_dict() for name, e in fit.all_estimates.items()},
    }


def _curve(
    answer: Answer, i: int, name: str, measured: Measurement, config: FitConfig
) -> dict[str, Any]:
    """Return one of the curves, with what the chosen explanation says of it alone."""
    selected, checked = answer.selected, answer.judgements[i]
    curve, sought = selected.all_rows[i], selected.all_estimates
    slots = [slot for slot in answer.selected.objective.slots if slot.curve == i]
    return {
        "name": name,
        "indenter": describe_indenter(curve.indenter),
        "points": curve.position.size,
        "noise": {"value": checked.deviation, "unit": "N"},
        "noise_weighed": {"value": checked.noise.deviation, "unit": "N"},
        "failed_checks": [
            {"code": code, "message": text} for code, text in checked.failed_checks.items()
        ],
        "messages": list(measured.messages),
        "quantities": [slot.full_name for slot in slots],
        "sines": [
            {quantity: e.to_dict() for quantity, e in sine.items()}
            for sine in of_sines(selected, i)
        ],
        **{s.name: sought[s.full_name].to_dict() for s in slots if s.full_name in sought},
        "data": data_of(measured, config),
    }


def data_of(curve: Measurement, config: FitConfig) -> dict[str, Any]:
    """Return the origin of a curve, and which part of it is fitted, as JSON data."""
    return {
        **curve.origin._asdict(),
        "spring_constant": curve.stiffness,
        "segment": config.segment,
        "baseline": config.baseline,
        "poissons_ratio": config.poissons_ratio,
    }
