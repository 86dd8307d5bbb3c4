"""Solids that drain in fits: limits, scales, the kernel as the reference, and what fits tell."""

from functools import partial
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle_fit.contact.curve import Curve
from pellicle_fit.effect import Effect, Solid
from pellicle_fit.explanation import Explanation
from tests import draining_gels
from tests.draining_gels import DEPTH, MODULUS, RADIUS, Gel, measured, path_of

ROWS = 40
solved = partial(draining_gels.solved, points=48, rows=ROWS)
predicted = partial(draining_gels.predicted, rows=ROWS)
GEL = Gel(0.1, 0.3)


@pytest.mark.parametrize("surface", ["open", "sealed"])
@pytest.mark.parametrize("ratio", [0.0, 0.3])
def test_limits(ratio: float, surface: str) -> None:
    """A solid that has no time to drain is incompressible, one that has drained is elastic."""
    hertz = 4 / 3 * MODULUS * np.sqrt(RADIUS) * path_of(ROWS)[1] ** 1.5
    for gel, over in (
        (Gel(ratio, 1e9, surface), 1.0),
        (Gel(ratio, 1e-12, surface), 2 * (1 - ratio)),
        (Gel(0.5, 1.0, surface), 1.0),
    ):
        np.testing.assert_allclose(predicted(gel), over * hertz, rtol=1e-3)


def test_one_speed_looks_elastic() -> None:
    """A round contact that grows at one speed drains by the same part at each size."""
    share = predicted(Gel(0.2, 0.3))[: ROWS - 1] / path_of(ROWS)[1][: ROWS - 1] ** 1.5
    np.testing.assert_allclose(share, share[-1], rtol=2e-3)


@pytest.mark.parametrize("length", [0.0, 1.0])
def test_times_go_as_areas(length: float) -> None:
    """Of all lengths three times as large, times are nine times as long, also under a tension."""
    gel = Gel(0.2, 0.3, length=length)
    np.testing.assert_allclose(predicted(gel, size=3.0), 9 * predicted(gel), rtol=1e-6)


# The first contacts under a tension have few cells.
@pytest.mark.filterwarnings("ignore:step.*cells:pellicle.errors.ConvergenceWarning")
@pytest.mark.parametrize("surface", ["open", "sealed"])
@pytest.mark.parametrize("length", [0.0, 1.0])
def test_kernel(length: float, surface: str) -> None:
    """Forces are those of the kernel, which knows the whole surface at all times."""
    gel = Gel(0.1, 0.3, surface, length)
    known = solved(gel)[2]
    assert np.abs(predicted(gel) - known)[3:].max() < 0.01 * known.max()


def holds(estimate: pl.Estimate, value: float) -> bool:
    """Return whether an interval holds a value."""
    return (estimate.low or 0) < value < (estimate.high or np.inf)


def test_hold_tells() -> None:
    """An approach has the modulus of its speed; with its hold it is that of the drained solid."""
    bead: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS}
    position, noisy, time = measured(solved(GEL), np.random.default_rng(1), 0.005, holds=True)
    fit = pl.fit(position, noisy, time=time, segment="both", rivals=["poroelastic"], **bead)
    found = fit.answer.selected.estimates
    assert fit.answer.selected.types == {"poroelastic"}
    assert "at this speed" not in str(fit)
    assert holds(fit.reduced_modulus, MODULUS)
    assert holds(found["diffusivity"], GEL.diffusivity)
    assert found["drained_ratio"].value == pytest.approx(0.1, abs=0.02)
    ramp = time <= 1
    alone = pl.fit(position[ramp], noisy[ramp], time=time[ramp], rivals=["poroelastic"], **bead)
    assert "at this speed" in str(alone)
    assert not holds(alone.reduced_modulus, 1.2 * MODULUS)
    assert alone.reduced_modulus.value > 1.2 * MODULUS


def test_pool_that_shows_no_draining_has_the_modulus_of_its_speeds() -> None:
    """What has drained as it was pressed, or not yet, looks elastic at any radius."""
    curves, radii = {}, [RADIUS, RADIUS / 4]
    for i, radius in enumerate(radii):
        depth = np.linspace(-0.5, 1, 90) * radius / 10
        force = 4 / 3 * MODULUS * np.sqrt(radius) * np.maximum(depth, 0) ** 1.5
        noise = np.random.default_rng(i).normal(scale=0.01 * force.max(), size=90)
        curves[str(i)] = depth, force + noise, np.linspace(0, 1, 90)
    fit = pl.fit_pooled(curves, indenter="paraboloid", radius=radii, rivals=["poroelastic"])
    assert fit.answer.selected.types == set()
    assert "at these speeds" in str(fit)


@pytest.mark.slow
@pytest.mark.parametrize("pool", ["radii", "speeds"])
def test_pools_tell(pool: str) -> None:
    """Two radii, and two speeds, tell draining from all other rivals, and hold the modulus."""
    other = {"radii": {"radius": RADIUS / 4}, "speeds": {"seconds": 10.0}}[pool]
    curves = {}
    for i, path in enumerate((solved(GEL), solved(GEL, **other))):
        curves[str(i)] = measured(path, np.random.default_rng(i), 0.005, holds=False)
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
