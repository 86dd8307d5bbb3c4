"""What to measure next: forecasts of curves by the explanations that are compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from enum import Enum
from typing import Any, NamedTuple, cast

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PellicleError
from pellicle_fit.contact.curve import Curve
from pellicle_fit.estimation.candidate import Candidate
from pellicle_fit.estimation.coordinates import CONTACT_POINT
from pellicle_fit.estimation.search import descend
from pellicle_fit.explanation import Explanation

_ROWS = 150
"""Rows of each pass of a forecast."""
_NEEDED = 12.0
"""Expected Δχ² at which a measurement tells explanations apart in nine of ten cases."""
_USELESS = 1.0
"""Expected Δχ² below which a measurement is not proposed."""
_DEEPEST = 0.5
"""Largest depth over radius that is proposed, roughly the limit of linear elasticity."""
_ROUGH = 20
"""Steps of a search for what a measurement is worth."""
_MANY = 30
"""Largest number of curves that is proposed."""


class Means(Enum):
    """What tells explanations apart."""

    RETRACTION = "retraction"
    DWELL = "dwell"
    SPEED = "speed"
    SHALLOWER = "shallower"
    DEEPER = "deeper"
    RADIUS = "radius"


class Proposal(NamedTuple):
    """A measurement."""

    means: Means
    value: float = 0.0
    """Time of a dwell [s], speed [m/s], largest depth or radius [m]."""


def telling_measurement(
    target: Candidate, others: Sequence[Candidate]
) -> tuple[Proposal | None, int]:
    """Return the measurement that tells an explanation from others that are as good now, if any.

    Beside it stands how many curves of this kind it takes.
    Each explanation makes the measurement that it predicts, without noise, and the rest are fitted
    to this and to the curve itself; the least χ² is what a measurement is worth.
    """
    best, most = None, 0.0
    pairs = [(a, b) for rival in others for a, b in ((target, rival), (rival, target))]
    for proposal, measurement in measurements(target):
        worth, useless = np.inf, max(_USELESS, most)
        made: dict[Candidate, tuple[Curve, ...]] = {}
        for truth, guess in pairs:
            # What cannot be predicted, as by a cantilever that jumps, is worth nothing.
            least = 0.0
            with suppress(PellicleError):
                if truth not in made:
                    made[truth] = _foretold(truth, measurement)
                if not guess.objective.explanation.excuse(made[truth]):
                    least = _misfit(guess, made[truth], truth.objective.noise, useless)
            worth = min(worth, least)
            if worth < useless:
                break
        if worth > most:
            best, most = proposal, worth
        if worth >= _NEEDED:
            break
    count = int(np.ceil(_NEEDED / most)) if best else 1
    return (best, count) if count <= _MANY else (None, 1)


def measurements(fit: Candidate) -> Iterator[tuple[Proposal, Curve]]:
    """Yield measurements, the easiest first, that go beyond the first curve, each with its curve.

    This has no forces yet, and positions of the base over the contact point [m].
    """
    curve, point = fit.all_rows[0], fit.contact_points[0]
    body = cast("Any", curve.indenter)
    low, high = float(curve.base.min()) - point, float(curve.base.max()) - point
    down = np.linspace(low, high, _ROWS)
    duration = curve.loading_time
    speed, forth = (high - low) / duration, np.linspace(0, duration, _ROWS)
    inward, out = np.zeros(_ROWS, dtype=bool), np.repeat([False, True], _ROWS)
    twice, unknown = np.append(forth, duration + forth), np.empty(0)
    if not curve.moves_out.any():
        back = Curve(np.append(down, down[::-1]), unknown, body, twice, out)
        yield Proposal(Means.RETRACTION), back
    dwell = np.append(down, np.full(_ROWS, high))
    yield Proposal(Means.DWELL, duration), Curve(dwell, unknown, body, twice, np.zeros_like(out))
    for factor in (0.1, 10.0):
        slower = Curve(down, unknown, body, forth / factor, inward)
        yield Proposal(Means.SPEED, factor * speed), slower
    radius: float | None = getattr(body, "radius", None)
    for factor in (1 / 3, 3.0):
        if high > 0 and (radius is None or factor * high <= _DEEPEST * radius):
            means = Means.SHALLOWER if factor < 1 else Means.DEEPER
            to_depth = Curve(factor * down, unknown, body, factor * forth, inward)
            yield Proposal(means, factor * high), to_depth
    for factor in (1 / 3, 3.0):
        if radius is not None and high <= _DEEPEST * factor * radius:
            tip = body.model_copy(update={"radius": factor * radius})
            on_other = Curve(down, unknown, tip, forth, inward)
            yield Proposal(Means.RADIUS, factor * radius), on_other


def _misfit(
    guess: Candidate, curves: tuple[Curve, ...], noise: tuple[float, ...], useless: float
) -> float:
    """Return the least χ² of an explanation on what another predicts.

    Below what is ``useless``, or above what is needed, it is a bound.
    """
    objective = replace(guess.objective, curves=curves, noise=noise[:1] * 2, memory=())
    values = guess.objective.values(guess.minimum.at).items()
    first = {name: value for (name, owner), value in values if not owner} | {CONTACT_POINT: 0.0}
    start = [slot.coordinate(first.get(slot.name, 0.0)) for slot in objective.slots]
    (minimum,) = descend(objective, np.array([start]), steps=_ROUGH, goal=_NEEDED, enough=useless)
    # What cannot be explained at all is worth nothing, too.
    return minimum.chi_squared if np.isfinite(minimum.chi_squared) else 0.0


def _foretold(truth: Candidate, planned_curve: Curve) -> tuple[Curve, ...]:
    """Return what an explanation predicts of the first curve again, and of another.

    They have no noise and touch at 0.
    """
    curve, known = truth.all_rows[0], truth.known[0]
    means, (point, *_) = curve.bin_means(_ROWS), truth.contact_points
    again = replace(means, position=means.base - point, stiffness=None, touch=None)
    # Each row of a forecast stands for as many as the curve has.
    counts = np.full(planned_curve.position.size, curve.passes[0].size / _ROWS)
    known = replace(known, solid=known.solid.model_copy(update={CONTACT_POINT: 0.0}))
    pair = again, replace(planned_curve, counts=counts)
    return tuple(_predicted(known, measurement, curve) for measurement in pair)


def _predicted(known: Explanation, measurement: Curve, curve: Curve) -> Curve:
    """Return a measurement with the cantilever of a curve."""
    base, stiffness = measurement.position, curve.stiffness

    def planned(force: Array) -> Curve:
        tip = base - (force / stiffness if stiffness else 0.0)
        return replace(measurement, position=tip, force=force, stiffness=stiffness)

    free = known.free_force(planned(np.zeros_like(base)))
    roughly = planned(free + curve.largest * np.maximum(base / np.max(base), 0.0))
    # A memory sees the path that its own force leaves.
    return planned(known.force(planned(known.force(roughly))))
