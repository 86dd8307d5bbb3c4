"""The contact problem of one load step, and the residuals of a solution."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite
from typing import Final, Literal, NamedTuple

import numpy as np

from pellicle.arrays import Array, Cells, Mask
from pellicle.grid import Grid

from .attraction import Attraction, attraction
from .gap_law import Law
from .grid_transfer import restrict
from .operators import Operator
from .solution import Solution, State

# Height range in contact over the depth below which an indenter counts as flat there.
_FLAT = 1e-3
# Relative rounding error of displacements; smaller heights are not resolved.
_ROUNDING = 1e-13
# Traction over the strength of a law up to which a cell does not count as part of the zone.
_ZONE = 1e-2


@dataclass(frozen=True)
class Depth:
    """Depth control: δ = value − compliance · F."""

    value: float
    """Depth [m] of the indenter, or of the base if a spring holds the indenter."""
    compliance: float = 0.0
    """Compliance of the spring between base and indenter [m/N]; 0 without a spring."""

    def scaled(self, height: float, pressure: float) -> Depth:
        """Return the control in units of ``height`` [m] and ``pressure`` [Pa]."""
        return Depth(self.value / height, self.compliance * pressure / height)


@dataclass(frozen=True)
class Force:
    """Force control."""

    value: float
    """Force on the domain [N]."""

    def scaled(self, height: float, pressure: float) -> Force:
        """Return the control in units of ``pressure`` [Pa]."""
        return Force(self.value / pressure)


_CONTROLS: Final = {"depth": Depth, "force": Force}


@dataclass(frozen=True, init=False)
class Problem:
    """Find p ≥ 0 with gap = A p − z − f ≥ 0 and p·gap = 0, for a given depth z or force.

    With a `law` the traction is p = w + σ(gap), and the conditions on p hold for the wall
    pressure w.

    Under a `Depth` with a compliance, z is the depth of the base. The `operator` A then includes
    the deflection of the spring, so that a solver need not know of the spring.
    """

    grid: Grid
    """The cells on which pressure, displacement and profile are given."""
    operator: Operator
    """The map from pressure [Pa] to displacement [m], which counts its applications."""
    profile: Array
    """Indenter profile f ≤ 0 [m] of the grid's shape; −inf where there is no indenter."""
    control: Depth | Force
    """The prescribed depth or force; a mean pressure is given as a force."""
    law: Law | None
    """The traction that acts across the gap; None for hard contact that does not stick."""
    left: Array | None
    """Displacement [m] left behind by earlier load steps, to which A p adds; None if there is none.

    It is already subtracted from `profile`, so that a solver need not know of it.
    """

    def __init__(
        self,
        grid: Grid,
        operator: Operator,
        profile: Array,
        control: Depth | Force | Literal["depth", "force"],
        value: float | None = None,
        prescribed: Literal["depth", "force"] | None = None,
        law: Law | None = None,
        left: Array | None = None,
    ) -> None:
        # Packages written for version 1 pass the kind of control and its value separately.
        kind = prescribed or control
        if isinstance(kind, str):
            assert value is not None
            kind = _CONTROLS[kind](value)
        elif value is not None:
            kind = replace(kind, value=value)
        compliance = kind.compliance if isinstance(kind, Depth) else 0.0
        vars(self).update(
            grid=grid,
            operator=operator.with_spring(compliance),
            profile=profile,
            control=kind,
            law=law,
            left=left,
        )

    @property
    def prescribed(self) -> Literal["depth", "force"]:
        """The kind of `control`; use that instead."""
        return "depth" if isinstance(self.control, Depth) else "force"

    @property
    def value(self) -> float:
        """The value of `control`; use that instead."""
        return self.control.value

    @property
    def needs_solving(self) -> bool:
        """Whether there is contact, so that the undeformed surface is not the solution.

        With a law, whether the indenter presses or is within the cutoff, if it was out of reach
        before.
        """
        lowest = float(self.profile.max())
        if self.law:
            near = 0.0 if self.law.needs_contact else self.law.cutoff()
            least = 0.0 if self.prescribed == "force" else -lowest - near
            return isfinite(lowest) and self.value >= least
        # A coarse grid may not resolve any part of an indenter of single cells.
        return isfinite(lowest) and self.value > (0 if self.prescribed == "force" else -lowest)

    @property
    def heights(self) -> Array:
        """The indenter alone: `profile` without the displacement left behind [m]."""
        return self.profile if self.left is None else self.profile + self.left

    @property
    def first_touch(self) -> float:
        """Depth [m] at which the indenter touches the surface; 0 if nothing is left behind."""
        return 0.0 if self.left is None else -float(self.profile.max())

    def depth(self, u_minus_f: Array) -> float:
        """Return z [m] given A p − f on the contact.

        Under force control it is the depth for which the mean gap in contact vanishes (Polonsky &
        Keer 1999).
        """
        return self.value if self.prescribed == "depth" else float(u_minus_f.mean())

    def gap(self, displacement: Array, contact: Mask) -> tuple[Array, float]:
        """Return the gap A p − z − f and z [m] given A p, by `depth` on the contact."""
        gap = displacement - self.profile
        depth = self.depth(gap[contact])
        gap -= depth
        return gap, depth

    def attraction(self, gap: Array, contact: Mask) -> Attraction:
        """Return what the law of the problem exerts across ``gap`` [m], closed in ``contact``."""
        assert self.law
        return attraction(self.law, self.heights, gap, contact, self.grid.boundary)

    def has_infinite_stiffness(self, contact: Mask) -> bool:
        """Return whether the contact stiffness is infinite.

        This is so in full contact on a periodic domain whose mean displacement is 0.
        """
        return bool(contact.all()) and not self.operator.has_mean_compliance

    def height_scale(self, contact: Mask | Cells, depth: float, total: float) -> float:
        """Return the length [m] to which gaps are compared.

        This is the height range of the indenter in contact or, if it is flat there, its depth below
        the mean plane of a period, which a layer much thicker than the period displaces by far more
        than heights. If a flat indenter fills a period, both are mere rounding; the length is then
        the displacement of the most compliant wave under the mean pressure. ``contact`` is a mask
        or has flat indices, ``depth`` [m] is that of the base and ``total`` the sum of all
        pressures [Pa].
        """
        wave, cells = 0.0, self.profile.size
        number = np.count_nonzero(contact) if contact.dtype == bool else contact.size
        if number == cells and self.grid.boundary == "periodic":
            wave = self.operator.greatest * total / cells
        below = self.operator.mean_displacement(total)
        if below and self.left is not None:
            below += float(self.left.mean())
        below += self.operator.deflection(total)
        return height_scale(self.heights, contact, depth - below, wave)

    def coarsened(self) -> Problem:
        """Return the same problem with half as many cells each way.

        Raises
        ------
        ConfigError
            The kernel cannot be used on the coarser grid.
        """
        operator = self.operator.coarsened()
        grid = operator.grid
        return replace(
            self,
            grid=grid,
            operator=operator,
            profile=restrict(self.profile, grid.shape),
            law=self.law.on(grid) if self.law else None,
            left=None if self.left is None else restrict(self.left, grid.shape),
        )

    def scaled(self, height: float, pressure: float) -> Problem:
        """Return the problem in units of ``height`` [m] and ``pressure`` [Pa], both powers of two.

        The lengths of the grid remain in m. The profile is in C order afterwards.
        """
        return replace(
            self,
            operator=self.operator.scaled(pressure / height),
            profile=np.divide(self.profile, height, order="C"),
            control=self.control.scaled(height, pressure),
            law=self.law.scaled(height, pressure) if self.law else None,
            left=None if self.left is None else self.left / height,
        )


@dataclass(frozen=True)
class Equilibrium:
    """A pressure with its displacement, gap and residuals.

    The first access to any of these applies the operator once.
    """

    problem: Problem
    pressure: Array
    """Traction on the surface [Pa]; without a law the contact pressure."""
    adhesive: State | None = None
    """The state that the solver found, if the problem has a law."""

    @property
    def wall(self) -> Array:
        """Wall pressure [Pa]; without a law the contact pressure."""
        return self.adhesive.wall if self.adhesive else self.pressure

    @cached_property
    def contact(self) -> Mask:
        """The cells with wall pressure > 0, bool of the grid's shape."""
        return self.wall > 0

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
    def depth(self) -> float:
        """Depth δ of the indenter [m]."""
        return self._base - self.problem.operator.deflection(self.total)

    @cached_property
    def gap(self) -> Array:
        """Gap u − δ − f [m]; +inf where there is no indenter."""
        return self._by_pressure - self.problem.profile - self.depth

    @cached_property
    def attraction(self) -> Attraction | None:
        """What the law of the problem exerts across the gap; None without a law."""
        return self.problem.attraction(self.gap, self.contact) if self.problem.law else None

    @cached_property
    def zone(self) -> Mask:
        """The cells off the contact where the traction exceeds 1 % of the strength of the law."""
        strength = self.problem.law.strength() if self.problem.law else 0.0
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
        """Elastic energy and energy of the law [J]; the spring of a holder is not counted.

        NaN where earlier steps have left a displacement behind: the energy that is stored in a
        solid that relaxes does not follow from its surface.
        """
        if self.problem.left is not None:
            return np.nan
        elastic = 0.5 * float((self.pressure * self.displacement).sum())
        bound = self.attraction.energy if self.attraction else 0.0
        return (elastic + bound) * self.problem.grid.cell_area

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
        """Σ w|gap| / Σ|p|, over the same; with a law over the greater of Σ|p| and Σ|σ|."""
        work = float((self.wall[self.contact] * self._inside).sum())
        return work / self._acting / self._scale if work else 0.0

    @property
    def residual_load(self) -> float:
        """|force − prescribed| over the prescribed force, with a law over Σ|p|; 0 at a depth."""
        control = self.problem.control
        missed = abs(self.force - control.value) if isinstance(control, Force) else 0.0
        if self.problem.law:
            scale = self._magnitude * self.problem.grid.cell_area
            return missed / (scale or abs(control.value)) if missed else 0.0
        return missed / control.value if missed else 0.0

    @property
    def residual_traction(self) -> float:
        """Σ|p − w − σ(gap)| over the greater of Σ|p| and Σ|σ|; 0 without a law."""
        if not self.attraction:
            return 0.0
        missed = float(np.abs(self.pressure - self.wall - self.attraction.traction).sum())
        return missed / self._acting if missed else 0.0

    @cached_property
    def _magnitude(self) -> float:
        return float(np.abs(self.pressure).sum()) if self.problem.law else self.total

    @cached_property
    def _acting(self) -> float:
        """Σ|p|, or Σ|σ| if that is greater: a law attracts even where the wall bears it all."""
        if not self.attraction:
            return self._magnitude
        return max(self._magnitude, float(np.abs(self.attraction.traction).sum()))

    @cached_property
    def _base(self) -> float:
        # Without pressure the lowest point just touches, even if it lies between the cells.
        contact = self.contact
        if not contact.any():
            if self.adhesive and self.problem.prescribed == "force":
                return self.adhesive.depth
            return self.problem.depth(np.full(1, self.problem.first_touch))
        return self.problem.depth(self._by_pressure[contact] - self.problem.profile[contact])

    @cached_property
    def _scale(self) -> float:
        if self.problem.law:
            return adhesive_scale(self.problem, self.contact, self._by_pressure)
        return self.problem.height_scale(self.contact, self._base, self.total)

    @property
    def _inside(self) -> Array:
        return np.abs(self.gap[self.contact])


def equilibrium_of(problem: Problem, solution: Solution) -> Equilibrium:
    """Return the equilibrium of a solver's solution; its gap is computed on first access."""
    state = solution.state
    return Equilibrium(problem, solution.pressure, state if isinstance(state, State) else None)


def measure(problem: Problem, pressure: Array) -> Equilibrium:
    """Return the equilibrium of ``pressure`` [Pa], by one application of the operator."""
    equilibrium = Equilibrium(problem, pressure)
    _ = equilibrium.gap
    return equilibrium


def height_scale(
    profile: Array,
    contact: Mask | Cells,
    depth: float,
    wave: float = 0.0,
) -> float:
    """Return the length [m] to which gaps are compared: the indenter's height range in contact.

    If the indenter is flat over the contact (a punch, a single cell), the length is the depth or,
    if greater, ``wave`` [m], of which both range and depth may be rounding errors. ``contact`` is a
    mask or has flat indices.
    """
    heights = profile.ravel()[contact.ravel()]
    in_contact = float(np.ptp(heights)) if heights.size else 0.0
    if in_contact > max(_FLAT * abs(depth), _ROUNDING * wave):
        return in_contact
    indenter = profile[np.isfinite(profile)]
    return max(abs(depth), wave) or float(np.ptp(indenter)) or 1.0


def adhesive_scale(problem: Problem, contact: Mask, displacement: Array) -> float:
    """Return the length [m] to which gaps are compared where a law acts.

    It is the height range in contact or, if the indenter is flat there, the greatest
    ``displacement`` [m] by the pressure: a surface that is pulled may be far from flat at a depth
    near 0. Where wall pressure and attraction cancel, as on a single cell that just touches, the
    displacement is mere rounding; the length is then the height range of the indenter.
    """
    heights = problem.heights[contact]
    in_contact = float(np.ptp(heights)) if heights.size else 0.0
    greatest = float(np.abs(displacement).max())
    if in_contact > _FLAT * greatest:
        return in_contact
    assert problem.law
    if greatest > _ROUNDING * problem.law.strength() * problem.operator.unit:
        return greatest
    indenter = problem.profile[np.isfinite(problem.profile)]
    return float(np.ptp(indenter)) or 1.0


def round_off(problem: Problem, pressure: Array) -> float:
    """Return the rounding error of a displacement over the height scale, by two applications.

    It is the difference of the displacement from three times that under a third of the pressure,
    which would be 0 without rounding.
    """
    contact = pressure > 0
    displacement = problem.operator(pressure)
    rounded = float(np.abs(3 * problem.operator(pressure / 3) - displacement).max())
    u_minus_f = displacement - problem.profile
    depth = problem.depth(u_minus_f[contact] if contact.any() else np.zeros(1))
    return rounded / problem.height_scale(contact, depth, float(pressure.sum()))


class Stiffness(NamedTuple):
    """The stiffness of a contact and its residual."""

    value: float
    """dF/dδ [N/m] with the contact fixed."""
    residual: float
    """Rms error of the displacement in contact, over the prescribed displacement."""


def measure_stiffness(
    problem: Problem, contact: Mask, pressure: Array, attraction: Attraction | None = None
) -> Stiffness:
    """Return the contact stiffness from the pressure per depth [Pa/m] of a flat punch.

    The footprint of the punch is ``contact``: cells that join as the depth grows carry no pressure
    at first, so dF/dδ is that of a flat punch (Pharr, Oliver & Brotzen 1992 for axisymmetric
    indenters). The operator is applied once. The value is 2 Σq − Σq·Aq times the area of a cell,
    stationary at the solution, so its error is quadratic in that of q.

    With an ``attraction`` the traction off the contact follows the gap, q = dσ/dg (A q − 1), and
    counts towards the force.
    """
    if not contact.any():
        return Stiffness(0.0, 0.0)
    opened = problem.operator.with_spring(0.0)(pressure) - 1.0
    missed = -opened[contact]
    total = float(pressure.sum()) + float((pressure[contact] * missed).sum())
    if attraction and attraction.zone.any():
        zone = attraction.zone
        traction = (attraction.change(opened) - pressure)[zone]
        total -= float((opened[zone] * traction).sum())
        missed = np.concatenate([missed, traction / attraction.greatest_slope])
    return Stiffness(
        value=total * problem.grid.cell_area,
        residual=float(np.sqrt((missed**2).mean())),
    )
