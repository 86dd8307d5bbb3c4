"""A solution of a contact problem, measured: displacement, gap, energy, residuals, stiffness."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, overload

import numpy as np

from pellicle.arrays import Array, Mask

from .attraction import Attraction
from .problem import Adhesive, Force, Posed, Unilateral
from .smooth_ends import with_ends
from .solution import Solution, State

# Traction over the strength of a law up to which a cell does not count as part of the zone.
_ZONE = 1e-2
# Rounding error of a force over the sum of wall pressure and attraction.
_ROUNDING = 1e-14


@dataclass(frozen=True)
class Deformation:
    """A traction on the surface with its displacement, by one application of the operator."""

    problem: Posed
    pressure: Array
    """Traction on the surface [Pa]; of hard contact the contact pressure."""

    @cached_property
    def total(self) -> float:
        """Sum of the pressures [Pa]."""
        return float(self.pressure.sum())

    @property
    def force(self) -> float:
        """Force [N]."""
        return self.total * self.problem.grid.cell_area

    @cached_property
    def displacement(self) -> Array:
        """Displacement u of the surface [m]."""
        left = self.problem.left
        return self._by_pressure if left is None else self._by_pressure + left

    @cached_property
    def _by_pressure(self) -> Array:
        """The displacement that the pressure causes [m], without that left behind."""
        return self.problem.operator.with_spring(0.0)(self.pressure)

    @property
    def elastic_energy(self) -> float:
        """Elastic energy ½ Σ p u Δ² [J]; the spring of a holder is not counted.

        NaN where earlier steps have left a displacement behind: the energy that is stored in a
        solid that relaxes does not follow from its surface.
        """
        return self._elastic * self.problem.grid.cell_area

    @property
    def _elastic(self) -> float:
        if self.problem.left is not None:
            return np.nan
        return 0.5 * float((self.pressure * self.displacement).sum())


@dataclass(frozen=True)
class Equilibrium(Deformation):
    """A pressure with its displacement, gap and residuals.

    The first access to any of these applies the operator once.
    """

    problem: Unilateral

    @property
    def wall(self) -> Array:
        """Wall pressure [Pa]; of hard contact the contact pressure."""
        return self.pressure

    @cached_property
    def contact(self) -> Mask:
        """The cells with wall pressure > 0, bool of the grid's shape."""
        return self.wall > 0

    @cached_property
    def counted_contact(self) -> Mask:
        """The contact as it is counted: `contact`, and of hard contact all of its smooth ends."""
        boundary = self.problem.grid.boundary
        return with_ends(self.contact, self.problem.heights, self.gap, self.displacement, boundary)

    @property
    def state(self) -> State:
        """The state from which the next step starts."""
        return State(self.pressure, self.wall, self.depth)

    @property
    def residual(self) -> float:
        """The largest of the residuals."""
        return max(
            self.residual_contact,
            self.residual_penetration,
            self.residual_complementarity,
            self.residual_load,
            self.residual_traction,
        )

    @property
    def depth(self) -> float:
        """Depth δ of the indenter [m]."""
        return self._base - self.problem.operator.deflection(self.total)

    @cached_property
    def gap(self) -> Array:
        """Gap u − δ − f [m]; +inf where there is no indenter."""
        return self._by_pressure - self.problem.profile - self.depth

    @property
    def zone(self) -> Mask:
        """The cells off the contact on which a traction acts: none."""
        return np.zeros_like(self.contact)

    @property
    def residual_contact(self) -> float:
        """Largest gap in contact by magnitude, over the height range of the indenter there."""
        return float(self._inside.max(initial=0.0)) / self._scale

    @property
    def residual_penetration(self) -> float:
        """max(0, −min gap) outside the contact, over the same."""
        return max(0.0, -float(self.gap.min(initial=0.0, where=~self.contact))) / self._scale

    @property
    def residual_complementarity(self) -> float:
        """Σ w|gap| / Σ|p|, over the same; where a law acts over the greater of Σ|p| and Σ|σ|."""
        work = float((self.wall[self.contact] * self._inside).sum())
        return work / self._acting / self._scale if work else 0.0

    @property
    def residual_load(self) -> float:
        """|force − prescribed| over the prescribed force; 0 at a depth."""
        return self._missed / self.problem.control.value if self._missed else 0.0

    @property
    def residual_traction(self) -> float:
        """Σ|p − w − σ(gap)| over the greater of Σ|p| and Σ|σ|; 0 of hard contact."""
        return 0.0

    @property
    def _missed(self) -> float:
        """|force − prescribed| [N]; 0 at a depth."""
        control = self.problem.control
        return abs(self.force - control.value) if isinstance(control, Force) else 0.0

    @property
    def _acting(self) -> float:
        """What residuals are compared to: the sum of all pressures [Pa]."""
        return self.total

    @cached_property
    def _base(self) -> float:
        contact = self.contact
        if not contact.any():
            return self._base_without_contact
        return self.problem.depth(self._by_pressure[contact] - self.problem.profile[contact])

    @property
    def _base_without_contact(self) -> float:
        # Without pressure the lowest point just touches, even if it lies between the cells.
        return self.problem.depth(np.full(1, self.problem.first_touch))

    @cached_property
    def _scale(self) -> float:
        return self.problem.height_scale(self.contact, self._base, self.total)

    @property
    def _inside(self) -> Array:
        return np.abs(self.gap[self.contact])


@dataclass(frozen=True)
class AdhesiveEquilibrium(Equilibrium):
    """An equilibrium in which a law acts across the gap."""

    problem: Adhesive
    solver_state: State
    """The state that the solver found."""

    @property
    def wall(self) -> Array:
        """Wall pressure [Pa]."""
        return self.solver_state.wall

    @cached_property
    def counted_contact(self) -> Mask:
        """The contact as it is counted."""
        return self.contact

    @cached_property
    def attraction(self) -> Attraction:
        """The traction of the law across the gap."""
        return self.problem.attraction(self.gap, self.contact)

    @cached_property
    def zone(self) -> Mask:
        """The cells off the contact where the traction exceeds 1 % of the strength of the law."""
        strength = self.problem.law.strength()
        zone: Mask = (np.abs(self.pressure) > _ZONE * strength) & ~self.contact
        return zone

    @cached_property
    def zone_width(self) -> float:
        """Mean width of the zone around the contact, where it has an outer edge [m].

        It is the mean distance from the contact of the outermost cells of the zone; NaN if there
        are none, as between asperities so close that the zone fills the gap between them, and 0 if
        no cell beside the contact is in a zone.
        """
        from scipy.ndimage import binary_erosion, distance_transform_edt

        contact, spacing = self.contact, self.problem.grid.spacing
        beside = np.isfinite(self.problem.profile) & ~contact
        if contact.any() and beside.any() and not self.zone.any():
            return 0.0
        reached = contact | self.zone
        outermost = reached & ~binary_erosion(reached, border_value=1) & ~contact
        if not contact.any() or not outermost.any():
            return np.nan
        return float(distance_transform_edt(~contact, sampling=spacing)[outermost].mean())

    @property
    def energy(self) -> float:
        """Elastic energy and energy of the law [J]; NaN where the elastic one is not known."""
        return (self._elastic + self.attraction.energy) * self.problem.grid.cell_area

    @property
    def residual_load(self) -> float:
        """|force − prescribed| over Σ|p|; 0 at a depth.

        Where wall pressure and attraction cancel, Σ|p| is mere rounding, and so is what is missed.
        """
        area = self.problem.grid.cell_area
        attracting = np.abs(self.pressure - self.wall).sum()
        parts = float(np.abs(self.wall).sum() + attracting) * area
        if self._missed <= _ROUNDING * parts:
            return 0.0
        return self._missed / (self._magnitude * area or abs(self.problem.control.value))

    @property
    def residual_traction(self) -> float:
        """Σ|p − w − σ(gap)| over the greater of Σ|p| and Σ|σ|."""
        missed = float(np.abs(self.pressure - self.wall - self.attraction.traction).sum())
        return missed / self._acting if missed else 0.0

    @cached_property
    def _magnitude(self) -> float:
        return float(np.abs(self.pressure).sum())

    @cached_property
    def _acting(self) -> float:
        """Σ|p|, or Σ|σ| if that is greater: a law attracts even where the wall bears it all."""
        return max(self._magnitude, float(np.abs(self.attraction.traction).sum()))

    @property
    def _base_without_contact(self) -> float:
        return (
            self.solver_state.depth
            if self.problem.prescribed == "force"
            else super()._base_without_contact
        )

    @cached_property
    def _scale(self) -> float:
        return self.problem.length_scale(self.contact, self._by_pressure)


@overload
def equilibrium_of(problem: Adhesive, solution: Solution) -> AdhesiveEquilibrium: ...


@overload
def equilibrium_of(problem: Unilateral, solution: Solution) -> Equilibrium: ...


def equilibrium_of(problem: Unilateral, solution: Solution) -> Equilibrium:
    """Return the equilibrium of a solver's solution; its gap is computed on first access."""
    if isinstance(problem, Adhesive):
        return AdhesiveEquilibrium(problem, solution.pressure, solution.state)
    return Equilibrium(problem, solution.pressure)


def measure(problem: Unilateral, pressure: Array) -> Equilibrium:
    """Return the equilibrium of ``pressure`` [Pa], by one application of the operator."""
    equilibrium = Equilibrium(problem, pressure)
    _ = equilibrium.gap
    return equilibrium


def round_off(problem: Unilateral, pressure: Array) -> float:
    """Return the rounding error of a displacement over the height scale, by two applications.

    It is the difference of the displacement from three times that under a third of the pressure,
    which would be 0 without rounding.
    """
    contact = pressure > 0
    displacement = problem.operator(pressure)
    rounded = float(np.abs(3 * problem.operator(pressure / 3) - displacement).max())
    _, depth = problem.gap(displacement, contact)
    return rounded / problem.height_scale(contact, depth, float(pressure.sum()))


class Stiffness(NamedTuple):
    """The stiffness of a contact and its residual."""

    value: float
    """dF/dδ [N/m] with the contact fixed."""
    residual: float
    """Rms error of the displacement in contact, over the prescribed displacement."""


def measure_stiffness(
    problem: Unilateral, contact: Mask, pressure: Array, attraction: Attraction | None = None
) -> Stiffness:
    """Return the contact stiffness from the pressure per depth [Pa/m] of a flat punch.

    The footprint of the punch is ``contact``: cells that join as the depth grows carry no pressure
    at first, so dF/dδ is that of a flat punch (Pharr, Oliver & Brotzen 1992 for axisymmetric
    indenters); it has a cell at least. The operator is applied once. The value is 2 Σq − Σq·Aq
    times the area of a cell, stationary at the solution, so its error is quadratic in that of q.

    With an ``attraction`` the traction off the contact follows the gap, q = dσ/dg (A q − 1), and
    counts towards the force.
    """
    opened = problem.operator.with_spring(0.0)(pressure) - 1.0
    missed = -opened[contact]
    total = float(pressure.sum()) + float((pressure[contact] * missed).sum())
    if attraction and attraction.zone.any():
        zone = attraction.zone
        traction = (attraction.change(opened) - pressure)[zone]
        total -= float((opened[zone] * traction).sum())
        missed = np.concatenate([missed, traction / attraction.greatest_slope])
    return Stiffness(
        value=total * problem.grid.cell_area, residual=float(np.sqrt((missed**2).mean()))
    )
