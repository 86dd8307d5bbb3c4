"""The problem of one load step: all that a solver may see, and how well it is solved."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite
from typing import Final, Literal, NamedTuple

import numpy as np

from pellicle.arrays import Array, Mask
from pellicle.grid import Grid

from .grid_transfer import restrict
from .operators import Operator

# An indenter that is flat over the contact has no height range there to measure by.
_FLAT = 1e-3
# Heights below this share of a displacement are lost in its rounding.
_ROUNDING = 1e-13


@dataclass(frozen=True)
class Depth:
    """Depth control: δ = value − compliance · F."""

    value: float
    """Depth [m] of the indenter, or of the base that holds it by a spring."""
    compliance: float = 0.0
    """Of the spring between base and indenter [m/N]; 0 without a spring."""

    def scaled(self, height: float, pressure: float) -> Depth:
        """Return it in units of ``height`` [m] and ``pressure`` [Pa]."""
        return Depth(self.value / height, self.compliance * pressure / height)


@dataclass(frozen=True)
class Force:
    """Force control."""

    value: float
    """Force on the domain [N]."""

    def scaled(self, height: float, pressure: float) -> Force:
        """Return it in units of ``pressure`` [Pa]."""
        return Force(self.value / pressure)


_CONTROLS: Final = {"depth": Depth, "force": Force}


@dataclass(frozen=True, init=False)
class Problem:
    """Find p ≥ 0 with gap = A p − z − f ≥ 0 and p·gap = 0, for a given depth z or force.

    Under a `Depth` with a compliance z is the depth of the base. The `operator` A then includes
    the deflection of the spring, so that no solver has to know of it.
    """

    grid: Grid
    """The cells that pressure, displacement and profile live on."""
    operator: Operator
    """From pressure [Pa] to displacement [m]; counts its applications."""
    profile: Array
    """Indenter profile f ≤ 0 [m] of the grid's shape; −inf where there is no indenter."""
    control: Depth | Force
    """What is given: a depth or a force. A mean pressure is the force that it makes."""

    def __init__(
        self,
        grid: Grid,
        operator: Operator,
        profile: Array,
        control: Depth | Force | Literal["depth", "force"],
        value: float | None = None,
        prescribed: Literal["depth", "force"] | None = None,
    ) -> None:
        # Packages written for version 1 name the control and its value apart.
        kind = prescribed or control
        if isinstance(kind, str):
            assert value is not None
            kind = _CONTROLS[kind](value)
        elif value is not None:
            kind = replace(kind, value=value)
        compliance = kind.compliance if isinstance(kind, Depth) else 0.0
        vars(self).update(
            grid=grid, operator=operator.with_spring(compliance), profile=profile, control=kind
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
        """Whether anything has to be solved: the undeformed surface is not already the answer."""
        lowest = float(self.profile.max())
        # A coarse grid may see nothing of an indenter of single cells.
        return isfinite(lowest) and self.value > (0 if self.prescribed == "force" else -lowest)

    def depth(self, u_minus_f: Array) -> float:
        """Return z [m] given A p − f on the contact.

        It is the prescribed depth or, under force control, that for which the mean gap in contact
        vanishes (Polonsky & Keer 1999).
        """
        return self.value if self.prescribed == "depth" else float(u_minus_f.mean())

    def gap(self, displacement: Array, contact: Mask) -> tuple[Array, float]:
        """Return the gap A p − z − f and z [m] given A p, by `depth` on the contact."""
        gap = displacement - self.profile
        depth = self.depth(gap[contact])
        gap -= depth
        return gap, depth

    def has_infinite_stiffness(self, contact: Mask) -> bool:
        """Whether no force more on ``contact`` makes it sink: full contact that keeps its mean."""
        return bool(contact.all()) and not self.operator.has_mean_compliance

    def height_scale(self, contact: Mask, depth: float, total: float) -> float:
        """Return the length [m] by which gaps are judged.

        ``depth`` [m] is that of the base, ``total`` the sum of all pressures [Pa].

        The indenter's height range in contact, or the depth where it is flat there. Neither is more
        than rounding where a flat indenter fills a periodic domain whose mean stays: then it is the
        displacement that the mean pressure would have as the most compliant wave.
        """
        wave = 0.0
        if self.has_infinite_stiffness(contact):
            wave = self.operator.greatest * total / contact.size
        return height_scale(self.profile, contact, depth - self.operator.deflection(total), wave)

    def coarsened(self) -> Problem:
        """Return the same problem with half as many cells each way.

        Raises
        ------
        ConfigError
            The kernel cannot work on the coarser grid.
        """
        operator = self.operator.coarsened()
        grid = operator.grid
        return replace(
            self, grid=grid, operator=operator, profile=restrict(self.profile, grid.shape)
        )

    def scaled(self, height: float, pressure: float) -> Problem:
        """Return the same problem with heights in units of ``height`` [m], both powers of two.

        Its pressures are in units of ``pressure`` [Pa]; the lengths of the grid stay in m.
        """
        return replace(
            self,
            operator=self.operator.scaled(pressure / height),
            profile=self.profile / height,
            control=self.control.scaled(height, pressure),
        )


@dataclass(frozen=True)
class Equilibrium:
    """A pressure measured against its problem.

    The first use of the displacement, or of what follows from it, applies the operator once.
    """

    problem: Problem
    pressure: Array
    """[Pa]"""

    @cached_property
    def contact(self) -> Mask:
        """Where pressure acts, bool of the grid's shape."""
        return self.pressure > 0

    @property
    def residual(self) -> float:
        """The largest of the residuals."""
        return max(
            self.residual_contact,
            self.residual_penetration,
            self.residual_complementarity,
            self.residual_load,
        )

    @cached_property
    def total(self) -> float:
        """Sum of the pressures [Pa]."""
        return float(self.pressure.sum())

    @property
    def force(self) -> float:
        """[N]."""
        return self.total * self.problem.grid.cell_area

    @cached_property
    def displacement(self) -> Array:
        """Displacement u of the surface [m]."""
        return self.problem.operator.with_spring(0.0)(self.pressure)

    @property
    def depth(self) -> float:
        """Depth δ of the indenter [m]."""
        return self._base - self.problem.operator.deflection(self.total)

    @cached_property
    def gap(self) -> Array:
        """U − δ − f [m]; +inf where there is no indenter."""
        return self.displacement - self.problem.profile - self.depth

    @property
    def residual_contact(self) -> float:
        """Max |gap| in contact, over the height range of the indenter in contact."""
        return float(self._inside.max(initial=0.0)) / self._scale

    @property
    def residual_penetration(self) -> float:
        """max(0, −min gap) outside the contact, over the same."""
        return max(0.0, -float(self.gap.min(initial=0.0, where=~self.contact))) / self._scale

    @property
    def residual_complementarity(self) -> float:
        """Σ p|gap| / Σ p, over the same."""
        work = float((self.pressure[self.contact] * self._inside).sum())
        return work / self.total / self._scale if self.total else 0.0

    @property
    def residual_load(self) -> float:
        """|force − prescribed| / prescribed; 0 under depth control."""
        control = self.problem.control
        missed = abs(self.force - control.value) if isinstance(control, Force) else 0.0
        return missed / control.value if missed else 0.0

    @cached_property
    def _base(self) -> float:
        # Without pressure the lowest point just touches, wherever between the cells it is.
        contact = self.contact
        if not contact.any():
            return self.problem.depth(np.zeros(1))
        return self.problem.depth(self.displacement[contact] - self.problem.profile[contact])

    @cached_property
    def _scale(self) -> float:
        return self.problem.height_scale(self.contact, self._base, self.total)

    @property
    def _inside(self) -> Array:
        return np.abs(self.gap[self.contact])


def measure(problem: Problem, pressure: Array) -> Equilibrium:
    """Return what ``pressure`` [Pa] really achieves, by one application of the operator."""
    equilibrium = Equilibrium(problem, pressure)
    _ = equilibrium.gap
    return equilibrium


def height_scale(
    profile: Array,
    contact: Mask,
    depth: float,
    wave: float = 0.0,
) -> float:
    """Return the length [m] by which gaps are judged: the indenter's height range in contact.

    Where the indenter is flat over the contact (a punch, a single cell) it is the depth, or
    ``wave`` [m] if that is greater, of which the range and the depth may be the rounding.
    """
    heights = profile[contact]
    in_contact = float(np.ptp(heights)) if heights.size else 0.0
    if in_contact > max(_FLAT * abs(depth), _ROUNDING * wave):
        return in_contact
    indenter = profile[np.isfinite(profile)]
    return max(abs(depth), wave) or float(np.ptp(indenter)) or 1.0


def round_off(problem: Problem, pressure: Array) -> float:
    """Return the rounding of a displacement over the height scale, by two applications.

    It is what displacements differ by under one third of the pressure, times three: without
    rounding they would be the same.
    """
    contact = pressure > 0
    displacement = problem.operator(pressure)
    rounded = float(np.abs(3 * problem.operator(pressure / 3) - displacement).max())
    u_minus_f = displacement - problem.profile
    depth = problem.depth(u_minus_f[contact] if contact.any() else np.zeros(1))
    return rounded / problem.height_scale(contact, depth, float(pressure.sum()))


class Stiffness(NamedTuple):
    """The stiffness of a contact and how well it is known."""

    value: float
    """dF/dδ [N/m] at the contact as it is."""
    residual: float
    """Root mean square of the displacement missed in contact, over that prescribed."""


def measure_stiffness(problem: Problem, contact: Mask, pressure: Array) -> Stiffness:
    """Return the contact stiffness from the pressure per depth [Pa/m] of a flat punch.

    Its footprint is ``contact``: where the contact grows with the depth it does so without
    pressure, so dF/dδ is that of a flat punch of the same contact (Pharr, Oliver & Brotzen 1992 for
    axisymmetric indenters). By one fresh application of the operator. The value
    is 2 Σq − Σq·Aq, which is stationary at the solution: its error is quadratic in that of q.
    """
    if not contact.any():
        return Stiffness(0.0, 0.0)
    response = problem.operator.with_spring(0.0)(pressure)
    missed = 1.0 - response[contact]
    total = float(pressure.sum()) + float((pressure[contact] * missed).sum())
    return Stiffness(
        value=total * problem.grid.cell_area,
        residual=float(np.sqrt((missed**2).mean())),
    )
