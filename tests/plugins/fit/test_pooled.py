"""One modulus and one tension of several curves."""

import json
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle_fit.words.story import story
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.plugins.fit.conftest import holds

pytestmark = pytest.mark.usefixtures("no_rivals")

TRUE_MODULUS, TRUE_TENSION = 2e3, 5e-3
RADII = (5e-6, 40e-6)


def curve(
    radius: float, random: np.random.Generator, *, modulus: float = TRUE_MODULUS, points: int = 150
) -> tuple[Array, Array, float]:
    """Return position, force and contact point under a paraboloid."""
    depth = np.linspace(-0.3, 1.0, points) * 0.3 * radius
    force = modulus * Paraboloid(radius=radius).force_curve(depth, 2 * TRUE_TENSION / modulus).force
    point = random.uniform(-1, 1) * radius
    return depth + point, force + 0.01 * force.max() * random.standard_normal(points), point


def pooled(curves: dict[str, tuple[Array, Array]], **options: Any) -> pl.Fit:
    """Return the pooled fit of a curve for each radius."""
    options.setdefault("radius", list(RADII[: len(curves)]))
    return pl.fit_pooled(curves, indenter="paraboloid", **options)


@pytest.fixture(scope="module")
def measured() -> dict[str, tuple[Array, Array]]:
    """Return a curve for each radius."""
    random = np.random.default_rng(1)
    return {f"{1e6 * radius:.0f} um": curve(radius, random)[:2] for radius in RADII}


def test_pool_of_the_same_curve_twice(measured: dict[str, tuple[Array, Array]]) -> None:
    """Twice the same curve gives its fit, with intervals √2 narrower."""
    position, force = measured["5 um"]
    one = pl.fit(position, force, indenter="paraboloid", radius=RADII[0])
    two = pooled({"a": (position, force), "b": (position + 1e-6, force)}, radius=RADII[0])
    for name in ("reduced_modulus", "tension"):
        single, double = getattr(one, name), getattr(two, name)
        assert double.value == pytest.approx(single.value, rel=1e-4)
        ratio = (single.high - single.low) / (double.high - double.low)
        assert ratio == pytest.approx(
            np.sqrt(2 * one.answer.threshold / two.answer.threshold), 0.02
        )
    points = two.estimates()["contact_point"], two.estimates()["contact_point_1"]
    assert points[1].value - points[0].value == pytest.approx(1e-6, rel=1e-3)


def test_what_is_said(measured: dict[str, tuple[Array, Array]]) -> None:
    """Tension is needed, the curves agree, and each has its own contact point and noise."""
    fit = pooled(measured)
    assert fit.tension_needed
    assert fit.agreement.startswith("the curves agree")
    assert story(fit)[0].endswith("; calibration taken as exact")
    content = json.loads(fit.to_json())
    small, large = content["curves"]
    assert (small["name"], large["name"]) == tuple(measured)
    assert large["noise"]["value"] > 10 * small["noise"]["value"]
    assert small["contact_point"]["unit"] == "m"
    assert [entry["indenter"]["radius"] for entry in (small, large)] == list(RADII)
    # Without times all curves have one speed, not one duration.
    fast, slow = (curve.velocity.mean() for curve in fit.answer.selected.all_rows)
    assert fast == pytest.approx(slow, rel=0.01)


@pytest.mark.slow
def test_hertz_and_baseline(measured: dict[str, tuple[Array, Array]]) -> None:
    """A tension that is held is held for all; each curve has its own baseline."""
    position, force = measured["40 um"]
    drift = 1e-9 + 1e-4 * (position - position[0])
    fit = pooled({**measured, "40 um": (position, force + drift)}, baseline="slope")
    assert holds(fit.reduced_modulus, TRUE_MODULUS)
    estimates = fit.estimates()
    assert abs(estimates["slope"].value) < 0.3 * estimates["slope_1"].value
    fixed = pooled(measured, fix={"tension": "5 mN/m"})
    assert fixed.tension.held
    assert fixed.reduced_modulus.value == pytest.approx(TRUE_MODULUS, rel=0.02)


def test_one_bead_has_one_size(measured: dict[str, tuple[Array, Array]]) -> None:
    """Two curves of a bead share its size, whether they agree or not."""
    size = {"type": "size", "size_error": {"value": 0, "deviation": 0.05}}
    curves = {"a": measured["5 um"], "b": measured["5 um"]}
    fit = pooled(curves, radius=RADII[0], model=["tension", size], fix={"tension": TRUE_TENSION})
    assert fit.agreement.startswith("the curves agree")
    assert abs(fit.estimates()["size_error"].value) < 0.05


@pytest.mark.slow
def test_weighed_radii(measured: dict[str, tuple[Array, Array]]) -> None:
    """Radii that are off are held by their uncertainty, each bead's its own."""
    wrong = [1.06 * RADII[0], 0.95 * RADII[1]]
    exact = pooled(measured, radius=wrong)
    weighed = pooled(measured, radius=wrong, uncertainty={"radius": "6 %"})
    assert not holds(exact.tension, TRUE_TENSION) or not holds(exact.reduced_modulus, TRUE_MODULUS)
    assert holds(weighed.reduced_modulus, TRUE_MODULUS)
    assert holds(weighed.tension, TRUE_TENSION)
    assert weighed.chi_squared == exact.chi_squared
