"""χ² of all rows from a model at some of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pellicle_fit.curves.curve import Segment
from pellicle_fit.models.force_model import ClosedFormModel
from pellicle_fit.models.relaxing import EXPONENT, PowerLawModel
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, OFFSET, SLOPE, TENSION, Coordinates
from pellicle_fit.statistics.likelihood import Likelihood
from pellicle_fit.statistics.pooled_likelihood import Pool
from pellicle_plugins.indenters.of_revolution import Paraboloid

MODEL = ClosedFormModel(Paraboloid(radius=5e-6))
BEST: Coordinates = {
    CONTACT_POINT: 1e-7,
    MODULUS: float(np.log(2e3)),
    TENSION: 2e-3,
    OFFSET: 1e-11,
    SLOPE: 1e-5,
}


def curve(segment: Segment = "approach", noise: float = 0.005) -> Likelihood:
    """Return a curve of 1000 rows a pass on a cantilever, its baseline sloping."""
    base = np.linspace(-0.2e-6, 0.6e-6, 1000)
    time = np.linspace(0.0, 1.0, 1000)
    if segment == "both":
        base = np.concatenate([base, np.full(200, base[-1]), base[::-1]])
        time = np.linspace(0.0, 2.2, base.size)
    exact = Likelihood(
        base,
        np.zeros_like(base),
        MODEL,
        1.0,
        tuple(BEST),
        None,
        time,
        segment,
    )
    force = exact.model(BEST)
    deviation = noise * float(np.ptp(force))
    force = force + deviation * np.random.default_rng(1).standard_normal(base.size)
    return Likelihood(
        base - force / 0.05,
        force,
        MODEL,
        deviation,
        tuple(BEST),
        0.05,
        time,
        segment,
    )


@pytest.mark.parametrize(
    ("segment", "relaxes"), [("approach", False), ("both", False), ("approach", True)]
)
def test_minimum_is_that_of_all_rows(segment: Segment, relaxes: bool) -> None:
    """A curve condensed to a quarter of its rows has the same χ² and the same minimum."""
    whole, start = curve(segment), BEST
    if relaxes:
        whole = replace(whole, force_model=PowerLawModel(MODEL, whole.history))
        start = BEST | {EXPONENT: 0.05}
    thin = whole.condensed(start, 0.1)
    assert thin.force.size <= whole.force.size / 4
    assert thin.chi_squared(start) == pytest.approx(whole.chi_squared(start), rel=1e-3)
    expected = whole.minimise(start).parameters
    result = Pool.of([whole]).condensed(start, 0.1).minimise(start).parameters
    for parameter, bound in whole.bounds(expected, whole.free).items():
        assert abs(result[parameter] - expected[parameter]) <= 0.1 * bound
