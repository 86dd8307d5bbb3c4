"""The law of an interaction on a grid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pellicle.checks import errors_attributed_to
from pellicle.contact.law import GapLaw, Law
from pellicle.errors import ConfigError
from pellicle.grid import Grid

from .interaction import Interaction
from .kernel import Kernel

# Relative rounding error of displacements, with some digits left for the gap.
_DIGITS = 1e-13


def law_of(
    interaction: Interaction,
    kernel: Kernel,
    grid: Grid,
    resolved: Callable[[Kernel, Grid], GapLaw] | None = None,
) -> Law:
    """Return the law of an interaction, resolved on a grid.

    ``resolved`` is by default that of the interaction; `Interaction.wider` returns others.

    Raises
    ------
    ConfigError
        The range is less than the rounding error of what the strength displaces.
    PluginError
        The law breaks its contract.
    """
    resolved = resolved or interaction.resolved

    def resolve(grid: Grid) -> GapLaw:
        with errors_attributed_to(interaction):
            return resolved(kernel, grid)

    law = Law(
        resolve(grid),
        resolve,
        interaction,
        needs_contact=interaction.needs_contact,
        averaged=interaction.averaged,
    )
    with errors_attributed_to(kernel):
        compliance = kernel.compliance(np.array([np.pi / grid.cell_size])).item()
    cutoff, strength = law.cutoff(), law.strength()
    if _DIGITS * strength * compliance > cutoff:
        raise ConfigError(
            f"has a strength of {strength:.3g} Pa, which displaces a cell by "
            f"{strength * compliance:.3g} m, and a range of {cutoff:.3g} m, which is less than the "
            "rounding error of that; give a longer range or, for adhesion of no range, jkr",
            "interaction",
        )
    return law
