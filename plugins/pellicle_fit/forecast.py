"""What to measure next: forecasts of curves by the explanations that are compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, cast

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import PellicleError
from pellicle.units import readable

from .candidate import Candidate
from .curve import Curve
from .explanation import Explanation
from .objective import CONTACT_POINT, Objective

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


def telling(asked: Candidate, others: Sequence[Candidate]) -> tuple[str, int]:
    """Return the measurement that tells an explanation from others that are as good now.

    Beside its words, which are empty if none does, stands how many curves of this kind it takes.
    Each explanation makes the measurement that it predicts, without noise, and the rest are fitted
    to this and to the curve itself; the least χ² is what a measurement is worth.
    """
    words, most = "", 0.0
    pairs = [(a, b) for other in others for a, b in ((asked, other), (other, asked))]
    for kind, measurement in measurements(asked):
        worth = np.inf
        for truth, guess in pairs:
            # What cannot be predicted, as by a cantilever that jumps, is worth nothing.
            least = 0.0
            with suppress(PellicleError):
                objective, start = _foretold(truth, guess, measurement)
                least = objective.minimise(start, steps=_ROUGH).chi_squared
            worth = min(worth, least)
            if worth < _USELESS:
                break
        if worth > most:
            words, most = kind, worth
        if worth >= _NEEDED:
            break
    count = int(np.ceil(_NEEDED / most)) if words else 1
    return (words, count) if count <= _MANY else ("", 1)


def measurements(fit: Candidate) -> Iterator[tuple[str, Curve]]:
    """Yield measurements, the easiest first, that go beyond the first curve: words, and a curve.

    It has no forces yet, and positions of the base over the contact point [m].
    """
    curve, point, body = fit.whole[0], fit.contact_points[0], cast("Any", fit.whole[0].indenter)
    low, high = float(curve.base.min()) - point, float(curve.base.max()) - point
    down = np.linspace(low, high, _ROWS)
    duration = curve.loading_time
    speed, forth = (high - low) / duration, np.linspace(0, duration, _ROWS)
    inward, out = np.zeros(_ROWS, dtype=bool), np.repeat([False, True], _ROWS)
    twice, unknown = np.append(forth, duration + forth), np.empty(0)
    if not curve.moves_out.any():
        yield "the retraction", Curve(np.append(down, down[::-1]), unknown, body, twice, out)
    dwell = np.append(down, np.full(_ROWS, high))
    words = f"a dwell of {readable(duration, 's', 2)} at the largest depth"
    yield words, Curve(dwell, unknown, body, twice, np.zeros_like(out))
    for factor in (0.1, 10.0):
        words = f"a second speed of {readable(factor * speed, 'm/s', 2)}"
        yield words, Curve(down, unknown, body, forth / factor, inward)
    radius: float | None = getattr(body, "radius", None)
    for factor in (1 / 3, 3.0):
        if high > 0 and (radius is None or factor * high <= _DEEPEST * radius):
            kind = "shallower" if factor < 1 else "deeper"
            words = f"a {kind} curve, to a depth of {readable(factor * high, 'm', 2)}"
            yield words, Curve(factor * down, unknown, body, factor * forth, inward)
    for factor in (1 / 3, 3.0):
        if radius is not None and high <= _DEEPEST * factor * radius:
            words = f"a second radius, {readable(factor * radius, 'm', 2)}"
            other = body.model_copy(update={"radius": factor * radius})
            yield words, Curve(down, unknown, other, forth, inward)


def _foretold(truth: Candidate, guess: Candidate, other: Curve) -> tuple[Objective, Array]:
    """Return χ² of an explanation on what another predicts, and coordinates to start from.

    It predicts the first curve again and another, which have no noise and touch at 0.
    """
    curve, known = truth.whole[0], truth.known[0]
    means, (point, *_) = curve.binned(_ROWS), truth.contact_points
    again = replace(means, position=means.base - point, stiffness=None, touch=None)
    # Each row of a forecast stands for as many as the curve has.
    counts = np.full(other.position.size, curve.passes[0].size / _ROWS)
    known = replace(known, solid=known.solid.model_copy(update={CONTACT_POINT: 0.0}))
    pair = again, replace(other, counts=counts)
    curves = tuple(_predicted(known, one, curve) for one in pair)
    noise = truth.objective.noise[:1] * 2
    objective = replace(guess.objective, curves=curves, noise=noise, memory=())
    values = guess.objective.values(guess.minimum.at).items()
    first = {name: value for (name, owner), value in values if not owner} | {CONTACT_POINT: 0.0}
    start = [slot.coordinate(first.get(slot.name, 0.0)) for slot in objective.slots]
    return objective, np.array(start)


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
