"""What a fit claims, against curves of known truth."""

from __future__ import annotations

from math import log
from typing import Any

import numpy as np
import pytest
from fit_ensemble import scores
from numpy.typing import NDArray
from scipy.optimize import minimize

import pellicle as pl
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, TENSION, Parameter
from pellicle_plugins.indenters.of_revolution import Cone, FlatPunch, Paraboloid, Sphere
from tests.plugins.fit.conftest import ends_of

pytestmark = pytest.mark.usefixtures("no_rivals")

Array = NDArray[np.float64]
MODULUS_TRUE, RADIUS = 5e3, 10e-6


def synthetic(
    ratio: float,
    *,
    points: int = 500,
    deepest: float = 0.3,
    before: float = 0.3,
    noise: float = 0.005,
    seed: int = 1,
) -> tuple[Array, Array]:
    """Return position and force under a paraboloid at s/R = ``ratio``, contact at 1 µm."""
    depth = np.linspace(-before, 1.0, points) * deepest * RADIUS
    indenter = Paraboloid(radius=RADIUS)
    assert isinstance(indenter, pl.HasForceCurve)
    force = MODULUS_TRUE * indenter.force_curve(depth, ratio * RADIUS).force
    errors = np.random.default_rng(seed).standard_normal(points)
    return depth + 1e-6, force + noise * force.max() * errors


def fitted(position: Array, force: Array, **options: Any) -> pl.Fit:
    """Return the fit of a curve that `synthetic` made."""
    return pl.fit(position, force, indenter="paraboloid", radius=RADIUS, **options)


@pytest.mark.slow
def test_errors_reach_the_bound_and_intervals_hold() -> None:
    """Over random curves errors are those of the Cramér–Rao bound, and 95 % means 95 %.

    A subset of tests/benchmarks/fit_ensemble.py, which has the real sample.
    """
    sample = list(scores(30, seed=5, points=600))
    for name in ("modulus", "tension"):
        error = np.sqrt(np.mean([getattr(score, name) ** 2 for score in sample]))
        # Three standard deviations of the rms of 30 normal numbers around 1.
        assert 0.6 < error < 1.4
    assert sum(score.covers_modulus for score in sample) >= 26
    assert sum(score.covers_tension for score in sample) >= 26


@pytest.mark.slow
def test_tension_is_not_claimed_where_there_is_none() -> None:
    """Without tension the interval reaches down to none, nearly always."""
    sample = list(scores(12, seed=6, points=400, tensed=False))
    assert sum(score.claims_tension for score in sample) <= 1
    assert all(score.covers_tension for score in sample if not score.claims_tension)


def test_interval_ends_are_where_the_profile_has_risen() -> None:
    """A minimiser of another kind finds χ² up by the stated rise at each end."""
    fit = fitted(*synthetic(0.3))
    others = {
        MODULUS: (CONTACT_POINT, TENSION),
        TENSION: (CONTACT_POINT, MODULUS),
        CONTACT_POINT: (MODULUS, TENSION),
    }
    ends = {
        MODULUS: tuple(map(log, ends_of(fit.reduced_modulus))),
        TENSION: ends_of(fit.tension),
        CONTACT_POINT: ends_of(fit.contact_point),
    }
    bound = fit.likelihood.deviations(fit.parameters)
    for which, free in others.items():
        for end in ends[which]:

            def chi_squared(
                u: Array,
                which: Parameter = which,
                free: tuple[Parameter, ...] = free,
                end: float = end,
            ) -> float:
                parameters = fit.parameters | {which: end}
                for parameter, change in zip(free, u, strict=True):
                    parameters[parameter] += change * bound[parameter]
                return fit.likelihood.chi_squared(parameters)

            least = minimize(chi_squared, [0.0, 0.0], method="Nelder-Mead", options={"xatol": 1e-3})
            assert least.fun - fit.chi_squared == pytest.approx(fit.rise, rel=0.02)


def test_interval_ends_of_a_cone_without_tension() -> None:
    """Where the best tension is 0 a cone cannot tell it from the contact point, but has intervals.

    The bounds are those without tension, so that no interval is narrower than its bound.
    """
    cone = pl.indenter("cone", half_angle="70 degree")
    assert isinstance(cone, pl.HasForceCurve)
    depth = np.linspace(-0.3e-6, 1e-6, 120)
    force = MODULUS_TRUE * cone.force_curve(depth, 0.0).force
    force += 0.01 * force.max() * np.random.default_rng(2).standard_normal(depth.size)
    fit = pl.fit(depth + 1e-6, force, indenter=cone)
    assert fit.tension.value == 0
    point, modulus = fit.contact_point, fit.reduced_modulus
    for estimate in (point, modulus):
        assert np.abs(np.array(ends_of(estimate)) - estimate.value).max() > estimate.bound
    assert fit.tension.bound == np.inf
    assert fit.tension.high is not None
    step = {CONTACT_POINT: 5e-9, MODULUS: 0.01, TENSION: fit.tension.high / 5}
    for which, end in (
        *((CONTACT_POINT, end) for end in ends_of(fit.contact_point)),
        (TENSION, fit.tension.high),
    ):
        free = [p for p in step if p != which]

        def chi_squared(
            u: Array, which: Parameter = which, free: list[Parameter] = free, end: float = end
        ) -> float:
            parameters = fit.parameters | {which: end}
            for parameter, change in zip(free, u, strict=True):
                parameters[parameter] += change * step[parameter]
            parameters[TENSION] = abs(parameters[TENSION])
            return fit.likelihood.chi_squared(parameters)

        least = minimize(chi_squared, [0.0, 0.0], method="Nelder-Mead", options={"xatol": 1e-4})
        assert least.fun - fit.chi_squared == pytest.approx(fit.rise, rel=0.02)


def test_exact_curves_give_the_truth() -> None:
    """Without noise all parameters come back, for every indenter whose shape tells them apart."""
    depth = np.linspace(-0.5e-6, 2e-6, 300)
    for indenter in (Paraboloid(radius=5e-6), Sphere(radius=5e-6), Cone(half_angle=1.2)):
        force = 8e3 * indenter.force_curve(depth, 0.7e-6).force
        fit = pl.fit(depth + 3e-6, force, indenter=indenter)
        assert fit.reduced_modulus.value == pytest.approx(8e3, rel=1e-4)
        assert fit.tension.value == pytest.approx(8e3 * 0.7e-6 / 2, rel=1e-4)
        assert fit.contact_point.value == pytest.approx(3e-6, abs=1e-10)


def test_fit_knows_no_units() -> None:
    """Lengths and forces in other measure give the same fit in that measure."""
    position, force = synthetic(0.2)
    fit = fitted(position, force)
    length, stress = 1e4, 30.0
    other = pl.fit(
        position * length,
        force * stress * length**2,
        indenter="paraboloid",
        radius=RADIUS * length,
    )
    for name, factor in (("reduced_modulus", stress), ("tension", stress * length)):
        one, two = getattr(fit, name), getattr(other, name)
        for end in ("value", "low", "high", "bound"):
            assert getattr(two, end) == pytest.approx(getattr(one, end) * factor, rel=2e-3)


def test_punch_cannot_tell_modulus_and_tension_apart() -> None:
    """A flat punch gives a straight line: one number for two parameters, and the fit says so."""
    depth = np.linspace(-0.5e-6, 2e-6, 300)
    punch = FlatPunch(radius=5e-6)
    force = 8e3 * punch.force_curve(depth, 2e-6).force
    force = force + 0.005 * force.max() * np.random.default_rng(3).standard_normal(300)
    fit = pl.fit(depth, force, indenter=punch)
    assert fit.tension.low is None
    assert fit.reduced_modulus.low is None
    assert any("cannot tell modulus and tension apart" in message for message in fit.messages)
    fixed = pl.fit(depth, force, indenter=punch, fix={"tension": 8e3 * 2e-6 / 2})
    assert fixed.reduced_modulus.value == pytest.approx(8e3, rel=0.01)


def test_a_fixed_tension_costs_no_parameter() -> None:
    """AIC falls by as much as χ²: nothing was fitted."""
    curve = synthetic(0.3, points=60)
    for tension in (0.0, 0.3 * RADIUS * MODULUS_TRUE / 2):
        gain = fitted(*curve, fix={"tension": tension}).to_dict()["without_tension"]
        assert gain["delta_aic"] == gain["delta_chi_squared"]
        assert (gain["delta_aic"] > 100) == (tension > 0)


def test_deep_curve_leaves_tension_open() -> None:
    """Where tension hardly counts, its interval reaches 0, and a shallower range is advised."""
    fit = fitted(*synthetic(0.003))
    assert fit.tension.low is None
    assert fit.tension.high is not None
    assert "does not show tension" in fit.comparison
    assert "shallower range" in fit.advice


def test_shallow_curve_leaves_modulus_open() -> None:
    """Where tension carries all, a modulus a hundred times less does as well."""
    fit = fitted(*synthetic(1.0, points=60, deepest=1e-3, noise=0.05))
    assert fit.reduced_modulus.low is None
    assert fit.tension.low is not None
    assert any("too shallow" in message for message in fit.messages)
    assert "deeper range" in fit.advice or "larger radius" in fit.advice


@pytest.mark.parametrize(("type_", "points", "size"), [("sphere", 96, 14), ("paraboloid", 64, 13)])
def test_curve_of_the_solver_is_recovered(type_: str, points: int, size: int) -> None:
    """What was pressed in on a grid, not by the master curve, is found within the intervals."""
    depth = np.linspace(0.1e-6, 1.5e-6, 15)
    run = pl.Run(
        grid={"points": points, "size": f"{size} um", "boundary": "free"},
        kernel={"type": "tensed_membrane", "reduced_modulus": 4e3, "tension": 4e-3},
        indenter={"type": type_, "radius": "5 um"},
        loading={"depth": depth.tolist()},
    )
    forces = pl.run(run, progress=False).dataset["force"].values
    position = np.concatenate([np.linspace(-0.5e-6, -0.01e-6, 60), np.repeat(depth, 20)])
    force = np.concatenate([np.zeros(60), np.repeat(forces, 20)])
    force = force + 0.005 * force.max() * np.random.default_rng(2).standard_normal(force.size)
    fit = pl.fit(position, force, indenter=type_, radius="5 um")
    for estimate, truth in ((fit.reduced_modulus, 4e3), (fit.tension, 4e-3)):
        low, high = ends_of(estimate)
        assert low <= truth <= high < 1.5 * low
