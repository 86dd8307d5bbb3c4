"""Adhesive contact of a rigid axisymmetric indenter with a half-space under surface tension.

With force F₁, depth δ₁ and stiffness k of the contact without adhesion of the same radius a, the
adhesive contact is that contact and a flat punch of radius a retracted by D:

    F = F₁ − kD,  δ = δ₁ − D,  D = √(4πa w / k′),  k′ = dk/da,

where the energy release rate k′D²/(4πa) equals the work of adhesion w.  Without tension k = 2E*a:
the theory of Johnson, Kendall & Roberts (1971) for a paraboloid, of Maugis & Barquins (1981) for a
cone and of Kendall (1971) for a flat punch.  Where tension dominates (s ≫ a) the slope of the
surface jumps by √(2w/τ₀) at the rim, as under a drop (Hui, Liu, Salez, Raphaël & Jagota 2015).
The theory assumes small slopes.

Where the slope of the profile jumps by θ, at an edge of radius b, the contact without adhesion has
that radius from one depth on to another that is greater by θ√(2πb τ₀/k′), and so has the adhesive
one, retracted by the D of that radius.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from math import exp, inf, log, nan, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from pellicle.arrays import Array
from pellicle.components import HasAbelSlope
from pellicle.errors import ConfigError

from .adhesion_from_path import AdhesiveContact, AdhesiveCurve
from .arguments import not_negative, positive
from .equation import kinks_of
from .radius_curves import END, RadiusCurves, radius_at, radius_curves, xi_at
from .reciprocity import contacts, punch_slope
from .tensed_punch import punch

_STEP = 0.5
_SAMPLES, _REFINED = 400, 2
"""Radii at which a body with edges is known, and how often those near an answer are made denser."""
_NEAR = 1e-8
"""Distance from an edge at which the slope of the transform is taken, over its radius."""


@dataclass(frozen=True)
class Adhesion:
    """Adhesive contact of an indenter of revolution, on the whole curve of equilibria.

    Without tension, forces and depths have relative errors below 1e-9, and with it below 1e-8. The
    radius of an instability under tension has one below 5e-6, and so has what depends on it to
    first order: the force at a fixed depth. With `kinks` these errors are below 1e-6 and 1e-4.
    """

    indenter: HasAbelSlope
    """A paraboloid, sphere or cone component, or any other object with this transform."""
    reduced_modulus: float
    """E* = E / (1 − ν²) [Pa]."""
    tension: float
    """τ₀ [N/m], zero included."""
    work_of_adhesion: float
    """w [J/m²]."""

    def __post_init__(self) -> None:
        positive(reduced_modulus=self.reduced_modulus, work_of_adhesion=self.work_of_adhesion)
        not_negative(tension=self.tension)

    def equilibrium(self, contact_radius: ArrayLike) -> AdhesiveContact:
        """Return the equilibrium, stable or not, at contact radii > 0 [m] of any shape.

        At the radius of an edge it is the deepest retracted one, which lets go.
        """
        radius = np.asarray(contact_radius, dtype=float)
        limit = self.indenter.contact_radius_limit
        if not np.all((radius > 0) & (radius < limit)):
            raise ConfigError(
                f"must be positive and less than {limit} m, got {contact_radius!r}",
                "contact_radius",
            )
        if kinks_of(self.indenter):
            contact = self._with_edges(radius.ravel(), ())
            return AdhesiveContact(*(values.reshape(radius.shape) for values in contact))
        return self._equilibrium(xi_at(self.indenter, radius))

    def instability(self, spring_constant: float = 0.0) -> AdhesiveContact:
        """Return the last stable equilibrium of a retraction, where dF/dδ = −k_c.

        k_c = ``spring_constant`` [N/m] is that of what holds the indenter.  0 is a dead load:
        pull-off, the lowest force.  ``math.inf`` is a fixed depth: the lowest depth.  For a cone
        whose flank is steeper than the surface at its rim, cot α ≥ √(2w/τ₀), all is 0: its contact
        shrinks to nothing without being pulled.
        """
        if not spring_constant >= 0:
            raise ConfigError(f"must not be negative, got {spring_constant!r}", "spring_constant")
        apex_slope = 2 / pi * float(self.indenter.abel_slope(np.zeros(1))[0])
        if self.indenter.pointed and apex_slope >= self._rim_slope:
            return AdhesiveContact(*np.zeros(3))
        if kinks_of(self.indenter):
            return self._sought(lambda curve: curve.instability(spring_constant))
        per_modulus = spring_constant / self.reduced_modulus

        def slope(xi: float) -> float:
            force, depth = self._slopes(xi)
            return depth if per_modulus == inf else force + per_modulus * depth

        return self._equilibrium(np.array(_rising_root(slope, self._guess(), self._last)))

    def at_depth(self, depth: float) -> AdhesiveContact:
        """Return the equilibrium at a depth [m] that is stable if the depth is fixed."""
        return self._stable(depth, "depth", inf)

    def at_force(self, force: float) -> AdhesiveContact:
        """Return the equilibrium at a force [N] that is stable under a dead load."""
        return self._stable(force, "force", 0.0)

    def _stable(self, value: float, quantity: str, spring_constant: float) -> AdhesiveContact:
        """Return the equilibrium with a value of depth or force above that of the instability."""
        end = self.instability(spring_constant)
        lowest = float(getattr(end, quantity))
        if not value > lowest:
            raise ConfigError(f"must be above {lowest:g}, the lowest, got {value!r}", quantity)
        if kinks_of(self.indenter):
            return self._sought(lambda curve: curve.at(quantity, value))

        def excess(xi: float) -> float:
            return float(getattr(self._equilibrium(np.array(xi)), quantity)) - value

        start = xi_at(self.indenter, end.contact_radius) if end.contact_radius else self._guess()
        return self._equilibrium(np.array(_rising_root(excess, float(start), self._last)))

    def _sought(self, ask: Callable[[AdhesiveCurve], AdhesiveContact]) -> AdhesiveContact:
        """Return what a curve is asked for, of an indenter with edges."""
        limit, edges = self.indenter.contact_radius_limit, kinks_of(self.indenter)
        top, curve = edges[-1], None
        lowest = 1e-3 * min(edges[0], self.work_of_adhesion / self.reduced_modulus)
        answer = AdhesiveContact(*np.full(3, nan))
        while curve is None or curve.force[-1] < 0 or np.isnan(answer.contact_radius):
            top = min(2 * top, (top + limit) / 2)
            if top > limit * (1 - END):
                raise ConfigError(
                    f"spreads the contact over the whole profile, {limit:g} m wide",
                    "work_of_adhesion",
                )
            radii = np.geomspace(lowest, top, _SAMPLES)
            curve = self._with_edges(np.union1d(radii, edges), edges)
            answer = ask(curve)
        width = log(radii[1] / radii[0])
        for _ in range(_REFINED):
            radii = answer.contact_radius * np.exp(width * np.linspace(-1.5, 1.5, 49))
            inside = [edge for edge in edges if radii[0] < edge < radii[-1]]
            answer = ask(self._with_edges(np.union1d(radii, inside), inside))
            width /= 16
        return answer

    def _with_edges(self, radius: Array, edges: Iterable[float]) -> AdhesiveCurve:
        """Return equilibria at radii [m], of shape (n,), with both ends of each edge."""
        modulus, length = self.reduced_modulus, 2 * self.tension / self.reduced_modulus
        hard = contacts(self.indenter, radius, length)
        area_rate = 4 * pi * self.work_of_adhesion / modulus * radius
        retraction = np.sqrt(area_rate / hard.stiffness_slope)
        depth, stiffness = hard.depth - retraction, modulus * hard.stiffness
        curve = np.stack([radius, depth, modulus * hard.force - stiffness * retraction])
        for edge in edges:
            at = int(np.searchsorted(curve[0], edge))
            here = int(np.searchsorted(radius, edge))
            slopes = self.indenter.abel_slope(edge * (1 + _NEAR * np.array([1.0, 4.0])))
            kink = max(0.0, 2 * sqrt(2 * _NEAR) * float(slopes[0] - slopes[1]))
            width = kink * sqrt(pi * edge * length / float(hard.stiffness_slope[here]))
            end = curve[:, at] + width * np.array([0.0, 1.0, stiffness[here]])
            curve = np.insert(curve, at + 1, end, axis=1)
        return AdhesiveCurve(*curve)

    @property
    def _rim_slope(self) -> float:
        """√(2w/τ₀), the jump of the surface's slope at the rim; infinite without tension."""
        return sqrt(2 * self.work_of_adhesion / self.tension) if self.tension else inf

    @property
    def _last(self) -> float:
        """The largest ξ."""
        limit = self.indenter.contact_radius_limit
        return inf if limit == inf else float(xi_at(self.indenter, np.array(limit * (1 - END))))

    def _guess(self) -> float:
        """Return ξ near pull-off: the indenter is as steep at the rim as adhesion lifts it."""
        scale = 2 * pi * self.work_of_adhesion / self.reduced_modulus

        def excess(xi: float) -> float:
            radius = radius_at(self.indenter, np.array([xi]))
            rim = min(sqrt(scale / float(radius[0])), self._rim_slope)
            return 2 / pi * float(self.indenter.abel_slope(radius)[0]) - rim

        return _rising_root(excess, log(scale), self._last)

    def _curves(self, xi: Array) -> tuple[RadiusCurves, Array]:
        """Return the contact without adhesion and the retraction D [m], each of shape (n,)."""
        hard = radius_curves(self.indenter, 2 * self.tension / self.reduced_modulus, xi)
        # k′ = (k/a) (d log k / dξ) / (d log a / dξ).
        area_rate = 4 * pi * self.work_of_adhesion / self.reduced_modulus * hard.radius**2
        retraction = np.sqrt(
            area_rate * hard.radius_slope / (hard.stiffness * hard.stiffness_slope)
        )
        return hard, retraction

    def _equilibrium(self, xi: Array) -> AdhesiveContact:
        hard, retraction = self._curves(xi.ravel())
        depth = hard.depth - retraction
        force = self.reduced_modulus * (hard.force - hard.stiffness * retraction)
        return AdhesiveContact(
            *(values.reshape(xi.shape) for values in (hard.radius, depth, force))
        )

    def _slopes(self, xi: float) -> tuple[float, float]:
        """Return d(F/E*)/dξ [m²] and dδ/dξ [m]."""
        hard, retraction = self._curves(np.array([xi]))
        # 1 − radius_slope = a/L falls out of d log(1 − a/L) / dξ.
        rate = (
            3 * hard.radius_slope
            - 1
            - hard.stiffness_slope
            - hard.stiffness_curvature / hard.stiffness_slope
        ) / 2
        punch_force = hard.stiffness * retraction
        force = hard.force * hard.force_slope - punch_force * (hard.stiffness_slope + rate)
        depth = hard.depth * hard.depth_slope - retraction * rate
        return float(force[0]), float(depth[0])


def punch_pull_off(
    radius: float, reduced_modulus: float, tension: float, work_of_adhesion: float
) -> AdhesiveContact:
    """Return the last equilibrium of a flat punch, the same for a dead load and a fixed depth.

    Its contact opens all at once, at D = √(4πa w / k′); without tension F = −√(8πE*w a³)
    (Kendall 1971).  The radius a is in m, E* = E / (1 − ν²) in Pa, τ₀ in N/m and w in J/m².
    """
    positive(work_of_adhesion=work_of_adhesion)
    contact = punch(radius, reduced_modulus, tension, depth=1.0)
    ratio = np.array([2 * tension / reduced_modulus / radius])
    slope = reduced_modulus * float(punch_slope(ratio)[0])
    retraction = sqrt(4 * pi * radius * work_of_adhesion / slope)
    return AdhesiveContact(
        np.array(radius), np.array(-retraction), np.array(-contact.force * retraction)
    )


def _rising_root(function: Callable[[float], float], start: float, last: float) -> float:
    """Return where a function of ξ goes from negative to positive, below ``last``."""
    # Outputs import this module, but most of them do not need scipy.optimize.
    from scipy.optimize import brentq

    low = high = start
    while function(high) < 0:
        low, high = high, high + _STEP
        if high > last:
            raise ConfigError(
                f"spreads the contact over the whole profile, {exp(last):g} m wide",
                "work_of_adhesion",
            )
    if low == high:
        while function(low) > 0:
            low, high = low - _STEP, low
    return low if low == high else float(brentq(function, low, high, xtol=1e-13, rtol=1e-14))
