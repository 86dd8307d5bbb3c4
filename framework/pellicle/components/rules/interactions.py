"""Rules of interactions, for the law as it is resolved on a grid."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from pellicle.arrays import Array
from pellicle.components.interaction import Interaction, law_of
from pellicle.contact.law import Law

from .rule import Case

# Gaps at which a law is asked, and the error of the energy by the trapezoidal rule, over the
# greatest energy. A law that drops within one of these gaps still passes.
_GAPS: Final = 2001
_ENERGY_ERROR: Final = 1e-2
# Error of a slope over the mean one, and the share of the range in which it may be larger: a law
# may drop or have kinks.
_SLOPE_ERROR: Final = 1e-2
_KINKS: Final = 0.1
# Relative rounding error of values.
_ROUNDING: Final = 1e-12


def values_are_finite_and_of_their_gap_alone(interaction: Interaction, case: Case) -> str:
    """Energy, traction and slope are finite floats for each gap up to the cutoff, on its own.

    The gap is not changed, and a second call returns the same.
    """
    law = _law(interaction, case)
    gaps = np.linspace(0.0, law.cutoff(), 24)
    for name in ("energy", "traction", "slope"):
        function: Callable[[Array], Array] = getattr(law, name)
        at_once = function(gaps)
        room = _ROUNDING * float(np.abs(at_once).max())
        singly = np.concatenate([function(gap) for gap in np.split(gaps, gaps.size)])
        for values in (singly, function(gaps.reshape(2, 3, 4)).ravel()):
            missed = np.abs(values - at_once)
            at = int(missed.argmax())
            if missed[at] > room:
                return (
                    f"{name}(gap) is {at_once[at]:g} at a gap of {gaps[at]:.3g} m, and "
                    f"{values[at]:g} there among other gaps or when asked again"
                )
    return ""


def energy_ends_at_the_cutoff(interaction: Interaction, case: Case) -> str:
    """The energy is 0 at the cutoff, beyond which nothing acts."""
    _, gaps, energy, _ = _on_gaps(interaction, case)
    if abs(energy[-1]) <= _ENERGY_ERROR * float(np.abs(energy).max()):
        return ""
    return (
        f"energy(gap) is {energy[-1]:.3g} J/m² at the cutoff of {gaps[-1]:.3g} m; it has to be 0 "
        "there, as nothing acts beyond: give a larger cutoff"
    )


def traction_is_the_derivative_of_the_energy(interaction: Interaction, case: Case) -> str:
    """The traction is −dγ/dg: its integral from a closed gap is what the energy changes by."""
    _, gaps, energy, traction = _on_gaps(interaction, case)
    # The integral from the closed gap by the trapezoidal rule.
    means = 0.5 * (traction[1:] + traction[:-1])
    work = np.concatenate([[0.0], np.cumsum(means) * gaps[1]])
    missed = float(np.abs(energy - energy[0] + work).max()) / (float(np.abs(energy).max()) or 1.0)
    if missed <= _ENERGY_ERROR:
        return ""
    return (
        "traction(gap) is not −dγ/dg of energy(gap): their difference over the range is "
        f"{missed:.1e} of the greatest energy"
    )


def slope_is_the_derivative_of_the_traction(interaction: Interaction, case: Case) -> str:
    """The slope, which stiffnesses follow from, is dσ/dg but where the traction has kinks."""
    law, gaps, _, traction = _on_gaps(interaction, case)
    slope = law.slope(gaps)
    missed = np.abs(0.5 * (slope[1:] + slope[:-1]) - np.diff(traction) / gaps[1])
    greatest = float(np.abs(traction).max())
    share = float(np.mean(missed > _SLOPE_ERROR * greatest / gaps[-1]))
    if share <= _KINKS:
        return ""
    return (
        f"slope(gap) is not dσ/dg of traction(gap) over {share:.0%} of the range; leave it out to "
        "have it measured"
    )


def resolved_keeps_the_work_of_adhesion(interaction: Interaction, case: Case) -> str:
    """The law that `resolved` returns has the interaction's work of adhesion, on every grid."""
    at_rest = -float(np.ravel(interaction.energy(np.zeros(1)))[0])
    resolved = _law(interaction, case).work_of_adhesion()
    if abs(resolved - at_rest) <= 1e-9 * abs(at_rest):
        return ""
    return (
        f"resolved(kernel, grid) returns a law of −γ(0) = {resolved:g} J/m²; it has to have that "
        f"of the interaction, {at_rest:g} J/m²"
    )


def _law(interaction: Interaction, case: Case) -> Law:
    """Return the law that is resolved in a case, which checks its values."""
    if case.kernel is None:
        return Law(interaction, lambda _: interaction, interaction)
    return law_of(interaction, case.kernel, case.grid)


def _on_gaps(interaction: Interaction, case: Case) -> tuple[Law, Array, Array, Array]:
    """Return a law, gaps up to its cutoff [m], and its energy and traction there."""
    law = _law(interaction, case)
    gaps = np.linspace(0.0, law.cutoff(), _GAPS)
    return law, gaps, law.energy(gaps), law.traction(gaps)
