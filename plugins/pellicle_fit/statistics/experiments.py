"""Measurements that would tell explanations of a curve apart, forecast without noise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PellicleError
from pellicle.units import decimal, readable
from pellicle_fit.models.force_model import ClosedFormModel
from pellicle_fit.parameters import CONTACT_POINT, Coordinates

from .chi_squared import ChiSquared
from .likelihood import Likelihood
from .pooled_likelihood import Pool
from .rival import Rival
from .rivals import MARGIN

_ROWS = 150
"""Rows of a pass in a forecast."""
_SURE = 1.645
"""Standard deviations that a normal number exceeds in 5 % of cases."""
_NEEDED = float((_SURE + np.sqrt(_SURE**2 + MARGIN)) ** 2)
"""Expected Δχ² S from which a measurement tells two models apart in 95 % of cases: the difference
of two misfits is normal about S with deviation 2√S, and must exceed the margin."""
_USELESS = 1.0
"""Expected Δχ² below which a measurement is not proposed."""
_DEEPEST = 0.5
"""Largest depth over radius that is proposed."""
_MANY = 30
"""Largest number of curves that is proposed."""

Explanation = tuple[Rival, Coordinates]


@dataclass(frozen=True)
class Measurement:
    """A curve that could be measured."""

    words: str
    base: Array
    """Positions of the base over the contact point [m], in order of time."""
    time: Array
    segment: Any
    radius: float = 1.0
    """Radius of the indenter over that of the curve."""


def advised(
    chi_squared: ChiSquared,
    tensed: Explanation,
    others: Sequence[Explanation],
) -> str:
    """Return which measurement would separate a model with tension from others, and how many.

    The others are as good as the model with tension now.  Each model makes the measurement that it
    predicts, without noise, and the rest are fitted to this and to the curve itself; the least χ²
    among those that have to be told apart is what a measurement is worth.
    """
    likelihood = chi_squared.members[0]
    part = _of_first_curve(tensed[1])
    best: tuple[float, str] | None = None
    # A solid that relaxes under a tension, which no approach excludes, has no model of retraction.
    relaxes = any(rival.relaxes for rival, _ in (tensed, *others))
    for measurement in _measurements(likelihood, part[CONTACT_POINT], retracts=not relaxes):
        worth = np.inf
        for rival, parameters in others:
            known = _of_first_curve(parameters)
            for truth, guess in (
                ((tensed[0], part), (rival, known)),
                ((rival, known), (tensed[0], part)),
            ):
                worth = min(worth, _separation(likelihood, measurement, truth, guess))
                if worth < _USELESS:
                    break
            if worth < _USELESS:
                break
        if worth >= _NEEDED:
            two_digits = decimal(float(f"{worth:.2g}"), 2)
            return f"{measurement.words} would (expected Δχ² = {two_digits})"
        if best is None or worth > best[0]:
            best = worth, measurement.words
    if best is None or best[0] < _NEEDED / _MANY:
        return "no other speed, dwell, pass, depth or radius at this noise would; less noise might"
    count = int(np.ceil(_NEEDED / best[0]))
    return f"{count} curves of this kind would: {best[1]} (expected Δχ² = {best[0]:.2g} each)"


def _of_first_curve(parameters: Coordinates) -> Coordinates:
    """Return the coordinates of the first curve, the shared ones included."""
    return {p: coordinate for p, coordinate in parameters.items() if p.curve == 0}


def _measurements(likelihood: Likelihood, point: float, *, retracts: bool) -> Iterator[Measurement]:
    """Yield measurements, the easiest first, the retraction if it is to be among them."""
    base = likelihood.base
    down = np.linspace(base.min(), base.max(), _ROWS) - point
    times = likelihood.history.time
    duration = float(np.ptp(times[likelihood.first_pass]))
    speed = float(np.ptp(base)) / duration
    known = likelihood.time is not None
    forth = np.linspace(0, duration, _ROWS)
    there_and_back, times_of_both = (
        np.concatenate([down, down[::-1]]),
        np.concatenate([forth, duration + forth]),
    )
    if retracts and likelihood.segment == "approach":
        yield Measurement("the retraction", there_and_back, times_of_both, "both")
    dwell = np.concatenate([down, np.full(_ROWS, down[-1])])
    yield Measurement(
        f"a dwell of {_duration(duration, known)} at the largest depth",
        dwell,
        times_of_both,
        "both",
    )
    for factor in (0.1, 10.0):
        words = f"of {_speed(factor * speed)}" if known else f"{factor:g} times as fast"
        yield Measurement(f"a second speed {words}", down, forth / factor, "approach")
    model: Any = likelihood.force_model
    indenter = model.indenter if isinstance(model, ClosedFormModel) else None
    radius = getattr(indenter, "radius", None)
    deepest = float(down[-1])
    for factor in (1 / 3, 3.0):
        if deepest > 0 and (radius is None or factor * deepest <= _DEEPEST * radius):
            words = "shallower" if factor < 1 else "deeper"
            yield Measurement(
                f"a {words} curve, to {readable(factor * deepest, 'm', 2)}",
                factor * down,
                factor * forth,
                "approach",
            )
    for factor in (1 / 3, 3.0):
        if radius is not None and deepest <= _DEEPEST * factor * radius:
            yield Measurement(
                f"a second radius, {readable(factor * radius, 'm', 2)}",
                down,
                forth,
                "approach",
                factor,
            )


def _speed(value: float) -> str:
    return readable(value, "m/s", 2)


def _duration(value: float, has_time: bool) -> str:
    return readable(value, "s", 2) if has_time else "the duration of the approach"


def _separation(
    likelihood: Likelihood, measurement: Measurement, truth: Explanation, guess: Explanation
) -> float:
    """Return the least χ² of a model on curves that another predicts: this one and a planned one.

    A measurement that cannot be predicted, as by a cantilever that jumps, is worth nothing.
    """
    rival, parameters = truth
    other, start = guess
    with suppress(PellicleError):
        curves = [
            _predicted(rival, likelihood.thinned(_ROWS), parameters),
            _predicted(rival, _planned(likelihood, measurement), parameters | {CONTACT_POINT: 0.0}),
        ]
        pool = Pool.of([other.of_curve(curve) for curve in curves])
        starts = [other.start(member, start) for member in pool.members]
        starts[1][CONTACT_POINT] = 0.0
        return pool.minimise(pool.joined(starts), rough=True).chi_squared
    return 0.0


def _planned(likelihood: Likelihood, measurement: Measurement) -> Likelihood:
    """Return a measurement that has not been made yet, its forces 0."""
    model = likelihood.force_model
    if measurement.radius != 1 and isinstance(model, ClosedFormModel):
        indenter: Any = model.indenter
        radius = measurement.radius * indenter.radius
        model = ClosedFormModel(indenter.model_copy(update={"radius": radius}))
    return replace(
        likelihood,
        position=measurement.base,
        force=np.zeros_like(measurement.base),
        noise=likelihood.noise_of(likelihood.force.size / _ROWS),
        force_model=model,
        time=measurement.time,
        segment=measurement.segment,
    )


def _predicted(rival: Rival, curve: Likelihood, parameters: Coordinates) -> Likelihood:
    """Return a curve with the forces of a model at its positions of the base."""
    base = curve.base
    still = replace(curve, position=base, force=np.zeros_like(base))
    member = rival.of_curve(still)
    position, force = member.fitted(rival.start(member, parameters))
    return replace(curve, position=position, force=force)
