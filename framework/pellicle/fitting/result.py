"""What a fit of one curve and one of several both answer, and how it is written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from .models.force_model import Coordinates
from .statistics.noise import FailedCheck
from .statistics.profile import CONFIDENCE, Estimate
from .written import as_json, write_json


def doubt(failed: Sequence[FailedCheck]) -> str:
    """Return why checks that fail leave no evidence of a tension; empty if they leave it."""
    codes = list(dict.fromkeys(check.code for check in failed if check.of_model))
    if not codes:
        return ""
    if "adhesion" in codes:
        return "no tension is needed where the force dips before contact: that is adhesion"
    what = "a check" if len(codes) == 1 else "checks"
    return f"this shows none, because the model fails {what} ({', '.join(codes)})"


@dataclass(frozen=True)
class Answer:
    """Modulus and tension, and how well they explain what was measured."""

    _does: ClassVar[str] = "this curve does"
    _look_alikes: ClassVar[str] = (
        "one curve of a solid that relaxes, softens with depth or adheres can look the same: a "
        "second speed or a dwell, a second radius, and the retract would tell"
    )
    """What a tension can be mistaken for, and which measurement tells."""

    reduced_modulus: Estimate
    """E* [Pa]."""
    tension: Estimate
    """τ₀ [N/m]."""
    poissons_ratio: float | None
    """ν, if it was given."""
    chi_squared: float
    """Least sum of squared residuals over the noise."""
    chi_squared_without_tension: float
    """The same with tension held at 0."""
    advice: str
    """The bound that was reached, and what would tighten it."""
    messages: tuple[str, ...]
    """What to be careful of."""
    parameters: Coordinates
    """Best coordinates: a value for each `Parameter`, of the modulus its natural logarithm."""
    parameters_without_tension: Coordinates
    """The same with tension held at 0 (Hertz, for a paraboloid)."""
    rise: float
    """Rise of χ² at the ends of the intervals."""
    failed_checks: tuple[FailedCheck, ...]
    """What the residuals show besides noise; the messages say it too."""
    doubt: str
    """Why a tension that fits better than none is not shown by this; empty if nothing speaks
    against it."""

    @property
    def youngs_modulus(self) -> Estimate | None:
        """E = (1 − ν²) E* [Pa], if Poisson's ratio was given."""
        ratio = self.poissons_ratio
        return None if ratio is None else self.reduced_modulus.times(1 - ratio**2)

    @property
    def tension_needed(self) -> bool:
        """Whether no value of the tension down to 0 does as well, and no check speaks against."""
        tension = self.tension
        return not tension.held and tension.low is not None and not self.doubt

    @property
    def comparison(self) -> str:
        """Whether tension is needed, in words."""
        tension, gain = self.tension, self._gain
        figures = f"Δχ² = {gain:.3g}, ΔAIC = {gain - 2:.3g}"
        if tension.held and not tension.value:
            return "tension is held at 0, so whether it is needed was not asked"
        if tension.held:
            return f"tension is held at {tension.value:.4g} N/m ({figures} against none)"
        if tension.low is not None and self.doubt:
            return f"tension fits better than none ({figures}), but {self.doubt}"
        if tension.low is not None:
            return f"tension is needed ({figures} against none); {self._look_alikes}"
        if tension.high is not None:
            bound = f"it is below {tension.high:.3g} N/m"
            return f"{self._does} not show tension ({figures}); {bound}"
        return f"{self._does} not show tension ({figures}), nor set a bound on it"

    @property
    def _gain(self) -> float:
        """By how much tension lowers χ²."""
        return self.chi_squared_without_tension - self.chi_squared

    def estimates(self) -> dict[str, Estimate]:
        """Return the parameters by name; a baseline and Young's modulus only if asked for."""
        found = {
            name: value
            for name, value in vars(self).items()
            if isinstance(value, Estimate) and not (value.held and name in ("offset", "slope"))
        }
        youngs = self.youngs_modulus
        return found if youngs is None else found | {"youngs_modulus": youngs}

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return {name: value.to_dict() for name, value in self.estimates().items()} | {
            "confidence": CONFIDENCE,
            "chi_squared": self.chi_squared,
            "without_tension": {"delta_chi_squared": self._gain, "delta_aic": self._gain - 2},
            "tension_needed": self.tension_needed,
            "comparison": self.comparison,
            "advice": self.advice,
            "failed_checks": [check.to_dict() for check in self.failed_checks],
            "messages": list(self.messages),
        }

    def to_json(self) -> str:
        """Return what `to_dict` returns as JSON."""
        return as_json(self.to_dict())

    def save(self, path: str | Path) -> Path:
        """Write what `to_dict` returns to a JSON file, and return its name.

        Raises
        ------
        StorageError
            The file cannot be written.
        """
        return write_json(self.to_dict(), Path(path))
