"""Solids that drain in fits: limits, scales, the kernel as the reference, and what fits tell."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Effect, Solid
from pellicle_fit.explanation import Explanation

RADIUS, DEPTH, MODULUS = 5e-6, 8e-7, 1e4
HELD, HERTZ = 4.0, 4 / 3 * MODULUS * np.sqrt(RADIUS) * DEPTH**1.5
"""Time after first touch, of which the ramp takes 1 s [s]; the force of the drained solid [N]."""


def rows(holds: float = HELD - 1) -> tuple[Any, Any]:
    """Return times [s] and depths [m] of a ramp, and of a hold."""
    time = np.append(np.linspace(0, 1, 41)[1:], 1 + np.geomspace(0.02, holds, 20))
    return time, DEPTH * np.minimum(time, 1)


def force(
    ratio: float, drains: float, tension: float = 0.0, surface: str = "open", size: float = 1.0
) -> Any:
    """Return the force [N] of the effect where D T = drains · R δ, lengths times a size."""
    tables: list[dict[str, Any]] = [{"type": "poroelastic", "drained_ratio": ratio}]
    tables[0] |= {"diffusivity": size**2 * drains * RADIUS * DEPTH, "surface": surface}
    tables += [{"type": "tension", "tension": tension}] if tension else []
    effects = tuple(pl.registry().make(Effect, table) for table in tables)
    time, depth = rows()
    position, clock = size * np.append(-1e-3 * DEPTH, depth), np.append(-1e-3, time)
    bead: Any = pl.indenter("paraboloid", radius=size * RADIUS)
    unread: Any = np.arange(position.size) * 1.0
    curve = Curve(position, unread, bead, clock, np.zeros(position.size, bool))
    solid = Solid(reduced_modulus=MODULUS, contact_point=0.0)
    return Explanation(solid, effects).force(curve)[1:]


@cache
def solved(
    ratio: float,
    drains: float,
    tension: float = 0.0,
    surface: str = "open",
    seconds: float = 1.0,
    radius: float = RADIUS,
) -> Any:
    """Return times [s], depths [m] and forces [N] of the kernel."""
    time, depth = rows()
    kernel: dict[str, Any] = {"type": "poroelastic", "surface": surface, "poissons_ratio": ratio}
    kernel |= {"shear_modulus": MODULUS * (1 - ratio) / 2, "diffusivity": drains * RADIUS * DEPTH}
    if tension:
        kernel = {"type": "coated", "tension": tension, "substrate": kernel}
    run = {
        "grid": {"points": 48, "size": 3.0 * float(np.sqrt(radius * DEPTH))},
        "kernel": kernel,
        "indenter": {"type": "paraboloid", "radius": radius},
        "loading": {"depth": depth.tolist(), "time": (seconds * time).tolist()},
    }
    return seconds * time, depth, pl.run(run, progress=False).dataset.force.values


@pytest.mark.parametrize("surface", ["open", "sealed"])
@pytest.mark.parametrize("ratio", [0.0, 0.3])
def test_limits(ratio: float, surface: str) -> None:
    """A solid that has no time to drain is incompressible, one that has drained is elastic."""
    elastic = HERTZ * (rows()[1] / DEPTH) ** 1.5
    slow = force(ratio, 1e9, surface=surface)
    fast = force(ratio, 1e-12, surface=surface)
    np.testing.assert_allclose(slow, elastic, rtol=1e-3)
    np.testing.assert_allclose(fast, 2 * (1 - ratio) * elastic, rtol=1e-3)
    np.testing.assert_allclose(force(0.5, 1.0, surface=surface), elastic, rtol=1e-3)


def test_one_speed_looks_elastic() -> None:
    """A round contact that grows at one speed drains by the same part at each size."""
    ramp = rows()[1] < DEPTH
    share = force(0.2, 0.3)[ramp] / rows()[1][ramp] ** 1.5
    np.testing.assert_allclose(share, share[-1], rtol=2e-3)


def test_times_go_as_areas() -> None:
    """Of all lengths three times as large, times are nine times as long, also under a tension."""
    np.testing.assert_allclose(force(0.2, 0.3, size=3.0), 9 * force(0.2, 0.3), rtol=1e-6)
    np.testing.assert_allclose(
        force(0.2, 0.3, tension=3e-2, size=3.0), 9 * force(0.2, 0.3, tension=1e-2), rtol=1e-6
    )


# The first contacts under a tension have few cells.
@pytest.mark.filterwarnings("ignore:step.*cells:pellicle.errors.ConvergenceWarning")
@pytest.mark.parametrize("surface", ["open", "sealed"])
@pytest.mark.parametrize(("tension", "error"), [(0.0, 0.01), (1e-2, 0.03)])
def test_kernel(tension: float, error: float, surface: str) -> None:
    """Forces are those of the kernel, which knows the whole surface at all times."""
    known = solved(0.1, 0.3, tension, surface)[2]
    assert np.abs(force(0.1, 0.3, tension, surface) - known)[3:].max() < error * known.max()


def measured(path: Any, seed: int, *, holds: bool) -> tuple[Any, Any, Any]:
    """Return position [m], force [N] and time [s] of a path of the kernel, with noise of 0.5 %."""
    known, deep, exact = path
    seconds = known[39]
    time = np.linspace(-0.3, HELD if holds else 1.0, 400) * seconds
    depth = DEPTH * np.minimum(time / seconds, 1)
    # The force over that of Hertz has no kink at first touch.
    over = np.interp(np.log(np.maximum(time, 1e-6 * seconds)), np.log(known), exact / deep**1.5)
    clean = over * np.maximum(depth, 0) ** 1.5
    noise = 0.005 * clean.max() * np.random.default_rng(seed).standard_normal(time.size)
    return depth + 1e-6, clean + noise, time


def holds(estimate: pl.Estimate, value: float) -> bool:
    """Return whether an interval holds a value."""
    return (estimate.low or 0) < value < (estimate.high or np.inf)


def test_hold_tells() -> None:
    """An approach has the modulus of its speed; with its hold it is that of the drained solid."""
    bead: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS}
    position, noisy, time = measured(solved(0.1, 0.3), 1, holds=True)
    fit = pl.fit(position, noisy, time=time, segment="both", rivals=["poroelastic"], **bead)
    found = fit.answer.selected.estimates
    assert fit.answer.selected.types == {"poroelastic"}
    assert "at this speed" not in str(fit)
    assert holds(fit.reduced_modulus, MODULUS)
    assert holds(found["diffusivity"], 0.3 * RADIUS * DEPTH)
    assert found["drained_ratio"].value == pytest.approx(0.1, abs=0.02)
    ramp = time <= 1
    alone = pl.fit(position[ramp], noisy[ramp], time=time[ramp], rivals=["poroelastic"], **bead)
    assert "at this speed" in str(alone)
    assert not holds(alone.reduced_modulus, 1.2 * MODULUS)
    assert alone.reduced_modulus.value > 1.2 * MODULUS


@pytest.mark.slow
@pytest.mark.parametrize("pool", ["radii", "speeds"])
def test_pools_tell(pool: str) -> None:
    """Two radii, and two speeds, tell draining from all other rivals, and hold the modulus."""
    other = {"radii": {"radius": RADIUS / 4}, "speeds": {"seconds": 10.0}}[pool]
    paths = solved(0.1, 0.3), solved(0.1, 0.3, **other)
    curves = {str(i): measured(path, i, holds=False) for i, path in enumerate(paths)}
    radii = [RADIUS, other.get("radius", RADIUS)]
    fit = pl.fit_pooled(curves, indenter="paraboloid", radius=radii)
    assert fit.answer.selected.types == {"poroelastic"}
    assert holds(fit.reduced_modulus, MODULUS)


def test_draining_that_ties_with_relaxation_asks_for_another_radius() -> None:
    """Times of draining go as a², those of relaxation do not; of a retraction nothing is known."""
    time = np.linspace(-0.3, 1.5, 400)
    depth = DEPTH * np.minimum(time, 1)
    bead: Any = pl.indenter("paraboloid", radius=RADIUS)
    gel = pl.registry().make(
        Effect, {"type": "poroelastic", "drained_ratio": 0.2, "diffusivity": 2e-11}
    )
    curve = Curve(depth, depth, bead, time, np.zeros(400, bool))
    pushes = Explanation(Solid(reduced_modulus=MODULUS, contact_point=0.0), (gel,)).force(curve)
    noise = 0.03 * pushes.max() * np.random.default_rng(1).standard_normal(400)
    found = pl.fit(depth, pushes + noise, time=time, indenter=bead, segment="approach+hold")
    assert {"poroelastic"} in [fit.types for fit in found.answer.tied]
    (step,) = found.steps
    assert step["kind"] == "measure_radius"
