"""The common part of the fit of one curve and the pooled fit of several."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pellicle.files import json_text, write_json
from pellicle.units import decimal, readable

from .config import FitConfig
from .files.measurement import Note
from .models.force_model import ForceModel
from .models.layer import LayerModel
from .parameters import THICKNESS, Coordinates
from .statistics.noise import FailedCheck
from .statistics.profile import CONFIDENCE, Estimate, ProfileResult
from .wording import interval, scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .comparison import Comparison, RivalFit
    from .record import Record


def thickness_of(model: ForceModel, profile: ProfileResult) -> Estimate | None:
    """Return the thickness of a layer, fitted or given; None for another solid."""
    if isinstance(model, LayerModel):
        h = model.thickness
        return Estimate(h, h, h, THICKNESS.unit, 0.0, held=True)
    return profile.estimate(THICKNESS) if THICKNESS in model.parameters else None


@dataclass(frozen=True, repr=False)
class FitResult:
    """Modulus and tension, and how well they describe the measured force."""

    _subject: ClassVar[str] = "this curve does"
    reduced_modulus: Estimate
    """E* [Pa]."""
    tension: Estimate
    """τ₀ [N/m]."""
    poissons_ratio: float | None
    """ν, if it was given."""
    chi_squared: float
    """Least sum of squared residuals over the noise."""
    chi_squared_without_tension: float
    """The same with the tension fixed at 0."""
    advice: str
    """The Cramér–Rao bound, and the experiment that would tighten it."""
    messages: tuple[str, ...]
    """Warnings, and notes of what was done."""
    parameters: Coordinates
    """Best coordinates: the value of each `Parameter`, for the modulus its natural logarithm."""
    parameters_without_tension: Coordinates
    """The same with the tension fixed at 0 (Hertz, for a paraboloid)."""
    rise: float
    """Δχ² threshold, reached at the ends of the intervals."""
    failed_checks: tuple[FailedCheck, ...]
    """Checks that the residuals fail; their sentences are among the messages."""
    thickness: Estimate | None = field(default=None, kw_only=True)
    """h [m], if the solid is a bonded layer with a force curve."""
    config: FitConfig | None = field(default=None, kw_only=True)
    """The configuration of the fit."""
    rivals: Comparison | None = field(default=None, kw_only=True)
    """Other explanations of the curves, if there is a tension to doubt or they were requested."""
    record: Record | None = field(default=None, kw_only=True)
    """Files with their hashes, versions, date and wall time."""

    @property
    def youngs_modulus(self) -> Estimate | None:
        """E = (1 − ν²) E* [Pa], if Poisson's ratio was given."""
        ratio = self.poissons_ratio
        return None if ratio is None else self.reduced_modulus.times(1 - ratio**2)

    @property
    def chosen(self) -> RivalFit | None:
        """The model whose estimates count, if it is not an elastic solid under tension."""
        return None if self.rivals is None else self.rivals.chosen

    def chosen_estimates(self) -> dict[str, Estimate]:
        """Return the parameters of the chosen model by name."""
        if self.chosen is None:
            return self.estimates()
        estimates, ratio = dict(self.chosen.estimates), self.poissons_ratio
        if ratio is not None:
            estimates["youngs_modulus"] = estimates["reduced_modulus"].times(1 - ratio**2)
        return estimates

    @property
    def tension_needed(self) -> bool:
        """Whether a model with tension beats all its rivals and passes the checks of its residuals.

        Without a comparison with rivals there is nothing that needs a tension.
        """
        return self.rivals is not None and self.rivals.verdict == "needed"

    @property
    def comparison(self) -> str:
        """Whether tension is needed, in words."""
        tension, (gain, lead) = self.tension, self._gains
        figures = f"Δχ² = {decimal(gain, 3)}, ΔAIC = {decimal(lead, 3)}"
        if tension.held and not tension.value:
            return "tension is fixed at 0, so whether it is needed was not tested"
        if tension.held:
            return (
                f"tension is fixed at {readable(tension.value, 'N/m', 4)} ({figures} against none)"
            )
        if self.rivals is not None and self.rivals.verdict != "not shown":
            return "; ".join(filter(None, [self.rivals.sentence, self.rivals.advice]))
        if tension.high is not None:
            bound = f"it is below {readable(tension.high, 'N/m', 3)}"
            return f"{self._subject} not show tension ({figures}); {bound}"
        return f"{self._subject} not show tension ({figures}), nor set a bound on it"

    @property
    def _gains(self) -> tuple[float, float]:
        """Decrease of χ² and of AIC by the tension, which is no parameter where it is held."""
        gain = self.chi_squared_without_tension - self.chi_squared
        return gain, gain if self.tension.held else gain - 2

    @property
    def sentences(self) -> list[str]:
        """The verdicts of the fit in words."""
        pull_off = "" if self.rivals is None else self.rivals.pull_off
        return list(filter(None, [self.comparison, pull_off, self.advice]))

    def range_of_models(self, *, si: bool = False) -> str:
        """Return the modulus over all explanations that the curves cannot tell apart, in words.

        It is Young's where Poisson's ratio is known, followed by the tension if one is needed, and
        empty if one explanation stands alone.
        """
        if self.rivals is None or self.rivals.modulus is None:
            return ""
        name, modulus = "the reduced modulus", self.rivals.modulus
        if self.poissons_ratio is not None:
            name, modulus = "Young's modulus", modulus.times(1 - self.poissons_ratio**2)
        ranges = f"{name} is {_range(modulus, si)}"
        if self.rivals.tension is not None:
            ranges += f" and the tension {_range(self.rivals.tension, si)}"
        count = len(self.rivals.alternatives)
        return f"over {count} models that the data cannot tell apart, {ranges}"

    @property
    def all_messages(self) -> list[str]:
        """Warnings and notes, those of single curves with their names."""
        return list(self.messages)

    @property
    def warnings(self) -> list[str]:
        """Messages that call for care."""
        return [text for text in self.all_messages if not isinstance(text, Note)]

    @property
    def notes(self) -> list[str]:
        """Messages that say what was done."""
        return [text for text in self.all_messages if isinstance(text, Note)]

    def estimates(self) -> dict[str, Estimate]:
        """Return the parameters by name; baseline and Young's modulus only if requested."""
        estimates = {
            name: value
            for name, value in vars(self).items()
            if isinstance(value, Estimate) and not (value.held and name in ("offset", "slope"))
        }
        youngs = self.youngs_modulus
        return estimates if youngs is None else estimates | {"youngs_modulus": youngs}

    def curve_rows(self, *, si: bool = False) -> list[dict[str, str]]:
        """Return a line of a table for each curve of a pool; none for a single curve.

        Units have prefixes unless ``si``.
        """
        return []

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as JSON data."""
        gain, lead = self._gains
        result = {name: value.to_dict() for name, value in self.estimates().items()} | {
            "chosen": self._chosen_block(),
            "confidence": CONFIDENCE,
            "chi_squared": self.chi_squared,
            "without_tension": {"delta_chi_squared": gain, "delta_aic": lead},
            "tension_needed": self.tension_needed,
            "comparison": self.comparison,
            "advice": self.advice,
            "failed_checks": [check._asdict() for check in self.failed_checks],
            "messages": list(self.messages),
            "notes": [text for text in self.messages if isinstance(text, Note)],
        }
        if self.rivals is not None:
            result["rivals"] = self.rivals.to_dict()
        if self.config is not None:
            result["configuration"] = self.config.to_dict()
        if self.record is not None:
            result |= self.record.to_dict()
        return result

    def _chosen_block(self) -> dict[str, Any]:
        """Return the code of the chosen model and its estimates as JSON data."""
        rivals = self.rivals
        if self.chosen is not None:
            model = self.chosen.rival.code
        else:
            model = "none" if self.tension.held and not self.tension.value else "tension"
        return {
            "model": model,
            "settled": not rivals or (rivals.modulus is None and rivals.is_decided),
            "parameters": {k: value.to_dict() for k, value in self.chosen_estimates().items()},
        }

    def __repr__(self) -> str:
        """Return the result in two sentences; the arrays of a curve would fill a screen."""
        from .report.sentences import sentence_of_fit

        return f"<{type(self).__name__}: {sentence_of_fit(self)} {self.comparison}>"

    def _repr_html_(self) -> str:
        """Return HTML for a notebook: a sentence, the estimates, and the curve with its fit."""
        from .report.notebook import html_of_fit

        return html_of_fit(self)

    def plot(self) -> Figure:
        """Return a figure of pyplot with the data, the fit, and how well it determines it."""
        from .report.figures import plot

        return plot(self)

    def to_json(self) -> str:
        """Return what `to_dict` returns as JSON."""
        return json_text(self.to_dict())

    def save(self, path: str | Path) -> Path:
        """Write what `to_dict` returns to a JSON file, and return its path.

        Raises
        ------
        StorageError
            The file cannot be written.
        """
        return write_json(self.to_dict(), Path(path))


def _range(estimate: Estimate, si: bool) -> str:
    """Return an interval with its unit."""
    text = interval(estimate, si=si)
    return scale(estimate, si=si).with_unit(text) if text != "open" else "not determined"
