"""The fit of one curve or of several: modulus and tension, and what else the curves say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from pellicle.arrays import Array
from pellicle.files import json_text

from .config import FitConfig, described
from .contact.curve import Curve
from .estimation.candidate import Candidate
from .estimation.coordinates import MODULUS
from .estimation.intervals import CONFIDENCE, Estimate
from .files.measurement import Measurement, Note
from .selection.advice import Advice
from .selection.recipe import TENSION, Answer
from .selection.verdict import Verdict
from .words.advice import Step, step
from .words.names import words_of
from .words.story import agreement, calibration_of, headline, remarks, told, verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Member(NamedTuple):
    """One curve of a fit."""

    name: str
    """File, and label in it."""
    curve: Curve
    measured: Measurement
    """It as it was read and cleaned, with messages of both."""
    data: dict[str, Any]
    """Origin, and the part that is fitted, as JSON data."""


@dataclass(frozen=True, repr=False)
class Fit:
    """Modulus and tension of one curve, or of several curves of one solid, with 95 % intervals."""

    answer: Answer
    """All explanations that were compared, and the verdict."""
    members: tuple[Member, ...]
    """The curves."""
    needs: tuple[Advice, ...]
    """What to do next, the most urgent first; empty if nothing would help."""
    poissons_ratio: float | None
    """ν, if it was given."""
    config: FitConfig
    """The configuration of the fit."""
    record: Mapping[str, Any]
    """Versions, date and wall time."""

    @property
    def reduced_modulus(self) -> Estimate:
        """E* [Pa], with an interval over all that the curves cannot tell apart."""
        return self.answer.over_tied(MODULUS)

    @property
    def youngs_modulus(self) -> Estimate | None:
        """E = (1 − ν²) E* [Pa], if Poisson's ratio was given."""
        return self._youngs(self.reduced_modulus)

    def _youngs(self, modulus: Estimate) -> Estimate | None:
        if self.poissons_ratio is None:
            return None
        factor = 1 - self.poissons_ratio**2
        low, high = (end and end * factor for end in (modulus.low, modulus.high))
        return replace(modulus, value=modulus.value * factor, low=low, high=high)

    @property
    def if_present(self) -> dict[str, Estimate]:
        """Moduli and quantities of what was asked for, if it were there though there is no sign."""
        found = dict(self.answer.if_present)
        if found and (youngs := self._youngs(found[MODULUS])):
            found["youngs_modulus"] = youngs
        return found

    @property
    def tension(self) -> Estimate:
        """τ₀ [N/m], with an interval over all that the curves cannot tell apart."""
        return self.answer.over_tied(TENSION)

    @property
    def contact_point(self) -> Estimate:
        """Position of first touch [m], of the first curve."""
        return self.answer.selected.parameters["contact_point"]

    def estimates(self) -> dict[str, Estimate]:
        """Return modulus and tension, and the other quantities of the chosen explanation by name.

        Those of further curves have their number behind the name, as ``contact_point_1``.  Where no
        model describes the curves, what nobody asked for is left out.
        """
        found = {"reduced_modulus": self.reduced_modulus, "tension": self.tension}
        if youngs := self.youngs_modulus:
            found["youngs_modulus"] = youngs
        return {**found, **self.answer.if_present, **self.answer.selected.sought, **found}

    @property
    def verdict(self) -> Verdict:
        """Whether what was asked for, a tension by default, is needed."""
        return self.answer.verdict

    @property
    def tension_needed(self) -> bool:
        """Whether tension beats all rivals, and what has it passes the checks of residuals."""
        return self.answer.tension_needed

    @property
    def comparison(self) -> str:
        """The verdict in words."""
        return verdict(self.answer)

    @property
    def steps(self) -> list[Step]:
        """What to do next in words, the most urgent first; empty if nothing would help."""
        return [step(advice) for advice in self.needs]

    @property
    def advice(self) -> str:
        """What to do first, in words; empty if nothing would help."""
        return f"{self.steps[0].do}: {self.steps[0].why}" if self.needs else ""

    @property
    def agreement(self) -> str:
        """Whether several curves agree on what they share, in words; empty for one."""
        return agreement(self.answer, [member.name for member in self.members])

    @property
    def messages(self) -> list[str]:
        """Warnings, and notes of what was done; those of one of several curves with its name."""
        return self._messages(with_checks=True)

    def _messages(self, *, with_checks: bool) -> list[str]:
        several, found = len(self.members) > 1, []
        for member, checked in zip(self.members, self.answer.judgements, strict=True):
            own = [
                *member.measured.messages,
                *(checked.failed_checks.values() if with_checks else ()),
            ]
            found += [type(text)(f"{member.name}: {text}") if several else text for text in own]
        return [*found, *remarks(self.answer)]

    @property
    def warnings(self) -> list[str]:
        """Messages that call for care."""
        return [text for text in self.messages if not isinstance(text, Note)]

    @property
    def warnings_beside_checks(self) -> list[str]:
        """Those but for the checks that residuals fail."""
        found = self._messages(with_checks=False)
        return [text for text in found if not isinstance(text, Note)]

    @property
    def notes(self) -> list[str]:
        """Messages that say what was done."""
        return [text for text in self.messages if isinstance(text, Note)]

    @property
    def chi_squared(self) -> float:
        """Sum of squared residuals over the noise, of the chosen explanation."""
        return self.answer.chi_squared(self.answer.selected)

    def forces(self) -> list[Array]:
        """Return the force [N] of the chosen explanation at the rows of each curve."""
        return self.answer.selected.forces()

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as JSON data."""
        answer, selected = self.answer, self.answer.selected
        own, target = selected.sought, ("reduced_modulus", "tension", "youngs_modulus")
        parameters = {**answer.if_present, **own}
        return {
            **{name: e.to_dict() for name, e in self.estimates().items() if name in target},
            "parameters": {name: estimate.to_dict() for name, estimate in parameters.items()},
            "correlations": [
                {"of": [*pair], "value": value} for pair, value in selected.correlations.items()
            ],
            "if_present": {name: estimate.to_dict() for name, estimate in self.if_present.items()},
            "model": {"effects": sorted(selected.types), "words": words_of(selected)},
            "verdict": self.verdict.value,
            "headline": headline(answer),
            "comparison": self.comparison,
            "tension_needed": self.tension_needed,
            "agreement": self.agreement,
            "next": [one._asdict() for one in self.steps],
            "confidence": CONFIDENCE,
            "calibration": calibration_of(self),
            "chi_squared": self.chi_squared,
            "threshold": answer.threshold,
            "margin": answer.decision.margin,
            "lead": answer.decision.delta_aic,
            "explanations": [self._explanation(fit) for fit in answer.explanations],
            "excused": [
                {"effects": sorted(types), "reason": reason}
                for types, reason in answer.excused.items()
            ],
            "not_weighed": [sorted(types) for types in answer.not_weighed],
            "curves": [self._curve(i, own) for i in range(len(self.members))],
            "messages": self.messages,
            "notes": self.notes,
            "configuration": self.config.to_dict(),
            **self.record,
        }

    def _explanation(self, fit: Candidate) -> dict[str, Any]:
        """Return one of the explanations; quantities whose intervals were not sought lack ends."""
        answer = self.answer
        bare = {name: {"value": e.value, "unit": e.unit} for name, e in fit.parameters.items()}
        return {
            "effects": sorted(fit.types),
            "words": words_of(fit),
            "chi_squared": answer.chi_squared(fit),
            "delta_aic": fit.aic - answer.explanations[0].aic,
            "tied": fit in answer.tied,
            "search": fit.minimum.ending.name.lower(),
            "holds_modulus": fit not in answer.not_held,
            "parameters": bare | {name: e.to_dict() for name, e in fit.sought.items()},
        }

    def _curve(self, i: int, parameters: Mapping[str, Estimate]) -> dict[str, Any]:
        """Return one of the curves, with what the chosen explanation says of it alone."""
        member, checked = self.members[i], self.answer.judgements[i]
        slots = [slot for slot in self.answer.selected.objective.slots if slot.curve == i]
        return {
            "name": member.name,
            "indenter": described(member.curve.indenter),
            "points": member.curve.position.size,
            "noise": {"value": checked.deviation, "unit": "N"},
            "noise_weighed": {"value": checked.noise.deviation, "unit": "N"},
            "failed_checks": [
                {"code": code, "message": text} for code, text in checked.failed_checks.items()
            ],
            "messages": list(member.measured.messages),
            **{
                s.name: parameters[s.full_name].to_dict()
                for s in slots
                if s.full_name in parameters
            },
            "data": member.data,
        }

    def __repr__(self) -> str:
        """Return numbers, verdict and next step; the arrays of a curve would fill a screen."""
        return "\n".join(told(self))

    def _repr_html_(self) -> str:
        """Return HTML for a notebook: a sentence, the estimates, and the curve with its fit."""
        from .report.page import html_of_fit

        return html_of_fit(self)

    def plot(self) -> Figure:
        """Return a figure of pyplot with the data, the fit, and how well it determines it."""
        from .report.figures import plot

        return plot(self)

    def to_json(self) -> str:
        """Return what `to_dict` returns as JSON."""
        return json_text(self.to_dict())
