"""Contract rules of interactions: energy, traction and slope agree, and a sphere is pulled."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from pellicle.arrays import Array
from pellicle.components import Interaction, Kernel
from pellicle.components.checked_law import law_of
from pellicle.contact.law import GapLaw
from pellicle.grid import Grid
from pellicle.plugins import registry

from .component import check
from .rules import require, require_close, require_pure, require_vectorised, rules_of
from .small_runs import solved

_ROUNDING = 1e-12
# Energy left at the cutoff, over the work of adhesion.
_LEFT = 1e-3
_RINGS = 20001
_RADIUS = 1e-3
"""Radius R of the sphere [m], that of the paraboloid of `solved`."""


def check_interaction(interaction: Interaction) -> None:
    """Check that an interaction keeps its contract.

    Besides the rules of all components: energy, traction and slope are vectorised, pure and finite
    up to the cutoff; the energy is negative at a closed gap and rises to 0; the attraction is
    strongest there and falls; the traction is the derivative of the energy, and the slope that of
    the traction; what `resolved` returns does the same with the same work of adhesion w on every
    grid; a rigid sphere is pulled by 2πwR; and a small run under a pulling force converges.
    """
    check(interaction, "interaction", rules_of(__name__))


def _work(law: GapLaw) -> float:
    """Return the work of adhesion −γ(0) [J/m²]."""
    return -float(np.ravel(law.energy(np.zeros(1)))[0])


def _traction(law: GapLaw) -> float:
    """Return σ(0) [Pa]."""
    return float(np.ravel(law.traction(np.zeros(1)))[0])


def _kernel(modulus: float) -> Kernel:
    return registry().make(Kernel, {"type": "half_space", "reduced_modulus": modulus})


def _sizes(interaction: Interaction) -> tuple[float, float]:
    """Return a reduced modulus [Pa] and a domain's size [m] for a sphere of radius `_RADIUS`.

    With a range they make the Tabor parameter 1, and the domain holds the gaps up to the cutoff.
    """
    work, cutoff = _work(interaction), interaction.cutoff()
    if cutoff == 0:
        radius = 0.1 * _RADIUS
        return 4.5 * np.pi * work * _RADIUS**2 / radius**3, 6 * radius
    modulus = work * _RADIUS**0.5 / (work / -_traction(interaction)) ** 1.5
    # Contact radius without load (Johnson, Kendall & Roberts 1971).
    radius = (4.5 * np.pi * work * _RADIUS**2 / modulus) ** (1 / 3)
    return modulus, 2 * (radius + 1.5 * float(np.sqrt(2 * _RADIUS * cutoff)))


def _laws(interaction: Interaction) -> Iterator[tuple[str, GapLaw]]:
    """Yield the interaction, if it has a range, and what it resolves to on two grids."""
    if interaction.cutoff() > 0:
        yield "the interaction", interaction
    modulus, size = _sizes(interaction)
    for points in (16, 256):
        grid = Grid(points=points, size=size, boundary="free")
        law = interaction.resolved(_kernel(modulus), grid)
        yield f"what is resolved on {points} cells of {size:.3g} m", law


def _gaps(law: GapLaw, number: int = 2001) -> Array:
    return np.linspace(0.0, law.cutoff(), number)


def _functions(interaction: Interaction) -> Iterator[tuple[str, GapLaw, Callable[[Array], Array]]]:
    for name, law in _laws(interaction):
        yield f"energy(gap) of {name}", law, law.energy
        yield f"traction(gap) of {name}", law, law.traction
        yield f"slope(gap) of {name}", law, law.slope


def cutoff_is_a_length(interaction: Interaction) -> None:
    """cutoff() is a finite number ≥ 0."""
    value = interaction.cutoff()
    require(bool(np.isfinite(value) and value >= 0), f"cutoff() is {value!r} m")


def closed_gap_attracts(interaction: Interaction) -> None:
    """At a closed gap the energy is negative and so is, where there is a range, the traction.

    What `resolved` returns has a range.
    """
    require(_work(interaction) > 0, f"energy(0) is {-_work(interaction):g} J/m²")
    for name, law in _laws(interaction):
        require(bool(0 < law.cutoff() < np.inf), f"cutoff() of {name} is {law.cutoff()!r} m")
        require(_traction(law) < 0, f"traction(0) of {name} is {_traction(law):g} Pa")


def values_are_finite(interaction: Interaction) -> None:
    """Energy, traction and slope are finite from a closed gap to the cutoff."""
    for name, law, function in _functions(interaction):
        gaps = _gaps(law)
        values = function(gaps)
        for bad in np.flatnonzero(~np.isfinite(values)):
            raise AssertionError(f"{name} is {values[bad]} at {gaps[bad]:g} m")


def values_are_vectorised(interaction: Interaction) -> None:
    """Each function of the gap is a float array of its shape; a value depends on its gap only."""
    for name, law, function in _functions(interaction):
        require_vectorised(function, _gaps(law, 24), name, of_largest=_ROUNDING)


def functions_leave_their_argument(interaction: Interaction) -> None:
    """An interaction is pure: it does not change the gap, and a second call returns the same."""
    for name, law, function in _functions(interaction):
        require_pure(function, _gaps(law), name)


def energy_rises_to_nothing(interaction: Interaction) -> None:
    """The energy does not fall as the gap grows, and is 0 at the cutoff."""
    for name, law in _laws(interaction):
        energy, work = law.energy(_gaps(law)), _work(law)
        fall = float(np.diff(energy).min())
        require(fall >= -_ROUNDING * work, f"energy of {name} falls by {-fall:g} J/m²")
        require(
            abs(energy[-1]) <= _LEFT * work,
            f"energy of {name} is {energy[-1]:g} J/m² at the cutoff, and {-work:g} J/m² at 0",
        )


def attraction_falls_with_the_gap(interaction: Interaction) -> None:
    """The attraction is nowhere stronger than at smaller gaps, and nothing repels."""
    for name, law in _laws(interaction):
        traction = law.traction(_gaps(law))
        strength = -float(traction[0])
        fall = float(np.diff(traction).min())
        require(fall >= -_ROUNDING * strength, f"traction of {name} falls by {-fall:g} Pa")
        most = float(traction.max())
        require(most <= 0, f"traction of {name} is {most:g} Pa, which repels")


def rigid_sphere_is_pulled_by_2_pi_w_r(interaction: Interaction) -> None:
    """The traction on a rigid paraboloid that touches a rigid plane adds up to 2πwR (Bradley 1932).

    It is added over rings of equal width.
    """
    for name, law in _laws(interaction):
        radii = np.linspace(0.0, float(np.sqrt(2 * _RADIUS * law.cutoff())), _RINGS)
        density = -2 * np.pi * radii * law.traction(radii**2 / (2 * _RADIUS))
        pull = float((0.5 * (density[1:] + density[:-1])).sum() * radii[1])
        require_close(
            pull, 2 * np.pi * _work(law) * _RADIUS, f"the pull [N] of {name}", relative=2 * _LEFT
        )


def traction_is_the_derivative_of_the_energy(interaction: Interaction) -> None:
    """Between two gaps, −Δγ/Δg lies between the tractions at both (mean value theorem)."""
    for name, law in _laws(interaction):
        gaps = _gaps(law)
        energy, traction = law.energy(gaps), law.traction(gaps)
        mean = -np.diff(energy) / gaps[1]
        low, high = np.minimum(traction[1:], traction[:-1]), np.maximum(traction[1:], traction[:-1])
        room = _ROUNDING * (_work(law) / gaps[1] + np.abs(traction).max())
        for bad in np.flatnonzero((mean < low - room) | (mean > high + room)):
            raise AssertionError(
                f"−dγ/dg of {name} is {mean[bad]:g} Pa between gaps of {gaps[bad]:g} and "
                f"{gaps[bad + 1]:g} m, where traction is {traction[bad]:g} and "
                f"{traction[bad + 1]:g} Pa"
            )


def slope_is_the_derivative_of_the_traction(interaction: Interaction) -> None:
    """The integral of the slope of what `resolved` returns is the change of its traction.

    The tolerance is the error of the trapezoidal rule: the change of the slope in all, times the
    distance of two gaps.
    """
    for name, law in _laws(interaction):
        if law is interaction and "resolved" in vars(type(law)):
            continue
        gaps = _gaps(law)
        slope, traction = law.slope(gaps), law.traction(gaps)
        steps = 0.5 * (slope[1:] + slope[:-1]) * gaps[1]
        allowed = float(np.abs(np.diff(slope)).sum()) * gaps[1]
        require_close(
            traction[0] + np.concatenate([[0.0], np.cumsum(steps)]),
            traction,
            f"the integral of the slope [Pa] of {name}",
            absolute=allowed + 1e-6 * abs(float(traction[0])),
        )


def resolved_keeps_the_work_of_adhesion(interaction: Interaction) -> None:
    """What `resolved` returns has the work of adhesion of the interaction on every grid."""
    modulus, size = _sizes(interaction)
    for name, law in _laws(interaction):
        require_close(_work(law), _work(interaction), f"−γ(0) [J/m²] of {name}", relative=1e-9)
    law_of(interaction, _kernel(modulus), Grid(points=16, size=size, boundary="free"))


def run_under_a_pull_converges(interaction: Interaction) -> None:
    """A sphere that is pressed, and then pulled by 0.5πwR, stays in contact; the run converges."""
    modulus, size = _sizes(interaction)
    unit = np.pi * _work(interaction) * _RADIUS
    data = solved(
        grid={"points": 64, "size": size, "boundary": "free"},
        kernel=_kernel(modulus),
        interaction=interaction,
        loading={"force": [0.1 * unit, -0.5 * unit]},
        solver={"type": "active_set", "tolerance": 1e-6},
    )
    require_close(data["force"], [0.1 * unit, -0.5 * unit], "the force [N]", relative=1e-4)
    areas = data["contact_area"].values
    require(bool(areas[0] > areas[1] > 0), f"the contact areas are {areas} m²")
