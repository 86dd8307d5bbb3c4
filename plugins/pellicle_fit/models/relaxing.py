"""Indenter on a solid that relaxes, by Lee & Radok (1960) while loaded and Ting (1966) after."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle_fit.parameters import CONTACT_POINT, MODULUS, TENSION, Parameter, Values

from .force_model import DeferredDerivatives, ModelForce, TensionModel
from .history import History

_RAMP, _DWELL, _BACK = 72, 24, 60
"""Nodes of the path while the indenter moves in, dwells and moves out."""
_MODULI = 6
"""Effective moduli between which the force is interpolated."""
_ROUNDS = 4
"""Rounds of the fixed point of the effective modulus, each some ten times nearer."""
TENSED_ACCURACY = 5e-3
"""Error of the force beside a tension over the largest one, by runs of the solver."""
_STEP = 1e-4
"""Step of numerical derivatives, of the contact point over the depth, and of other coordinates."""
_EARLIEST = 1e-4
"""Least time in contact at which the solid's response is evaluated, over that of the loading."""

EXPONENT = Parameter("relaxation_exponent", "", minimum=0.0, maximum=0.95, shared=True)
"""α of E(t) = E* (t / 1 s)^−α."""
SHARE = Parameter("relaxed_share", "", minimum=0.0, maximum=0.99, shared=True)
"""Share of the instantaneous modulus that relaxes."""
RELAXATION_TIME = Parameter("relaxation_time", "s", logarithmic=True, shared=True)
"""Time in which it relaxes."""


class Course(NamedTuple):
    """How a solid responds to a path, at each row of a curve, of shape (n,)."""

    modulus: Array
    """Effective modulus over E*."""
    depth: Array
    """Depth [m] at which the contact was as large while it grew; that of the row on loading."""
    by_depth: Array
    """Derivative of this depth with respect to that of the row."""


class _Loading(NamedTuple):
    """The response of a solid while the contact grows, at n nodes of the path."""

    time: Array
    """[s]."""
    depth: Array
    """[m]."""
    log_modulus: Array
    """Logarithm of the effective modulus over E*, of shape (n − 1,): not at the first touch."""


class _PathForce(NamedTuple):
    """Force at the rows of a curve and its derivatives, each of shape (n,)."""

    force: Array
    """[N]."""
    by_depth: Array
    by_modulus: Array
    """By the effective modulus."""
    by_tension: Array
    by_path: Array
    """By the depth at which the growing contact was as large."""


@dataclass(frozen=True)
class RelaxingModel(ABC):
    """Indenter on a tensed solid that relaxes; the tension does not.

    Without tension it is the solution of Lee & Radok (1960) for a growing contact and of Ting
    (1966) for a shrinking one.  Their force over that of an elastic solid at the depth at which the
    growing contact was as large is an effective modulus M.  Beside a tension F = M a(δ, s) with
    s = 2τ₀/M, and M a(δ, s) = ∫ E(t − t′) da(δ(t′), s): the integral of Lee & Radok over the force
    curve under the tension of the moment.  That is exact where there is no tension, where nothing
    relaxes and where everything has relaxed, and `TENSED_ACCURACY` says how good it is between.
    It holds for growing contacts alone: as one shrinks, the skin keeps it where a bare solid lets
    go.
    """

    elastic: TensionModel
    history: History
    tensed: bool = False
    """Whether the tension is fitted too."""
    coarse: ClassVar[None] = None
    on_base: ClassVar[bool] = False
    own: ClassVar[tuple[Parameter, ...]]
    """The parameters of the relaxation."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Modulus, tension and the parameters of the relaxation."""
        return (*self.elastic.parameters, *self.own)

    @property
    def depth_limit(self) -> float:
        """Depth [m] up to which the force curve holds."""
        return self.elastic.depth_limit

    @property
    def accuracy(self) -> float:
        """Error of the force relative to the largest one."""
        return TENSED_ACCURACY if self.tensed else 1e-4

    @abstractmethod
    def primitive(self, time: Array, values: Values) -> Array:
        """Return the integral of the relaxation function over E* from 0 to times [s]."""

    @abstractmethod
    def own_guesses(self) -> list[dict[Parameter, float]]:
        """Return values of the parameters of the relaxation to start from."""

    def force(self, depth: Array, values: Values) -> ModelForce:
        """Return force and derivatives at depths [m] of the rows, of shape (n,)."""
        point = values[CONTACT_POINT]
        course = self._recent_course(point, values)
        force = self._at(course, depth, values)
        return ModelForce(
            force.force,
            force.by_depth,
            DeferredDerivatives(lambda: self._derivatives(course, depth, values, force)),
        )

    def _recent_course(self, point: float, values: Values) -> Course:
        """Return the response of the solid, retained from the last call if that was equal.

        The balance of a cantilever varies the depths of rows only.
        """
        key = (point, values[TENSION] / values[MODULUS], *(values[p] for p in self.own))
        if key not in self._recent:
            self._recent.clear()
            self._recent[key] = self._course(point, values)
        return self._recent[key]

    @cached_property
    def _recent(self) -> dict[tuple[float, ...], Course]:
        return {}

    def _derivatives(
        self, course: Course, depth: Array, values: Values, at: _PathForce
    ) -> dict[Parameter, Array]:
        """Return the derivatives of the force by the value of each parameter."""
        derivatives = {
            MODULUS: at.by_modulus * course.modulus,
            TENSION: at.by_tension,
            CONTACT_POINT: np.zeros_like(at.force),
        }
        deepest = max(float(depth.max()), float(np.ptp(depth)) * _STEP)
        tension, modulus = values[TENSION], values[MODULUS]
        varied = (CONTACT_POINT, *self.own, *((TENSION,) if tension else ()))
        for parameter in varied:
            # A position is varied at equal depths, so that only the time in contact changes.
            step = _STEP * (deepest if parameter == CONTACT_POINT else 1.0)
            if parameter.logarithmic or parameter == TENSION:
                step *= values[parameter]
            other = {**values, parameter: values[parameter] + step}
            course_there = self._course(other[CONTACT_POINT], other)
            # This is what the course changes; tension and modulus change the force curve too.
            change = at.by_modulus * modulus * (course_there.modulus - course.modulus)
            path = self._path(course_there, depth) - self._path(course, depth)
            by_course = (change + at.by_path * path) / step
            derivatives[parameter] = derivatives.get(parameter, 0.0) + by_course
            if parameter == TENSION:
                # The course depends on both through their ratio.
                derivatives[MODULUS] = derivatives[MODULUS] - by_course * tension / modulus
        return derivatives

    def at_rows(self, rows: NDArray[np.intp]) -> RelaxingModel:
        """Return the model of some of the rows."""
        return replace(self, history=self.history.at_rows(rows))

    def _path(self, course: Course, depth: Array) -> Array:
        """Return the depth [m] at which the growing contact was as large as at each row."""
        # The path is smoothed, and the row itself lies beside it.
        path: Array = np.where(
            self.history.unloading, course.depth + course.by_depth * depth, depth
        )
        return path

    def _at(self, course: Course, depth: Array, values: Values) -> _PathForce:
        """Return the force at depths [m] of the rows, and its derivatives."""
        modulus, tension = values[MODULUS], values[TENSION]
        path = self._path(course, depth)
        effective = modulus * course.modulus
        chain = np.where(self.history.unloading, course.by_depth, 1.0)
        if not tension:
            curve = self.elastic.force_curve(path, 0.0)
            by_path = effective * curve.by_depth
            return _PathForce(
                effective * curve.force, by_path * chain, curve.force, 2 * curve.by_length, by_path
            )
        nodes = _nodes(float(np.log(effective.min())), float(np.log(effective.max())))
        weights = _lagrange(nodes, np.log(effective))
        force = np.zeros((4, depth.size))
        for weight, node in zip(weights, np.exp(nodes).tolist(), strict=True):
            length = 2 * tension / node
            curve = self.elastic.force_curve(path, length)
            # Forces over the modulus vary less than the forces.
            force[0] += weight * curve.force
            force[1] += weight * curve.by_depth
            force[2] += weight * (curve.force - length * curve.by_length)
            force[3] += weight * 2 * curve.by_length
        by_path = effective * force[1]
        return _PathForce(effective * force[0], by_path * chain, force[2], force[3], by_path)

    def _course(self, point: float, values: Values) -> Course:
        """Return the response of the solid to the path from a contact point on."""
        history, times = self.history, self.history.time
        start, end = history.contact_time(point), float(history.loading_path[0][-1])
        size = times.size
        if not end > start:
            return Course(np.ones(size), np.zeros(size), np.ones(size))
        loading = self._loading(start, end, point, values)
        earliest = _EARLIEST * (end - start)
        # Nodes of a far contact point may coincide by rounding.
        log_time = np.log(np.maximum(loading.time[1:] - start, 1e-6 * earliest))
        at = np.log(np.maximum(times - start, earliest))
        modulus = np.exp(np.interp(at, log_time, loading.log_modulus))
        course = Course(modulus, np.zeros(size), np.ones(size))
        back_times, _ = history.unloading_path
        if history.unloading.any() and back_times.size > 1 and back_times[-1] > end:
            return self._unloading(course, loading, point, values)
        return course

    def _loading(self, start: float, end: float, point: float, values: Values) -> _Loading:
        """Return the response while the contact grows, between two times [s]."""
        history = self.history
        top = min(max(history.top, start + _EARLIEST * (end - start)), end)
        ramp = start + (top - start) * np.linspace(0, 1, _RAMP + 1) ** 2
        dwell = top + (end - top) * np.linspace(0, 1, _DWELL + 1)[1:] ** 2
        t = np.concatenate([ramp, dwell]) if end > top else ramp
        z = np.maximum.accumulate(history.positions(t, point) - point)
        weights = self._weights(t[1:], t, values)
        log_modulus = self._log_modulus(weights, t, z, 0.0)
        if length := 2 * values[TENSION] / values[MODULUS]:
            # The effective modulus sets the length for which it is found: a fixed point.
            nodes = _nodes(float(log_modulus.min()), float(log_modulus.max()))
            at_nodes = [self._log_modulus(weights, t, z, length / np.exp(x)) for x in nodes]
            for _ in range(_ROUNDS):
                log_modulus = np.sum(_lagrange(nodes, log_modulus) * at_nodes, axis=0)
        return _Loading(t, z, log_modulus)

    def _log_modulus(self, weights: Array, t: Array, z: Array, length: float) -> Array:
        """Return the logarithm of ∫ E(t − t′) da / E* a(t), a at times t, depths z and s."""
        area = self.elastic.force_curve(z, length).force
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(area[1:] > 0, weights @ _rates(t, area) / area[1:], np.nan)
        return _filled(np.log(np.maximum(ratio, 1e-12)))

    def _unloading(self, course: Course, loading: _Loading, point: float, values: Values) -> Course:
        """Return the response, completed at the rows at which the contact shrinks."""
        history, times = self.history, self.history.time
        t, z, log_modulus = loading
        g = self.elastic.force_curve(z, 0.0).force
        end, (back_times, back_positions) = history.loading_path[0][-1], history.unloading_path
        u = end + (back_times[-1] - end) * np.linspace(0, 1, _BACK + 1)[1:] ** 1.5
        back = np.concatenate([[end], u])
        y = np.interp(back, back_times, back_positions) - point
        y[0] = z[-1]
        earlier, force = self._unloaded(u, t, z, g, back, y, values)
        equal = np.interp(earlier, t, z)
        growing = self.elastic.force_curve(equal, 0.0).force
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(growing > 1e-9 * g[-1], force / growing, np.nan)
        log_back = np.concatenate([log_modulus[-1:], np.log(np.maximum(ratio, 1e-12))])
        rows = history.unloading
        modulus, depth, by_depth = (part.copy() for part in course)
        modulus[rows] = np.exp(np.interp(times[rows], back, _filled(log_back)))
        equal = np.concatenate([z[-1:], equal])
        path = np.interp(times[rows], back, y)
        falls = np.minimum(np.diff(y), -1e-12 * max(float(z[-1]), 1e-300))
        slopes = np.clip(np.diff(equal) / falls, 0.0, 3.0)
        index = np.clip(np.searchsorted(back, times[rows]) - 1, 0, slopes.size - 1)
        contact_lost = np.interp(times[rows], back, np.concatenate([t[-1:], earlier])) <= t[0]
        by_depth[rows] = np.where(contact_lost, 0.0, slopes[index])
        depth[rows] = np.where(
            contact_lost, 0.0, np.interp(times[rows], back, equal) - slopes[index] * path
        )
        return Course(modulus, depth, by_depth)

    def _weights(self, at: Array, times: Array, values: Values) -> Array:
        """Return ∫ E(t − t′) dt′ / E* over each interval of times, of shape (at, intervals)."""
        lag = np.maximum(at[:, None] - times[None, :], 0.0)
        primitive = self.primitive(lag, values)
        weights: Array = primitive[:, :-1] - primitive[:, 1:]
        return weights

    def _unloaded(
        self, at: Array, t: Array, z: Array, g: Array, back: Array, y: Array, values: Values
    ) -> tuple[Array, Array]:
        """Return the time of equal contact on loading, and the force over E*, by Ting (1966)."""
        weights = self._weights(at, t, values)
        loading = weights * _rates(t, z)
        unloading = self._weights(at, back, values) @ _rates(back, y)
        # ∫ E(t − t′) dδ from the time of equal contact on is 0.
        tail = np.cumsum(loading[:, ::-1], axis=1)[:, ::-1]
        tail = np.concatenate([tail, np.zeros((at.size, 1))], axis=1)
        target = -unloading
        index = np.sum(tail > target[:, None], axis=1) - 1
        rows = np.arange(at.size)
        touching = index >= 0
        cell = np.clip(index, 0, t.size - 2)
        above, below = tail[rows, cell], tail[rows, cell + 1]
        share = np.where(above > below, (above - target) / np.maximum(above - below, 1e-300), 0.0)
        share = np.where(touching, np.clip(share, 0.0, 1.0), 0.0)
        earlier = np.where(touching, t[cell] + share * (t[cell + 1] - t[cell]), t[0])
        contributions = weights * _rates(t, g)
        sums = np.concatenate([np.zeros((at.size, 1)), np.cumsum(contributions, axis=1)], axis=1)
        # The last interval counts as far as the time of equal contact.
        lag = at - t[cell]
        part = self.primitive(lag, values) - self.primitive(at - earlier, values)
        force = sums[rows, cell] + _rates(t, g)[cell] * part
        return earlier, np.where(touching, force, 0.0)

    def guesses(self, span: float) -> Iterator[Values]:
        """Yield guesses of the elastic solid with some relaxation."""
        for values in self.elastic.guesses(span):
            for own in self.own_guesses():
                yield {**values, **own}

    def scaled(self, values: Values, factor: float) -> Values:
        """Return modulus and tension times ``factor``."""
        return {
            p: value if p in self.own or p == CONTACT_POINT else factor * value
            for p, value in values.items()
        }

    def description(self) -> dict[str, Any]:
        """Return the indenter and the law of relaxation as JSON data."""
        return self.elastic.description() | {"relaxation": self.law}

    law: ClassVar[str]


@dataclass(frozen=True)
class PowerLawModel(RelaxingModel):
    """Solid whose modulus falls as a power of time: E(t) = E* (t / 1 s)^−α."""

    own: ClassVar[tuple[Parameter, ...]] = (EXPONENT,)
    law: ClassVar[str] = "power_law"

    def own_guesses(self) -> list[dict[Parameter, float]]:
        """Return a solid that hardly relaxes, and one that flows."""
        return [{EXPONENT: 0.05}, {EXPONENT: 0.3}]

    def primitive(self, time: Array, values: Values) -> Array:
        """Return t^(1−α) / (1 − α)."""
        power = 1 - values[EXPONENT]
        result: Array = time**power / power
        return result


@dataclass(frozen=True)
class StandardLinearModel(RelaxingModel):
    """Standard linear solid: E(t) = E* (1 − g + g e^(−t/T)), with E* that of fast loading."""

    own: ClassVar[tuple[Parameter, ...]] = (SHARE, RELAXATION_TIME)
    law: ClassVar[str] = "standard_linear"

    def own_guesses(self) -> list[dict[Parameter, float]]:
        """Return relaxation within a tenth of the path, a third of it and all of it."""
        duration = float(np.ptp(self.history.time))
        return [{SHARE: 0.3, RELAXATION_TIME: share * duration} for share in (0.05, 0.3, 2.0)]

    def primitive(self, time: Array, values: Values) -> Array:
        """Return (1 − g) t + g T (1 − e^(−t/T))."""
        share, constant = values[SHARE], values[RELAXATION_TIME]
        result: Array = (1 - share) * time - share * constant * np.expm1(-time / constant)
        return result


def _rates(times: Array, values: Array) -> Array:
    """Return slopes between neighbours; 0 where no time passes."""
    steps = np.diff(times)
    rates: Array = np.where(steps > 0, np.diff(values) / np.maximum(steps, 1e-300), 0.0)
    return rates


def _nodes(low: float, high: float) -> Array:
    """Return nodes of an interpolation between two numbers; one if they are equal to rounding."""
    if high <= low + 1e-9:
        return np.array([low])
    x: Array = np.polynomial.chebyshev.chebpts1(_MODULI)
    return low + (x + 1) / 2 * (high - low)


def _lagrange(nodes: Array, at: Array) -> Array:
    """Return the weights of values at nodes in their interpolation, shape (nodes, at)."""
    weights = np.ones((nodes.size, at.size))
    for i in range(nodes.size):
        for j in range(nodes.size):
            if i != j:
                weights[i] *= (at - nodes[j]) / (nodes[i] - nodes[j])
    return weights


def _filled(values: Array) -> Array:
    """Return values with NaN replaced by the nearest number before, or else after."""
    finite = np.flatnonzero(np.isfinite(values))
    if not finite.size:
        return np.zeros_like(values)
    return np.interp(np.arange(values.size), finite, values[finite])
