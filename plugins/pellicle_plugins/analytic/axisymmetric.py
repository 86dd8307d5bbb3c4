"""Contact of a rigid axisymmetric indenter with a half-space under surface tension.

The Abel transform reduces the contact to ∫_{−a}^{a} φ(t) K(x − t) dt = E* (δ − h(x)),
K(z) = ∫₀^∞ cos(qz) / (1 + s q) dq, s = 2τ₀/E*, with P = π ∫ φ and φ(±a) = 0.  Its
derivative in x, with χ = −φ', no longer holds the depth:

    ∫₀^a χ(t) [K(x − t) − K(x + t)] dt = E* h'(x),

and its only solution, which goes as (a − t)^(−1/2) at the edge, has φ(±a) = 0 built
in.  Then P = 2π ∫ t χ dt, p(r) = ∫_r^a χ / sqrt(t² − r²) dt, and δ is the first
equation at x = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from pellicle.errors import ConfigError, ConvergenceError

from .axisymmetric_indenters import Indenter, classical_radius
from .checks import exactly_one, not_negative, positive
from .panels import (
    Panel,
    Points,
    clustering,
    collocation,
    graded,
    joined,
    points_at,
    weights,
)
from .tension_kernel import auxiliary_g, primitive

Array = NDArray[np.float64]

TOLERANCE = 1e-10
EDGE_TOLERANCE = 1e-6
NEGLIGIBLE = 1e-12
"""s/a below which tension is left out: force and depth would change by less than 1e-11."""
_LEVELS = ((12, 1e-3), (16, 3e-4), (22, 1e-4))
_CHUNK = 2048


@dataclass(frozen=True)
class _Solution:
    """χ dt = E* y(ψ) t^power dψ at the nodes of the panels, t = sin ψ in units of a."""

    panels: list[Panel]
    y: Array
    power: int
    ratio: float

    def moments(self) -> tuple[float, float]:
        """Return P / (E* a²) and δ / a."""
        origin = points_at(np.zeros(1))

        def load(_distance: Array, source: Points, _target: Points) -> Array:
            return 2 * np.pi * source.t ** (self.power + 1)

        def depth(distance: Array, source: Points, _target: Points) -> Array:
            reach = primitive(distance / self.ratio) if self.ratio else np.pi / 2
            return 2 * source.t**self.power * reach

        cluster = clustering(self.ratio)
        force = delta = 0.0
        for panel, y in zip(self.panels, self.y, strict=True):
            force += float(weights(panel, origin, load)[0] @ y)
            delta += float(weights(panel, origin, depth, power=cluster)[0] @ y)
        return force, delta

    def pressure(self, t: Array) -> Array:
        """Return p / E* at positions 0 ≤ t ≤ 1, shape (m,)."""
        inside = points_at(t)
        # The limit from inside: at η = 0 itself nothing would be left to integrate.
        targets = Points(inside.psi, np.maximum(inside.eta, 1e-100))

        def abel(distance: Array, source: Points, _target: Points) -> Array:
            return source.t**self.power / np.sqrt(distance * (2 * source.t - distance))

        out = np.zeros(t.shape)
        for first in range(0, t.size, _CHUNK):
            part = slice(first, first + _CHUNK)
            for panel, y in zip(self.panels, self.y, strict=True):
                out[part] += weights(panel, targets[part], abel, above=True) @ y
        return out


@dataclass(frozen=True)
class AxisymmetricContact:
    """Contact of a rigid axisymmetric indenter with a tensed half-space."""

    contact_radius: float
    """a [m]."""
    depth: float
    """δ [m]."""
    force: float
    """P [N]."""
    reduced_modulus: float
    """E* [Pa]."""
    tension: float
    """τ₀ [N/m]."""
    _solution: _Solution = field(repr=False, compare=False)

    def pressure(self, r: ArrayLike) -> Array:
        """Return the pressure [Pa] at r ≥ 0 [m], of any shape; 0 for r > a.

        At r = a it is the limit from inside, which is not 0 under tension.  Under a
        cone it is infinite at r = 0.
        """
        t = np.asarray(r, dtype=float) / self.contact_radius
        flat = np.abs(t).ravel()
        singular = (flat == 0) & (self._solution.power < 1)
        out = np.where(singular, np.inf, 0.0)
        regular = ~singular & (flat <= 1)
        out[regular] = self.reduced_modulus * self._solution.pressure(flat[regular])
        return out.reshape(t.shape)


def _solve(indenter: Indenter, a: float, ratio: float, level: int) -> _Solution:
    order, finest = _LEVELS[level]
    # Under tension a corner at the apex makes χ ~ 1/t; a smooth apex has χ ~ t.
    power = (-1 if ratio else 0) if indenter.pointed else 1
    layer = min(1.0, ratio) if ratio else 1.0
    panels = graded(order, finest * np.sqrt(layer), finest * layer if indenter.pointed else 1.0)
    nodes = joined(panels)
    slope = indenter.slope(a * nodes.t)
    if not ratio:
        y = slope / np.pi * np.sin(nodes.eta) / nodes.t**power
    else:

        def influence(distance: Array, source: Points, target: Points) -> Array:
            value = auxiliary_g(distance / ratio)
            if power < 0:
                # Cancels between a panel and its mirror image, each of which alone
                # would diverge at the apex.
                value = value - auxiliary_g(target.t / ratio)
            return value / ratio * np.abs(source.t) ** power

        y = np.linalg.solve(collocation(panels, influence, clustering(ratio), -1), slope)
    return _Solution(panels, y.reshape(len(panels), order), power, ratio)


def _contact(
    indenter: Indenter, reduced_modulus: float, tension: float, a: float
) -> AxisymmetricContact:
    ratio = 2 * tension / reduced_modulus / a
    ratio = ratio if ratio > NEGLIGIBLE else 0.0
    change = np.array([np.inf])
    allowed = np.array([TOLERANCE, TOLERANCE, EDGE_TOLERANCE])
    old: Array | None = None
    for level in range(len(_LEVELS)):
        solution = _solve(indenter, a, ratio, level)
        edge = solution.pressure(np.ones(1))[0] if ratio else 1.0
        new = np.array([*solution.moments(), edge])
        if old is not None:
            change = np.abs(new / old - 1)
            if np.all(change <= allowed):
                force, depth = float(new[0]), float(new[1])
                return AxisymmetricContact(
                    contact_radius=a,
                    depth=depth * a,
                    force=force * reduced_modulus * a**2,
                    reduced_modulus=reduced_modulus,
                    tension=tension,
                    _solution=solution,
                )
        old = new
    raise ConvergenceError(
        f"force, depth and edge pressure still change by {change} (allowed {allowed}) "
        f"at a = {a} m, s/a = {ratio:g}; is the contact too close to the end of the profile?"
    )


def indent(
    indenter: Indenter,
    reduced_modulus: float,
    tension: float,
    *,
    contact_radius: float | None = None,
    depth: float | None = None,
    force: float | None = None,
) -> AxisymmetricContact:
    """Return the contact of a rigid axisymmetric indenter, one quantity being given.

    Parameters
    ----------
    indenter
        ``Paraboloid``, ``Sphere``, ``Cone`` or anything else with their methods.
    reduced_modulus
        E* = E / (1 − ν²) [Pa].
    tension
        τ₀ [N/m], zero included.
    contact_radius, depth, force
        a [m], δ [m] or P [N].

    Raises
    ------
    pellicle.errors.ConvergenceError
        If two resolutions differ by more than 1e-10 in force or depth, or 1e-6 in
        edge pressure.
    """
    positive(reduced_modulus=reduced_modulus)
    not_negative(tension=tension)
    exactly_one(contact_radius=contact_radius, depth=depth, force=force)
    if contact_radius is not None:
        positive(contact_radius=contact_radius)
        a = contact_radius
    elif depth is not None:
        positive(depth=depth)
        a = _radius(indenter, 2 * tension / reduced_modulus, 1, depth)
    else:
        assert force is not None
        positive(force=force)
        a = _radius(indenter, 2 * tension / reduced_modulus, 0, force / reduced_modulus)
    if a >= indenter.limit:
        raise ConfigError(
            f"contact radius {a} m must be less than {indenter.limit} m", "contact_radius"
        )
    return _contact(indenter, reduced_modulus, tension, a)


def _radius(indenter: Indenter, s: float, quantity: int, target: float) -> float:
    """Return the contact radius of a force over E* (quantity 0) or depth (1)."""

    def excess(log_a: float) -> float:
        a = float(np.exp(log_a))
        moment = _solve(indenter, a, s / a if s / a > NEGLIGIBLE else 0.0, 0).moments()[quantity]
        return float(np.log(moment * a ** (2 - quantity) / target))

    # Tension adds to force and depth, so the radius without it is an upper bound.
    high = np.log(classical_radius(indenter, quantity, target))
    above = excess(high)
    if above <= 0:
        return float(np.exp(high))
    low = high
    below = above
    while below > 0:
        high, low = low, low - max(below / 2, 0.1)
        below = excess(low)
    return float(np.exp(brentq(excess, low, high, xtol=1e-14, rtol=1e-14)))
