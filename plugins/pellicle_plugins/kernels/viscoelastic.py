"""Solids whose stiffness relaxes in time."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import ConfigDict, Field, field_validator, model_validator

from pellicle.arrays import Array
from pellicle.components import Branch, FromRegistry, Kernel, KernelOf, OfWave
from pellicle.schema import Model
from pellicle.surface import mean_compliance
from pellicle.units import Quantity, Time

from .power_law import PronySeries, power_law_series
from .skins import Skin
from .tensions import SkinTensions

# Fractions given in decimals may sum to 1 plus rounding.
_ROUNDING: Final = 1e-12
# Default span of a power law, as a factor each way from its time.
_SPAN: Final = 1e3
_LARGEST_ERROR: Final = 0.01


class RelaxingFraction(Model):
    """A fraction of a solid's stiffness that relaxes exponentially."""

    fraction: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        description="fraction of the instantaneous stiffness"
    )
    time: Time = Field(description="relaxation time τ [s]")


class PowerLaw(Model):
    """A stiffness that falls as a power of time."""

    exponent: Annotated[float, Quantity("1", above=0, below=1)] = Field(
        description="exponent α of E ∝ t^(−α)"
    )
    time: Time = Field(description="time t₀ [s] at which the solid is the one given")
    shortest: Time | None = Field(
        None, description="start of the span in which the law holds [s]; time/1000 if not given"
    )
    longest: Time | None = Field(
        None, description="end of the span in which the law holds [s]; 1000 time if not given"
    )

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time [s] at which the law holds."""
        return (
            self.time / _SPAN if self.shortest is None else self.shortest,
            self.time * _SPAN if self.longest is None else self.longest,
        )

    @property
    def series(self) -> PronySeries:
        """The law as a series, in units of its shortest time and the stiffness then."""
        shortest, longest = self.span
        return power_law_series(self.exponent, longest / shortest)

    @model_validator(mode="after")
    def _check_span(self) -> Self:
        shortest, longest = self.span
        if not shortest < longest:
            raise ValueError(
                f"shortest is {shortest:g} s and longest {longest:g} s; the span has to begin "
                "before it ends"
            )
        if self.series.error > _LARGEST_ERROR:
            raise ValueError(
                f"a series of exponentials is off by {self.series.error:.0%} between {shortest:g} "
                f"and {longest:g} s; shorten the span"
            )
        return self


class Viscoelastic(KernelOf):
    """A solid whose stiffness relaxes in time (Ferry 1980).

    The stiffness is E(t) = E (1 − Σ f (1 − e^(−t/τ))) with fractions f, a Prony series; of a power
    law, E (t/t₀)^(−α) within a span of times. Poisson's ratio stays as it is. Skins do not relax;
    put them on top with `coated`.
    """

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["relaxation"]}, {"required": ["power_law"]}]}
    )

    substrate_field: ClassVar[str] = "solid"
    type: Literal["viscoelastic"] = "viscoelastic"
    examples = (
        {
            "solid": {"type": "half_space", "reduced_modulus": "10 kPa"},
            "relaxation": [{"fraction": 0.5, "time": "1 s"}, {"fraction": 0.3, "time": "1 min"}],
        },
    )
    solid: Annotated[Kernel, FromRegistry()] = Field(
        description="the instantaneous response, or for a power law that at its time: a kernel "
        "without a skin, as a table with type"
    )
    relaxation: tuple[RelaxingFraction, ...] | None = Field(
        None,
        min_length=1,
        description="fractions of the stiffness that relax: tables of fraction and time",
    )
    power_law: PowerLaw | None = Field(
        None, description="a power law of time: a table of exponent, time, shortest and longest"
    )

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return G(q) [m/Pa] of the instantaneous response; of a power law, before its span."""
        return self.solid.symbol(qx, qy) / self._instantaneous

    def mean_compliance(self) -> float:
        """Return the instantaneous G(0) [m/Pa]."""
        return mean_compliance(self.solid) / self._instantaneous

    def branches(self) -> tuple[Branch, ...]:
        """Return shares of the instantaneous stiffness with their relaxation times."""
        if self.power_law is None:
            return tuple(Branch(branch.fraction, branch.time) for branch in self.relaxation or ())
        series, (shortest, _) = self.power_law.series, self.power_law.span
        return tuple(
            Branch(weight / series.total, time * shortest)
            for weight, time in zip(series.weights, series.times, strict=True)
        )

    def scaled(self, share: float | OfWave) -> Kernel:
        """Return the elastic kernel of ``share`` times the instantaneous stiffness."""
        return self.solid.scaled(self._instantaneous).scaled(share)

    def time_span(self) -> tuple[float, float]:
        """Return the span of the power law; all times if there is none."""
        return (0.0, math.inf) if self.power_law is None else self.power_law.span

    def without_skin(self) -> Kernel:
        """Return this kernel: there is no skin on it."""
        return self

    @property
    def _instantaneous(self) -> float:
        """The instantaneous stiffness over that of `solid`."""
        if self.power_law is None:
            return 1.0
        law = self.power_law
        return law.series.total * math.pow(law.span[0] / law.time, -law.exponent)

    @field_validator("solid")
    @classmethod
    def _check_solid(cls, solid: Kernel) -> Kernel:
        if isinstance(solid, (Skin, SkinTensions)):
            raise ValueError(
                f"{solid.type_name} has a skin, which would relax with the solid; give the solid "
                'without it, and put the skin on top: type = "coated", with this kernel as its '
                "substrate"
            )
        if solid.branches():
            raise ValueError(
                f"{solid.type_name} relaxes already; give an elastic solid, and all fractions in "
                "one relaxation"
            )
        return solid

    @field_validator("relaxation")
    @classmethod
    def _check_sum(
        cls, relaxation: tuple[RelaxingFraction, ...] | None
    ) -> tuple[RelaxingFraction, ...] | None:
        total = math.fsum(branch.fraction for branch in relaxation or ())
        if total > 1 + _ROUNDING:
            raise ValueError(
                f"the fractions sum to {total:.6g}; they have to sum to less than 1, or to 1 for a "
                "liquid"
            )
        return relaxation

    @model_validator(mode="after")
    def _check_law(self) -> Self:
        if (self.relaxation is None) == (self.power_law is None):
            laws = "neither" if self.relaxation is None else "both"
            raise ValueError(f"{laws} of relaxation and power_law; give one of them")
        return self
