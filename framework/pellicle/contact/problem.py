"""What a load step poses: contact that does not stick or does, or a known traction."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Literal, Self

import numpy as np

from pellicle.arrays import Array, Cells, Mask
from pellicle.grid import Grid
from pellicle.surface.grid_transfer import restrict
from pellicle.surface.operators import Operator

from .attraction import Attraction, attraction
from .law import Law

# Height range in contact over the depth below which an indenter counts as flat there.
_FLAT = 1e-3
# Relative rounding error of displacements; smaller heights are not resolved.
_ROUNDING = 1e-13


@dataclass(frozen=True)
class Depth:
    """Depth control: δ = value − compliance · F."""

    value: float
    """Depth [m] of the indenter, or of the base if a spring holds the indenter."""
    compliance: float = 0.0
    """Compliance of the spring between base and indenter [m/N]; 0 without a spring."""


@dataclass(frozen=True)
class Force:
    """Force control."""

    value: float
    """Force on the domain [N]."""


@dataclass(frozen=True)
class Unilateral:
    """Find p ≥ 0 with gap = A p − z − f ≥ 0 and p·gap = 0, for a given depth z or force.

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
    left: Array | None = None
    """Displacement [m] left behind by earlier load steps, to which A p adds; None if there is none.

    It is already subtracted from `profile`, so that a solver need not know of it.
    """

    def __post_init__(self) -> None:
        compliance = self.control.compliance if isinstance(self.control, Depth) else 0.0
        object.__setattr__(self, "operator", self.operator.with_spring(compliance))

    @property
    def prescribed(self) -> Literal["depth", "force"]:
        """The kind of `control`."""
        return "depth" if isinstance(self.control, Depth) else "force"

    @property
    def value(self) -> float:
        """The value of `control`."""
        return self.control.value

    @property
    def needs_solving(self) -> bool:
        """Whether there is contact, so that the undeformed surface is not the solution."""
        lowest = float(self.profile.max())
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
        Keer 1999), 0 without contact.
        """
        if self.prescribed == "depth":
            return self.value
        return float(u_minus_f.mean()) if u_minus_f.size else 0.0

    def gap(self, displacement: Array, contact: Mask) -> tuple[Array, float]:
        """Return the gap A p − z − f and z [m] given A p, by `depth` on the contact."""
        gap = displacement - self.profile
        depth = self.depth(gap[contact])
        gap -= depth
        return gap, depth

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

    def coarsened(self) -> Self:
        """Return the same problem with half as many cells each way."""
        operator = self.operator.coarsened()
        grid = operator.grid
        return replace(
            self,
            grid=grid,
            operator=operator,
            profile=restrict(self.profile, grid.shape),
            left=None if self.left is None else restrict(self.left, grid.shape),
        )

    def scaled(self, height: float, pressure: float) -> Self:
        """Return the problem in units of ``height`` [m] and ``pressure`` [Pa], both powers of two.

        The lengths of the grid remain in m. The profile is in C order afterwards.
        """
        control = self.control
        if isinstance(control, Depth):
            control = Depth(control.value / height, control.compliance * pressure / height)
        else:
            control = Force(control.value / pressure)
        return replace(
            self,
            operator=self.operator.scaled(pressure / height),
            profile=np.divide(self.profile, height, order="C"),
            control=control,
            left=None if self.left is None else self.left / height,
        )


Problem = Unilateral
"""The contact problem that a solver gets: `Unilateral`, or `Adhesive`, which is one too."""


@dataclass(frozen=True)
class Adhesive(Unilateral):
    """Find p = w + σ(gap) with gap = A p − z − f ≥ 0, w ≥ 0 and w·gap = 0.

    The conditions on the pressure hold for the wall pressure w.
    """

    law: Law = field(kw_only=True)
    """The traction σ that acts across the gap."""

    @property
    def without_law(self) -> Unilateral:
        """The problem of a contact that does not stick."""
        return Unilateral(self.grid, self.operator, self.profile, self.control, self.left)

    @property
    def needs_solving(self) -> bool:
        """Whether the indenter presses or is within the cutoff, if it was out of reach before."""
        lowest = float(self.profile.max())
        near = 0.0 if self.law.needs_contact else self.law.cutoff()
        least = 0.0 if self.prescribed == "force" else -lowest - near
        return isfinite(lowest) and self.value >= least

    def attraction(self, gap: Array, contact: Mask) -> Attraction:
        """Return what the law exerts across ``gap`` [m], closed in ``contact``."""
        return attraction(self.law, self.heights, gap, contact, self.grid.boundary)

    def length_scale(self, contact: Mask, displacement: Array) -> float:
        """Return the length [m] to which gaps are compared.

        It is `height_scale` with the greatest ``displacement`` [m] by the pressure as depth: a
        surface that is pulled may be far from flat at a depth near 0. Where wall pressure and
        attraction cancel, as on a single cell that just touches, the displacement is mere rounding.
        """
        rounding = _ROUNDING * self.law.strength() * self.operator.unit
        greatest = float(np.abs(displacement).max())
        return height_scale(self.heights, contact, greatest, rounding=rounding)

    def coarsened(self) -> Self:
        """Return the same problem with half as many cells each way, and the law resolved there."""
        coarse = super().coarsened()
        return replace(coarse, law=self.law.on(coarse.grid))

    def scaled(self, height: float, pressure: float) -> Self:
        """Return the problem in units of ``height`` [m] and ``pressure`` [Pa]."""
        law = self.law.scaled(height, pressure)
        return replace(super().scaled(height, pressure), law=law)


@dataclass(frozen=True)
class Traction:
    """Find u = A p for a known traction p: one application of the operator."""

    grid: Grid
    """The cells on which traction and displacement are given."""
    operator: Operator
    """The map from pressure [Pa] to displacement [m], which counts its applications."""
    pressure: Array
    """The traction [Pa] of the grid's shape, positive into the solid."""
    left: Array | None = None
    """Displacement [m] left behind by earlier load steps; None if there is none."""


Posed = Unilateral | Adhesive | Traction
"""What a load step poses."""


def height_scale(
    profile: Array, contact: Mask | Cells, depth: float, wave: float = 0.0, rounding: float = 0.0
) -> float:
    """Return the length [m] to which gaps are compared: the indenter's height range in contact.

    If the indenter is flat over the contact (a punch, a single cell), the length is the ``depth``
    or, if greater, ``wave`` [m], since both range and depth may be rounding errors of that. If
    this is no more than ``rounding`` [m], it is the height range of the indenter. ``contact`` is a
    mask or has flat indices.
    """
    heights = profile.ravel()[contact.ravel()]
    in_contact = float(np.ptp(heights)) if heights.size else 0.0
    if in_contact > max(_FLAT * abs(depth), _ROUNDING * wave):
        return in_contact
    displaced = max(abs(depth), wave)
    # A NaN is returned, so that the residuals show it.
    if not displaced <= rounding:
        return displaced
    return float(np.ptp(profile[np.isfinite(profile)])) or 1.0
