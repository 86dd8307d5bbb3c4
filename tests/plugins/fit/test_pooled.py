"""One modulus and one tension of several curves."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from math import log
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import Result
from numpy.typing import NDArray

import pellicle as pl
from pellicle_fit.models import simulation
from pellicle_fit.models.force_model import tension_model
from pellicle_fit.models.interpolated import SimulatedCurve
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION, Coordinates
from pellicle_fit.report.page import save_report
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.pooled_likelihood import Pool
from pellicle_fit.statistics.profile import widen
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.pictures import drawn_width
from tests.plugins.fit.conftest import ends_of, holds

pytestmark = pytest.mark.usefixtures("no_rivals")

Array = NDArray[np.float64]
TRUE_MODULUS, TRUE_TENSION = 2e3, 5e-3
RADII = (5e-6, 40e-6)
FREE = (CONTACT_POINT, MODULUS, TENSION)


def curve(
    radius: float, random: np.random.Generator, *, modulus: float = TRUE_MODULUS, points: int = 150
) -> tuple[Array, Array, float, float]:
    """Return position, force, contact point and noise under a paraboloid."""
    depth = np.linspace(-0.3, 1.0, points) * 0.3 * radius
    bead = Paraboloid(radius=radius)
    force = modulus * bead.force_curve(depth, 2 * TRUE_TENSION / modulus).force
    noise = 0.01 * float(force.max())
    point = random.uniform(-1, 1) * radius
    return depth + point, force + noise * random.standard_normal(points), point, noise


def truth(point: float) -> Coordinates:
    """Return the coordinates that `curve` has."""
    shared = {MODULUS: float(np.log(TRUE_MODULUS)), TENSION: TRUE_TENSION}
    return {CONTACT_POINT: point, **shared, OFFSET: 0.0, SLOPE: 0.0}


def pooled(curves: dict[str, tuple[Array, Array]], **options: Any) -> pl.PooledFit:
    """Return the pooled fit of a curve for each radius."""
    radii = list(RADII[: len(curves)])
    return pl.fit_pooled(curves, indenter="paraboloid", radius=radii, **options)


@pytest.fixture(scope="module")
def measured() -> dict[str, tuple[Array, Array]]:
    """Return a curve for each radius."""
    random = np.random.default_rng(1)
    return {f"{1e6 * radius:.0f} um": curve(radius, random)[:2] for radius in RADII}


@pytest.fixture(scope="module")
def fit(measured: dict[str, tuple[Array, Array]]) -> pl.PooledFit:
    """Return their pooled fit."""
    return pooled(measured, contact_points=True)


@pytest.mark.slow
def test_errors_reach_the_pooled_bound_and_intervals_shrink_to_it() -> None:
    """Over random curves errors and intervals are those of the Cramér–Rao bound of the pool."""
    random = np.random.default_rng(8)
    errors, covered, widths, gains, touched = [], [], [], [], []
    for _ in range(10):
        samples = [curve(radius, random, points=100) for radius in RADII]
        curves = {str(number): sample[:2] for number, sample in enumerate(samples)}
        pooled_fit = pooled(curves, contact_points=True)
        members = [
            Likelihood(z, f, tension_model(Paraboloid(radius=radius)), noise, FREE)
            for (z, f, _, noise), radius in zip(samples, RADII, strict=True)
        ]
        parts = [truth(point) for _, _, point, _ in samples]
        pool = Pool.of(members)
        bound = pool.deviations(pool.joined(parts))
        alone = [m.deviations(part) for m, part in zip(members, parts, strict=True)]
        for which, estimate, true in (
            (MODULUS, pooled_fit.reduced_modulus, TRUE_MODULUS),
            (TENSION, pooled_fit.tension, TRUE_TENSION),
        ):
            low, high = ends_of(estimate)
            deviation = bound[which] * (TRUE_MODULUS if which == MODULUS else 1)
            errors.append((estimate.value - true) / deviation)
            covered.append(low < true < high)
            widths.append((high - low) / 2 / deviation)
            gains.append(min(sample[which] for sample in alone) / bound[which])
        for own, (_, _, point, _) in zip(pooled_fit.curves, samples, strict=True):
            touched.append(holds(own.contact_point, point))
    # Three standard deviations of the rms of 20 normal numbers, half of them independent.
    assert 0.4 < np.sqrt(np.mean(np.square(errors))) < 1.6
    assert sum(covered) >= 16
    assert sum(touched) >= 16
    # 1.96, but for the noise that is estimated from 23 points of each curve.
    assert np.mean(widths) == pytest.approx(2.0, rel=0.1)
    # The two radii tell far more than either alone.
    assert min(gains) > 2


def test_pool_of_the_same_curve_twice(measured: dict[str, tuple[Array, Array]]) -> None:
    """Twice the same curve gives its fit, with intervals √2 narrower."""
    position, force = measured["5 um"]
    one = pl.fit(position, force, indenter="paraboloid", radius=RADII[0])
    two = pl.fit_pooled(
        {"a": (position, force), "b": (position + 1e-6, force)},
        indenter="paraboloid",
        radius=RADII[0],
    )
    for name in ("reduced_modulus", "tension"):
        single, double = getattr(one, name), getattr(two, name)
        assert double.value == pytest.approx(single.value, rel=1e-5)
        assert double.bound == pytest.approx(single.bound / np.sqrt(2), rel=1e-4)
        ratio = (single.high - single.low) / (double.high - double.low)
        assert ratio == pytest.approx(np.sqrt(2 * one.rise / two.rise), rel=0.02)
    points = [curve.contact_point.value for curve in two.curves]
    assert points[1] - points[0] == pytest.approx(1e-6, rel=1e-4)


@pytest.mark.slow
def test_ends_are_where_the_profile_has_risen(fit: pl.PooledFit) -> None:
    """At each end the least χ² is up by the stated rise, and no start finds less."""
    random = np.random.default_rng(3)
    bound = fit.pool.deviations(fit.parameters)
    points = [curve.contact_point for curve in fit.curves]
    for which, ends in (
        (MODULUS, tuple(map(log, ends_of(fit.reduced_modulus)))),
        (TENSION, ends_of(fit.tension)),
        *((CONTACT_POINT.of_curve(at), ends_of(point)) for at, point in enumerate(points)),
    ):
        for end in ends:
            start = {
                p: value + 2 * bound[p] * random.standard_normal()
                for p, value in fit.parameters.items()
            } | {which: end}
            least = fit.pool.minimise(start, (which,)).chi_squared
            assert least - fit.chi_squared == pytest.approx(fit.rise, rel=0.02)


def test_contact_points_are_sought_if_asked(measured: dict[str, tuple[Array, Array]]) -> None:
    """Without that they have a bound and no ends; those that are held have both."""
    common: dict[str, Any] = {
        "indenter": "paraboloid",
        "radius": list(RADII),
        "fix": {"tension": TRUE_TENSION},
    }
    plain = pl.fit_pooled(measured, **common)
    assert plain.curves[0].contact_point.low is None
    assert plain.curves[0].contact_point.bound > 0
    with_points = pl.fit_pooled(measured, contact_points=True, **common)
    for curve in with_points.curves:
        point = curve.contact_point
        # √rise standard deviations, where the noise is known from as few points as here.
        width = np.ptp(ends_of(point)) / 2 / point.bound
        assert width == pytest.approx(np.sqrt(with_points.rise), rel=0.05)


@pytest.mark.slow
def test_what_is_said(fit: pl.PooledFit) -> None:
    """Tension is needed, the curves agree, and each has its own contact point and noise."""
    assert "tension is needed" in fit.comparison
    assert fit.agreement.startswith("the curves agree")
    assert [curve.name for curve in fit.curves] == ["5 um", "40 um"]
    assert fit.curves[1].noise > 10 * fit.curves[0].noise
    assert sum(curve.chi_squared for curve in fit.curves) == pytest.approx(fit.chi_squared)
    entries = json.loads(json.dumps(fit.to_dict()))["curves"]
    assert entries[0]["contact_point"]["unit"] == "m"
    assert [sample["model"]["indenter"]["radius"] for sample in entries] == list(RADII)


@pytest.mark.slow
def test_curves_without_times_have_one_speed(fit: pl.PooledFit) -> None:
    """The approaches of a small and of a large bead do not take the same time."""
    speeds = [float(np.median(member.history.velocity)) for member in fit.pool.members]
    travels = [float(np.ptp(member.base)) for member in fit.pool.members]
    assert max(travels) > 5 * min(travels)
    assert max(speeds) == pytest.approx(min(speeds), rel=0.01)


def test_curves_that_disagree() -> None:
    """Two solids are not one: that is said, and the intervals are widened."""
    random = np.random.default_rng(5)
    curves = {
        str(modulus): curve(radius, random, modulus=modulus)[:2]
        for radius, modulus in zip(RADII, (2e3, 4e3), strict=True)
    }
    fit = pooled(curves)
    assert "do not agree" in fit.agreement
    assert fit.rise > 40


def test_hertz_and_baseline(measured: dict[str, tuple[Array, Array]]) -> None:
    """A tension that is held is held for all; each curve has its own baseline."""
    position, force = measured["40 um"]
    drift = 1e-9 + 1e-4 * (position - position[0])
    fit = pooled({**measured, "40 um": (position, force + drift)}, baseline="slope")
    assert holds(fit.reduced_modulus, TRUE_MODULUS)
    small, large = fit.curves
    assert abs(small.slope) < 0.3 * large.slope
    fixed = pooled(measured, fix={"tension": "5 mN/m"})
    assert fixed.tension.held
    assert fixed.reduced_modulus.value == pytest.approx(TRUE_MODULUS, rel=0.02)


def test_simulated_curves_widen(measured: dict[str, tuple[Array, Array]]) -> None:
    """What coarser grids would shift is added to the intervals, as for one curve."""
    depths, ratios = 2.0 ** np.arange(-9, 1), simulation._RATIOS
    bead = Paraboloid(radius=1.0)
    forces: Array = np.array(
        [
            [bead.force_curve(np.array([depth]), ratio * depth**0.5).force[0] for ratio in ratios]
            for depth in depths
        ]
    )
    coarse = SimulatedCurve(
        bead,
        {"type": "tensed_membrane"},
        np.asarray(depths),
        ratios,
        np.log(1.01 * forces),
        (0.5, 0.0),
        1.0,
    )
    exact = replace(coarse, log_forces=np.log(forces))
    starts = [truth(float(z[z.size // 4])) for z, _ in measured.values()]
    ends = []
    for model in (exact, replace(exact, coarse=coarse)):
        members = []
        for (z, f), radius in zip(measured.values(), RADII, strict=True):
            coarser = model.coarse and replace(model.coarse, unit=radius)
            here = replace(model, unit=radius, coarse=coarser)
            members.append(Likelihood(z, f, here, 0.01 * float(np.ptp(f)), FREE))
        pool = Pool.of(members)
        best = pool.minimise(pool.joined(starts))
        ends.append(widen({MODULUS: (0.0, 0.0)}, pool, best)[0])
    assert ends[0] == {MODULUS: (0.0, 0.0)}
    low, high = ends[1][MODULUS]
    assert low is not None
    assert high == -low == pytest.approx(np.log(1.01), rel=0.05)


@pytest.mark.slow
def test_command(measured: dict[str, tuple[Array, Array]], cli: Callable[..., Result]) -> None:
    """``--pool`` prints, and leaves JSON, a figure and a page."""
    for number, (position, force) in enumerate(measured.values()):
        rows = np.column_stack([position * 1e6, force * 1e9])
        header = "position [um],force [nN]"
        np.savetxt(f"{number}.csv", rows, delimiter=",", header=header, comments="")
    radii = [text for radius in RADII for text in ("--radius", f"{radius * 1e6:g} um")]
    arguments = ("0.csv", "1.csv", "-i", "paraboloid", *radii, "--pool", "-o", "out", "--report")
    shown = cli(*arguments, "--set", "contact_points=true").stdout
    assert "the curves agree" in shown
    assert "95 % of contact point" in shown
    entries = json.loads(Path("out/pool.json").read_text(encoding="utf-8"))
    assert entries["reduced_modulus"]["low"] < TRUE_MODULUS < entries["reduced_modulus"]["high"]
    # The curves, their residuals, and what each parameter costs.
    left, right = (0.0, 0.5), (0.5, 1.0)
    panels = (left, (0.0, 0.68)), (left, (0.72, 1.0)), (right, (0.0, 0.5)), (right, (0.5, 1.0))
    for panel in panels:
        assert drawn_width(Path("out/pool.png"), *panel) > 0.6
    page = Path("out/pool.html").read_text(encoding="utf-8")
    for words in (
        "The curves agree",
        "0.csv",
        "5 µm, 40 µm",
        "modulus alone",
        "contact point, low",
    ):
        assert words in page
    assert page.count("data:image/svg+xml") == 2


def test_page_of_curves_that_disagree(tmp_path: Path) -> None:
    """What the curves disagree on is said where it is seen first, and not as good news."""
    random = np.random.default_rng(5)
    samples = [curve(RADII[0], random, modulus=modulus, points=60)[:2] for modulus in (2e3, 4e3)]
    fit = pl.fit_pooled(
        {"soft": samples[0], "stiff": samples[1]},
        indenter="paraboloid",
        radius=RADII[0],
        fix={"tension": TRUE_TENSION},
    )
    page = save_report(fit, tmp_path / "pool.html", "Two gels").read_text(encoding="utf-8")
    notice = re.search(r'<div class="notice bad">.*?do not agree', page, re.DOTALL)
    assert notice is not None
    assert "notice good" not in notice[0]
    assert page.count("fixed") >= 2
