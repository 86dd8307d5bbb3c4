"""Whether the surface is pressed through a layer to its rigid base."""

from __future__ import annotations

import numpy as np

from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import Equilibrium

from . import Step, Surroundings


def layer(run: Run, step: Step, around: Surroundings) -> Step:
    """Add whether a layer is pressed through in contact, or anywhere under a load."""
    surface, thickness = step.equilibrium, run.kernel.depth_to_base()
    pressed = surface.counted_contact if isinstance(surface, Equilibrium) else np.True_
    deepest = float(surface.displacement.max(where=pressed, initial=0.0))
    if not step.converged or not deepest > thickness:
        return step
    return step.with_measures(
        {}, [Caveat(Status.THROUGH_LAYER, {"deepest": deepest, "thickness": thickness})]
    )
