"""Contract rules of interactions: energy, traction and slope agree, and a sphere is pulled."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Interaction
from pellicle.components.installed import kernel
from pellicle.components.rules import Case
from pellicle.grid import Grid

from .component import check, require, require_close, rules_of
from .small_runs import solve_small_run

_RADIUS = 1e-3
"""Radius R of the sphere [m], that of the paraboloid of `solve_small_run`."""


def check_interaction(interaction: Interaction) -> None:
    """Check that an interaction keeps its contract: the rules of its family and of all components.

    For a run under a pulling force ``active_set`` asks that the attraction is strongest at a closed
    gap and falls from there.
    """
    check(interaction, Interaction, rules_of(__name__), cases=_cases(interaction))


def run_under_a_pull_converges(interaction: Interaction) -> None:
    """A sphere that is pressed, and then pulled by 0.5πwR, stays in contact; the run converges."""
    modulus, size = _sizes(interaction)
    unit = np.pi * _at_rest(interaction.energy) * _RADIUS
    data = solve_small_run(
        grid={"points": 64, "size": size, "boundary": "free"},
        kernel=kernel("half_space", reduced_modulus=modulus),
        interaction=interaction,
        loading={"force": [0.1 * unit, -0.5 * unit]},
        solver={"type": "active_set", "tolerance": 1e-6},
    )
    require_close(data["force"], [0.1 * unit, -0.5 * unit], "the force [N]", relative=1e-4)
    areas = data["contact_area"].values
    require(bool(areas[0] > areas[1] > 0), f"the contact areas are {areas} m²")


def _cases(interaction: Interaction) -> Iterator[Case]:
    """Yield the interaction without a grid, if it has a range, and two grids to resolve it on."""
    if interaction.cutoff() != 0:
        yield Case(Grid(points=16, size=1.0, boundary="free"))
    modulus, size = _sizes(interaction)
    solid = kernel("half_space", reduced_modulus=modulus)
    for points in (16, 256):
        yield Case(Grid(points=points, size=size, boundary="free"), solid)


def _sizes(interaction: Interaction) -> tuple[float, float]:
    """Return a reduced modulus [Pa] and a domain's size [m] for a sphere of radius `_RADIUS`.

    With a range they make the Tabor parameter 1, and the domain holds the gaps up to the cutoff.
    """
    # Any length does for a law that does not attract, which is refused afterwards.
    work = abs(_at_rest(interaction.energy)) or 1.0
    strength, cutoff = abs(_at_rest(interaction.traction)) or 1.0, interaction.cutoff()
    if cutoff == 0:
        radius = 0.1 * _RADIUS
        return 4.5 * np.pi * work * _RADIUS**2 / radius**3, 6 * radius
    modulus = work * _RADIUS**0.5 / (work / strength) ** 1.5
    # Contact radius without load (Johnson, Kendall & Roberts 1971).
    radius = (4.5 * np.pi * work * _RADIUS**2 / modulus) ** (1 / 3)
    return modulus, 2 * (radius + 1.5 * float(np.sqrt(2 * _RADIUS * cutoff)))


def _at_rest(function: Callable[[Array], Array]) -> float:
    return -float(np.ravel(function(np.zeros(1)))[0])
