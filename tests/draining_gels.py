"""Gels that drain under a paraboloid: forces of the kernel, those of the effect, and with noise."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

import pellicle as pl
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Effect, Solid
from pellicle_fit.explanation import Explanation
from tests.tables_of_runs import coated, paraboloid, pressing, steps

Array = Any
RADIUS, DEPTH, MODULUS, ROWS = 5e-6, 8e-7, 1e4, 350


class Gel(NamedTuple):
    """A gel, with lengths over those of the contact at the end of the ramp."""

    ratio: float
    """ν."""
    drains: float
    """D T / (R δ) of a ramp of 1 s."""
    surface: str = "open"
    length: float = 0.0
    """s/a."""

    @property
    def diffusivity(self) -> float:
        """D [m²/s]."""
        return self.drains * RADIUS * DEPTH

    @property
    def tension(self) -> float:
        """τ₀ [N/m]."""
        return self.length * float(np.sqrt(RADIUS * DEPTH)) * MODULUS / 2


def path_of(rows: int = 60) -> tuple[Array, Array]:
    """Return time [s] and depth [m] of a ramp of 1 s, and of a hold of 3 s in half as many rows."""
    hold = 1 + np.geomspace(0.6 / rows, 3, rows // 2)
    time = np.append(np.linspace(0, 1, rows + 1)[1:], hold)
    return time, DEPTH * np.minimum(time, 1)


@cache
def solved(
    gel: Gel, seconds: float = 1.0, radius: float = RADIUS, points: int = 64, rows: int = 60
) -> Array:
    """Return time [s], depth [m] and force [N] of the kernel, on a ramp of so many seconds."""
    time, depth = path_of(rows)
    shear = MODULUS * (1 - gel.ratio) / 2
    solid: dict[str, Any] = {"type": "poroelastic", "shear_modulus": shear, "surface": gel.surface}
    solid |= {"poissons_ratio": gel.ratio, "diffusivity": gel.diffusivity}
    size, path = 3.1 * float(np.sqrt(radius * DEPTH)), (seconds * time).tolist()
    skin = coated(solid, gel.tension)
    run = pressing(points, size, skin, paraboloid(radius), depth=depth.tolist(), time=path)
    force = steps(tolerance=1e-6, converged=False, **run).force.values
    return np.array([seconds * time, depth, force])


def predicted(gel: Gel, rows: int = 60, size: float = 1.0) -> Array:
    """Return the force [N] of the effect along a path, with all lengths times a size."""
    values = {"drained_ratio": gel.ratio, "surface": gel.surface}
    values["diffusivity"] = size**2 * gel.diffusivity
    tables: list[dict[str, Any]] = [{"type": "poroelastic", **values}]
    tables += [{"type": "tension", "tension": size * gel.tension}] if gel.tension else []
    time, depth = path_of(rows)
    position, clock = size * np.append(-1e-3 * DEPTH, depth), np.append(-1e-3, time)
    bead: Any = pl.indenter("paraboloid", radius=size * RADIUS)
    unread: Any = np.arange(position.size) * 1.0
    curve = Curve(position, unread, bead, clock, np.zeros(position.size, bool))
    solid = Solid(reduced_modulus=MODULUS, contact_point=0.0)
    effects = tuple(pl.registry().make(Effect, table) for table in tables)
    return Explanation(solid, effects).force(curve)[1:]


def measured(
    path: Array, random: np.random.Generator, noise: float, *, holds: bool
) -> tuple[Array, Array, Array]:
    """Return position [m], force [N] with noise of a share of the largest, and time [s]."""
    known, deep, force = path
    seconds = known[np.argmax(deep)]
    time = np.linspace(-0.3, 1, ROWS) * seconds
    if holds:
        time = np.append(time, np.linspace(1, 4, ROWS + 1)[1:] * seconds)
    depth = DEPTH * np.minimum(time / seconds, 1)
    # The force over that of Hertz has no kink at first touch.
    over = np.interp(np.log(np.maximum(time, 1e-6 * seconds)), np.log(known), force / deep**1.5)
    exact = over * np.maximum(depth, 0) ** 1.5
    return depth + 1e-6, exact + noise * exact.max() * random.standard_normal(time.size), time
