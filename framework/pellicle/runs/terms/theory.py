"""Whether the theory holds: slopes are small, and no layer is pressed through."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from pellicle.analysis import steepest
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import AdhesiveEquilibrium, Equilibrium

from . import ContactStep, Surroundings

# Slope up to which the theory holds, and beyond which a contact that does not stick is told.
_SMALL: Final = 0.3
_STEEPEST: Final = 1.0
# Relative change of G(q) q² over a decade below which it is the limit of short waves.
_CONSTANT: Final = 0.05


def theory(run: Run, step: ContactStep, surroundings: Surroundings) -> ContactStep:
    """Add whether slopes are beyond the theory, and whether the surface is pressed to its base."""
    return step.having({}, _limits(run, step.equilibrium)) if step.converged else step


def _limits(run: Run, equilibrium: Equilibrium) -> Iterator[Caveat]:
    """Yield what is beyond the theory.

    With a surface tension τ₀, the limit of 1/(G q²) for short waves, the energy per area w that a
    law releases bends the surface at the rim by an angle √(2w/τ₀) (Young–Dupré at small slopes).
    Without one the slope of the theory has no bound, and depends on the range of the interaction.
    """
    contact, sticks = equilibrium.counted_contact, isinstance(equilibrium, AdhesiveEquilibrium)
    if not contact.any():
        return
    thickness, deepest = run.kernel.depth_to_base(), float(equilibrium.displacement[contact].max())
    if deepest > thickness:
        yield Caveat(Status.THROUGH_LAYER, {"deepest": deepest, "thickness": thickness})
    slope = steepest(equilibrium.problem.heights, contact, run.grid)
    if isinstance(equilibrium, AdhesiveEquilibrium):
        q = 1e3 * np.pi / min(run.grid.spacing) * np.array([1.0, 10.0])
        nothing = np.zeros_like(q)
        axes = [run.kernel.symbol(q, nothing), run.kernel.symbol(nothing, q)]
        a, b = np.maximum(*axes) * q**2
        if abs(b / a - 1) < _CONSTANT:
            slope = max(slope, float(np.sqrt(2 * equilibrium.problem.law.work_of_adhesion() * b)))
    # As it is told: an indenter of that very slope is not beyond it by rounding.
    if slope > _SMALL if sticks else round(slope, 1) > _STEEPEST:
        yield Caveat(Status.STEEP, {"slope": slope, "most": _SMALL})
