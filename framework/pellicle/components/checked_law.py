"""The law of an interaction on a grid, with every value checked against the contract."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import (
    component_name,
    errors_attributed_to,
    read_only,
    real_array,
    real_number,
)
from pellicle.contact.law import GapLaw, Law
from pellicle.errors import ConfigError, PluginError
from pellicle.grid import Grid
from pellicle.units import LARGEST

from .interaction import Interaction
from .kernel import Kernel

# Gaps at which a law is checked, and the error of the energy by the trapezoidal rule, over w. A
# law that drops within one of these gaps still passes.
_GAPS = 2001
_ENERGY_ERROR = 1e-2
# Error of a slope over the mean one, and the share of the range in which it may be larger: a law
# may drop or have kinks.
_SLOPE_ERROR = 1e-2
_KINKS = 0.1
# Relative rounding error of tractions.
_ROUNDING = 1e-12
# Relative rounding error of displacements, with some digits left for the gap.
_DIGITS = 1e-13


def law_of(interaction: Interaction, kernel: Kernel, grid: Grid) -> Law:
    """Return the law of an interaction, resolved on a grid, with checked values."""

    def resolve(grid: Grid) -> _CheckedLaw:
        with errors_attributed_to(interaction):
            law = interaction.resolved(kernel, grid)
        return _CheckedLaw(interaction, law)

    law = resolve(grid)
    cutoff = law.cutoff()
    if not 0 < cutoff < LARGEST:
        raise PluginError(
            f"{component_name(interaction)}: cutoff() is {cutoff:g} m; it has to be > 0 and "
            f"< {LARGEST:g} m"
        )
    gaps = np.linspace(0.0, cutoff, _GAPS)
    energy, traction = law.energy(gaps), law.traction(gaps)
    _require_attraction(interaction, gaps, traction)
    _require_derivative(interaction, gaps, energy, traction)
    _require_slope(interaction, gaps, traction, law.slope(gaps))
    with errors_attributed_to(kernel):
        compliance = kernel.compliance(np.array([np.pi / grid.cell_size])).item()
    strength = -float(traction[0])
    if _DIGITS * strength * compliance > cutoff:
        raise ConfigError(
            f"has a strength of {strength:.3g} Pa, which displaces a cell by "
            f"{strength * compliance:.3g} m, and a range of {cutoff:.3g} m, which is less than the "
            "rounding error of that; give a longer range or, for adhesion of no range, jkr",
            "interaction",
        )
    return Law(law, resolve, averaged=bool(getattr(law.law, "averaged", False)))


def _require_attraction(interaction: Interaction, gaps: Array, traction: Array) -> None:
    """Refuse a law that repels, or attracts more across a larger gap.

    Solvers presume that the attraction is strongest at a closed gap and falls from there.
    """
    name, strength = component_name(interaction), -float(traction[0])
    highest = int(np.argmax(traction))
    if traction[highest] > _ROUNDING * abs(strength):
        raise PluginError(
            f"{name}: traction(gap) is {traction[highest]:.3g} Pa at {gaps[highest]:.3g} m, which "
            "repels; it has to be ≤ 0 at every gap"
        )
    change = np.diff(traction)
    steepest = int(np.argmin(change))
    if change[steepest] < -_ROUNDING * strength:
        raise PluginError(
            f"{name}: traction(gap) grows from {traction[steepest]:.6g} Pa at "
            f"{gaps[steepest]:.3g} m to {traction[steepest + 1]:.6g} Pa at "
            f"{gaps[steepest + 1]:.3g} m; the attraction has to be strongest at a closed gap and "
            "must not grow with the gap"
        )


def _require_derivative(
    interaction: Interaction, gaps: Array, energy: Array, traction: Array
) -> None:
    """Refuse a law without a work of adhesion, or with a traction that is not −dγ/dg."""
    name, depth = component_name(interaction), -float(energy[0])
    if not depth > 0:
        raise PluginError(
            f"{name}: energy(0) is {energy[0]:g} J/m²; it has to be negative: minus the work of "
            "adhesion"
        )
    if not abs(energy[-1]) <= _ENERGY_ERROR * depth:
        raise PluginError(
            f"{name}: energy(gap) is {energy[-1]:.3g} J/m² at the cutoff of {gaps[-1]:.3g} m; it "
            "has to be 0 there, as nothing acts beyond: give a larger cutoff"
        )
    work = np.concatenate([[0.0], np.cumsum(0.5 * (traction[1:] + traction[:-1])) * gaps[1]])
    missed = float(np.abs(energy - energy[0] + work).max()) / depth
    if missed > _ENERGY_ERROR:
        raise PluginError(
            f"{name}: traction(gap) is not −dγ/dg of energy(gap): their difference over the range "
            f"is {missed:.1e} of the work of adhesion"
        )


def _require_slope(interaction: Interaction, gaps: Array, traction: Array, slope: Array) -> None:
    """Refuse a law whose slope, which stiffnesses follow from, is not dσ/dg."""
    measured = np.diff(traction) / gaps[1]
    missed = np.abs(0.5 * (slope[1:] + slope[:-1]) - measured)
    share = float(np.mean(missed > _SLOPE_ERROR * -traction[0] / gaps[-1]))
    if share > _KINKS:
        raise PluginError(
            f"{component_name(interaction)}: slope(gap) is not dσ/dg of traction(gap) over "
            f"{share:.0%} of the range; leave it out to have it measured"
        )


@dataclass(frozen=True)
class _CheckedLaw:
    interaction: Interaction
    law: GapLaw

    @property
    def needs_contact(self) -> bool:
        return self.law.needs_contact

    def energy(self, gap: Array) -> Array:
        return self._values("energy", gap)

    def traction(self, gap: Array) -> Array:
        return self._values("traction", gap)

    def slope(self, gap: Array) -> Array:
        return self._values("slope", gap)

    def cutoff(self) -> float:
        with errors_attributed_to(self.interaction):
            value = self.law.cutoff()
        return real_number(self.interaction, "cutoff()", value)

    def _values(self, name: str, gap: Array) -> Array:
        with errors_attributed_to(self.interaction):
            values = getattr(self.law, name)(read_only(gap))
        values = real_array(self.interaction, f"{name}(gap)", values, gap.shape)
        if not np.isfinite(values).all():
            raise PluginError(
                f"{component_name(self.interaction)}: {name}(gap) has values that are NaN or "
                "infinite; it has to be finite for every gap up to the cutoff"
            )
        return values
