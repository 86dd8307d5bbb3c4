"""Force and depth of any body of revolution, from the pressures of flat punches.

Let φ(x) be the transform of the pressure under a flat punch of radius a at a depth of 1, the
solution of ∫ φ(x′) K(x − x′) dx′ = 1 on [−a, a] (``equation``).  Since K is symmetric, the contact
of radius a of a body with the transform h has the force

    F = kδ − I,  k = 2πE* ∫₀^a φ dx,  I = 2πE* ∫₀^a φ h dx,

by Betti's theorem (Shield 1967), whatever its depth δ.  Its pressure ends without a singularity
where that force is greatest (Barber 1974), so that, with ′ = ∂/∂a at a given s,

    δ = I′/k′,  dF/dδ = k.

k and the shape of φ, over s/a and η = arccos(x/a), come from a table: the shape is a sum of some
twenty products of a function of each, a singular value decomposition of solutions
(``docs/reference-data/curve_tables.py``).  Force and depth have relative errors below 2e-9.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.components import HasAbelSlope

from .equation import kinks_of
from .splines import Interpolant, stretched_spline, table_in

LENGTH_SCALE = 1e-8
LENGTHS: Array = LENGTH_SCALE * np.expm1(np.linspace(0.0, np.log1p(1e8 / LENGTH_SCALE), 245))
"""Nodes s/a of the table."""
ANGLE_SCALE = 1e-5
ANGLES: Array = np.minimum(
    ANGLE_SCALE * np.expm1(np.linspace(0.0, np.log1p(np.pi / 2 / ANGLE_SCALE), 201)), np.pi / 2
)
"""Nodes η of the table."""
FILE = Path(__file__).with_name("punches.npz")
_STEPS = 0.06 * np.arange(-60, 61)
"""Nodes of the quadrature before its substitution."""


class Contacts(NamedTuple):
    """Contacts of given radii without adhesion, each of shape (n,)."""

    depth: Array
    """δ [m]."""
    force: Array
    """F/E* [m²]."""
    stiffness: Array
    """k/E* = dF/dδ / E* [m], of the flat punch of the same radius."""
    stiffness_slope: Array
    """dk/da over E*."""
    force_by_length: Array
    """∂(F/E*)/∂s at a given depth [m]."""


def contacts(body: HasAbelSlope, radius: Array, length: float) -> Contacts:
    """Return the contacts of radii [m], of shape (n,), for s = ``length`` [m]."""
    integral, slope = _moments(body, radius.tobytes())
    ratio = length / radius
    values, rates = _over_lengths(with_shares=True)(ratio)
    stiffness = 2 * np.exp(values[:, 0])
    rate = stiffness * rates[:, 0]
    shares, by_ratio = values[:, 1:], rates[:, 1:] + rates[:, :1] * values[:, 1:]
    integral_rate = stiffness * np.sum(by_ratio * integral, axis=1) / radius
    stiffness_slope = stiffness - ratio * rate
    by_radius = stiffness * np.sum(shares * slope, axis=1) - ratio * integral_rate
    depth = by_radius / stiffness_slope
    force = radius * stiffness * depth - stiffness * np.sum(shares * integral, axis=1)
    by_length = rate * depth - integral_rate
    return Contacts(depth, force, radius * stiffness, stiffness_slope, by_length)


def punch_stiffness(ratio: Array) -> tuple[Array, Array]:
    """Return log(k/2E*a) of flat punches at s/a = ratio, of shape (n,), and its derivative."""
    return _over_lengths(with_shares=False)(ratio)


def punch_slope(ratio: Array) -> Array:
    """Return dk/da over E* of flat punches at s/a = ratio, of shape (n,)."""
    log, rate = punch_stiffness(ratio)
    return np.asarray(2 * np.exp(log) * (1 - ratio * rate))


@cache
def _over_lengths(*, with_shares: bool) -> Interpolant:
    """Return the interpolant over s/a of log(k/2E*a), alone or with the shares of the modes."""
    columns = table_in(FILE)["shares"]
    return stretched_spline(LENGTHS, columns if with_shares else columns[:, 0], LENGTH_SCALE)


@cache
def _modes() -> Interpolant:
    """Return the interpolant over η of the modes of φ sin η / k."""
    return stretched_spline(ANGLES, table_in(FILE)["modes"], ANGLE_SCALE)


# Those of one body serve at each tension.
@lru_cache(maxsize=256)
def _moments(body: HasAbelSlope, radii: bytes) -> tuple[Array, Array]:
    """Return 2π ∫ mode h dx and 2π ∫ mode (h + x h′) dx/a over (0, a), of shape (n, modes)."""
    radius = np.frombuffer(radii)
    ends = [np.zeros_like(radius)]
    kinks = kinks_of(body)
    for kink in kinks:
        share = np.minimum(kink / radius, 1.0)
        ends.append(np.arctan2(share, np.sqrt((1 - share) * (1 + share))))
    ends.append(np.full_like(radius, np.pi / 2))
    integral, slope = 0.0, 0.0
    left, right, weight = _rule()
    for low, high in pairwise(ends):
        span = (high - low)[:, None]
        # Exact at both ends: η from the rim, ψ = π/2 − η from the axis.
        eta, psi = (np.pi / 2 - high)[:, None] + span * right, low[:, None] + span * left
        x = radius[:, None] * np.sin(psi)
        h = transform(body, x)
        # Without kinks all radii have the same nodes.
        modes = _modes()(eta.ravel() if kinks else eta[0])[0]
        if kinks:
            modes = modes.reshape(*eta.shape, -1)
        part = "anm" if kinks else "nm"
        values = span * weight * h, span * weight * (h + x * body.abel_slope(x))
        zeroth, first = (np.einsum(f"an,{part}->am", value, modes) for value in values)
        integral, slope = integral + zeroth, slope + first
    return 2 * np.pi * radius[:, None] * integral, 2 * np.pi * np.asarray(slope)


def transform(body: HasAbelSlope, x: Array) -> Array:
    """Return h(x) [m] at positions [m] of any shape."""
    own: Callable[[Array], Array] | None = getattr(body, "abel_transform", None)
    if own is not None:
        return own(x)
    left, _, weight = _rule()
    slopes = body.abel_slope(np.multiply.outer(x, left))
    return np.asarray(x * (slopes @ weight))


@cache
def _rule() -> tuple[Array, Array, Array]:
    """Return nodes in (0, 1), their distances to 1, and weights (Takahasi & Mori 1974).

    Singularities at either end do not matter to this double exponential rule.
    """
    reach = np.pi / 2 * np.sinh(_STEPS)
    weight = (_STEPS[1] - _STEPS[0]) * np.pi / 4 * np.cosh(_STEPS) / np.cosh(reach) ** 2
    return 1 / (1 + np.exp(-2 * reach)), 1 / (1 + np.exp(2 * reach)), weight
