"""Solids that relax: Lee & Radok (1960) while the contact grows, Ting (1966) while it shrinks."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from pellicle_fit.effect import (
    Array,
    ComplexArray,
    Contact,
    Curve,
    Responds,
    Response,
    quantities,
)

_NODES, _FEW_NODES = 97, 49
"""Nodes of the path while the indenter moves in, and of a rough one; as many where it dwells or
moves out."""
_MODULI = 6
"""Effective moduli between which the force under a tension is interpolated."""
_TOGETHER = 12
"""Trials whose courses are computed at once, as memory near the processor holds them."""
_BENT = 0.05
"""Least distance of a path with a dwell from a straight one, over its depth."""
_BRIEFEST = 1e-3
"""Least time from touch to a dwell, over that in contact."""
_WHILE = 0.1
"""Time over which velocities are compared, over that to where a path is furthest from straight."""
_NO_TOUCH, _GRAZING = 1e-9, 1e-3
"""Depth over the way that is no touch but rounding, and to which a path without one is raised."""
_BESIDE_TENSION = 0.03
"""Error of the effective modulus beside a tension, against solutions of the whole problem."""
_EARLIEST = 1e-4
"""Least time in contact over that of the loading; before it the response is that of then."""
_SINE_TIMES, _SINE_RELAXATION = (2e-3, 3e2, 36), (1e-5, 1e5, 301)
"""Times at which ∫ E dt is asked for a sine, and of relaxation, over 1/ω: ends and numbers."""
_POINTS = chebyshev.chebpts1(_MODULI)
_FROM_NODES = np.linalg.inv(chebyshev.chebvander(_POINTS, _MODULI - 1))


class Relaxing(Responds):
    """Solid whose modulus falls; a tension does not, and acts with the effective modulus."""

    sees_tension: ClassVar[bool] = False
    """Whether a tension changes how fast the modulus falls."""

    @abstractmethod
    def primitive(self, time: Array) -> Array:
        """Return ∫ E(t) dt / E* from 0 to times [s]."""

    def held(self, time: Array, radius: Array, length: Array | float) -> Array:
        """Return ∫ E(t) dt / E* from 0 to times [s] of a contact that stays.

        Its radii [m] are those without tension, and ``length`` is the elastocapillary length [m].
        """
        return self.primitive(time)

    def complex_modulus(
        self, frequency: Array, radius: Array, length: Array | float
    ) -> ComplexArray:
        """Return iω ∫ E(t) exp(−iωt) dt / E*."""
        times, weights = _sine_weights()
        omega = 2 * np.pi * frequency
        at = (times / omega[:, None]).ravel()
        of = self.held(at, np.repeat(radius, times.size, axis=-1), length)
        of = of.reshape(*of.shape[:-1], omega.size, times.size)
        return np.asarray(omega * (of @ weights))

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse curves without a loading, and beside a tension those that unload."""
        if curve.moves_out.all():
            return "the loading is not in the curve"
        unloads = "tension" in beside and curve.moves_out.any()
        return "beside a tension there is no theory of unloading" if unloads else ""

    def accuracy(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> float:
        """Return the error of the force over the largest one."""
        return _BESIDE_TENSION if np.any(contact.tension) else 1e-4

    def response(self, contact: Contact, curve: Curve, path: Array, softness: float) -> Response:
        """Return the force as a function of the depth."""
        share, equal = self._courses(contact, curve, path)

        def response(depth: Array) -> Array:
            # While the contact shrinks, the path decides.
            depth = np.where(curve.moves_out, equal, depth)
            if np.any(contact.tension):
                return self._tensed(contact, share, depth)
            return share * contact.force(depth)

        return response

    def _tensed(self, contact: Contact, share: Array, depth: Array) -> Array:
        """Return the force [N] of effective moduli, given over E*, under tension."""
        # The force over the effective modulus is a polynomial in the logarithm of that.
        at = np.log(share)
        high, low = at.max(axis=-1, keepdims=True), at.min(axis=-1, keepdims=True)
        middle, half = (high + low) / 2, np.maximum((high - low) / 2, 1e-12)
        moduli = [np.exp(middle + half * node) for node in _POINTS]
        forces = [replace(contact, modulus=contact.modulus * m).force(depth) / m for m in moduli]
        basis = chebyshev.chebvander((at - middle) / half, _MODULI - 1) @ _FROM_NODES
        return np.asarray(share * sum(basis[..., i] * force for i, force in enumerate(forces)))

    def _courses(self, contact: Contact, curve: Curve, path: Array) -> tuple[Array, Array]:
        """Return the effective modulus over E*, and depths [m] of growing contacts of equal size.

        Both have shape (n,) or (k, n), for paths of depths [m]; the contact is that without
        tension.
        """
        names = [*quantities(type(self))]
        columns = [np.reshape(getattr(self, name), (-1,)) for name in names]
        columns.append(np.reshape(contact.length if self.sees_tension else 0.0, (-1,)))
        count = max(len(path) if path.ndim > 1 else 1, *(column.size for column in columns))
        paths = np.broadcast_to(path, (count, path.shape[-1]))
        values = np.array([np.broadcast_to(column, count) for column in columns]).T
        # Trials of a modulus alone have one course.
        alone = contact.is_bare and isinstance(contact.size, float)
        keys = [
            (p.tobytes(), v.tobytes()) if alone else i
            for i, (p, v) in enumerate(zip(paths, values, strict=True))
        ]
        first = {key: row for row, key in reversed([*enumerate(keys)])}
        rows = np.array([*first.values()])
        numbers = {key: number for number, key in enumerate(first)}
        courses = []
        # Of another contact rows belong together, each with its own.
        for part in np.array_split(rows, -(-rows.size // _TOGETHER) if alone else 1):
            *own, length = values[part].T[:, :, None, None]
            known = self.model_copy(update=dict(zip(names, own, strict=True)))
            courses.append(known._course(contact, length, curve, paths[part]))
        shares, depths = (np.concatenate(parts) for parts in zip(*courses, strict=True))
        back = np.array([numbers[key] for key in keys])
        if path.ndim == 1 and count == 1:
            return shares[0], depths[0]
        return shares[back], depths[back]

    def _course(
        self, contact: Contact, length: Array, curve: Curve, depth: Array
    ) -> tuple[Array, Array]:
        """Return the same of paths of shape (k, n), with quantities of shape (k, 1, 1).

        ``length`` is one of them: the elastocapillary length [m].
        """
        loading, clock = ~curve.moves_out, curve.clock
        time, whole = clock[loading], depth
        z = np.maximum.accumulate(depth[:, loading], axis=1)
        touches = z[:, -1:] > _NO_TOUCH * np.ptp(z, axis=1, keepdims=True)
        # A path without a touch, which counts for nothing, is raised until it has one.
        lift = np.where(touches, 0.0, _GRAZING * np.ptp(z, axis=1, keepdims=True) - z[:, -1:])
        z, depth = z + lift, depth + lift
        before = time[0] - z[:, 0] * np.ptp(time) / np.maximum(np.ptp(z, axis=1), 1e-300)
        crossing = np.array([np.interp(0.0, row, time) for row in z])
        start, end = np.where(z[:, 0] <= 0, crossing, before)[:, None], time[-1]
        # Dense after first touch, and after the start of a dwell, where the path bends most.
        way = z / np.maximum(z[:, -1:], 1e-300) - (time - start) / np.maximum(end - start, 1e-300)
        way = np.where(time > start, way, -np.inf)
        top = time[np.argmax(way, axis=1)][:, None]
        dwells = (end - top >= 0.1 * (top - start)) & (way.max(axis=1, keepdims=True) > _BENT)
        bends, top = top[:, 0], np.full_like(top, end)
        for k in np.flatnonzero(dwells).tolist():
            # Of a trial that touches as it dwells, nodes would be one within rounding.
            least = start[k] + _BRIEFEST * (end - start[k])
            top[k] = np.maximum(_turn(time, z[k], start[k, 0], bends[k]), least)
        ramp = np.linspace(0, 1, _FEW_NODES if curve.is_rough else _NODES)
        nodes = start + (top - start) * ramp**2
        if dwells.any():
            nodes = np.append(nodes, top + (end - top) * ramp[1:] ** 2, axis=1)
        path = np.empty_like(nodes)
        for k, row in enumerate(z):
            first = ([], []) if row[0] <= 0 else (start[k], [0.0])
            path[k] = np.interp(nodes[k], np.append(first[0], time), np.append(first[1], row))
        under: Any = length[:, :, 0]
        area = np.broadcast_to(contact.area(path, under), path.shape)
        bare = replace(contact, modulus=1.0, tension=0.0)
        weights = self._growing(nodes, partial(bare.radius, path), length)
        share = np.einsum("kat,kt->ka", weights, _rates(nodes, area))
        share = np.log(np.maximum(share / np.maximum(area[:, 1:], 1e-300), 1e-12))
        earliest = _EARLIEST * (nodes[:, -1:] - start)
        at, known = np.log(np.maximum(clock - start, earliest)), np.log(nodes[:, 1:] - start)
        shares = np.exp([np.interp(*row) for row in zip(at, known, share, strict=True)])
        if curve.moves_out.any():
            out = curve.moves_out
            back = clock[out], depth[:, out]
            shares[:, out], depth[:, out] = self._shrinking(nodes, path, area, back, ramp)
        return np.where(touches, shares, 1.0), np.where(touches, depth, whole)

    def _shrinking(
        self, t: Array, z: Array, area: Array, back: tuple[Array, Array], ramp: Array
    ) -> tuple[Array, Array]:
        """Return the same while the contact shrinks, for ``back``: times [s] and depths [m].

        The loading has times t [s], depths z [m] and F/E* [m²], all of shape (k, nodes).
        ∫ E(t − t′) dδ from the time of equal contact on is 0.
        """
        turn, end = t[0, -1], back[0][-1]
        u = turn + (end - turn) * ramp[1:] ** 1.5
        out, before = np.append(turn, u), np.append(turn, back[0])
        ways = np.append(z[:, -1:], back[1], axis=1)
        down = np.array([np.interp(out, before, way) for way in ways])
        weights = self._weights(u[None], t)
        own = self._weights(u[None], out[None])
        unloaded = np.einsum("kat,kt->ka", own, _rates(out[None], down))
        none = np.zeros((len(t), u.size, 1))
        by_depth = weights * _rates(t, z)[:, None]
        to_end = np.append(none, np.cumsum(by_depth[:, :, ::-1], axis=2), axis=2)
        force = np.append(none, np.cumsum(weights * _rates(t, area)[:, None], axis=2), axis=2)
        index, part = _at(to_end, -unloaded)
        earlier = _between(t[:, ::-1], index, part)
        index, part = _at(t[:, None], earlier)
        left, right = (
            np.take_along_axis(force, i[:, :, None], 2)[:, :, 0] for i in (index, index + 1)
        )
        total = left + part * (right - left)
        grown_area, equal = _between(area, index, part), _between(z, index, part)
        counts = grown_area > 1e-9 * area[:, -1:]
        first = np.einsum("kat,kt->ka", self._weights(t[:, -1:], t), _rates(t, area)) / area[:, -1:]
        share = np.append(
            first, np.where(counts, total / np.where(counts, grown_area, 1.0), 0.0), axis=1
        )
        # As the contact ends, the modulus is the last that there was.
        counts = np.append(np.ones_like(counts[:, :1]), counts, axis=1)
        last = np.maximum.accumulate(np.where(counts, np.arange(share.shape[1]), 0), axis=1)
        share = np.take_along_axis(share, last, axis=1)
        equal = np.append(z[:, -1:], equal, axis=1)
        index = np.clip(np.searchsorted(out, back[0]) - 1, 0, out.size - 2)
        step = np.where(out[index + 1] > out[index], out[index + 1] - out[index], 1.0)
        part = np.clip((back[0] - out[index]) / step, 0.0, 1.0)
        return tuple(v[:, index] + part * (v[:, index + 1] - v[:, index]) for v in (share, equal))

    def _growing(self, nodes: Array, radius: Callable[[], Array], length: Array) -> Array:
        """Return the weights at the nodes [s] but the first of a loading.

        ``radius`` gives that of the contact without tension at all nodes [m], and ``length`` is the
        elastocapillary length [m].
        """
        return self._weights(nodes[:, 1:], nodes)

    def _weights(self, at: Array, times: Array) -> Array:
        """Return ∫ E(t − t′) dt′ / E* [s] over intervals of times, of shape (k, at, intervals)."""
        sums = self.primitive(np.maximum(at[:, :, None] - times[:, None, :], 0.0))
        return -np.diff(sums, axis=2)


def _turn(time: Array, depth: Array, start: float, bend: float) -> float:
    """Return when a path turns into its dwell, no later than where it is furthest from straight.

    There the velocity falls most, from a while before to as long after.
    """
    reach = _WHILE * max(bend - start, 0.0)
    before, after = (np.interp(time + way, time, depth) for way in (-reach, reach))
    falls = np.where((time > start) & (time <= bend), 2 * depth - before - after, -np.inf)
    return float(time[np.argmax(falls)])


@cache
def _sine_weights() -> tuple[Array, ComplexArray]:
    """Return times tω, and weights by which ω ∫ E dt at these makes the modulus E*(ω).

    They are those of least squares over relaxation by one time, of which every law is made
    (Schwarzl 1971): the error is 1e-6 of E(0).
    """
    times, u = np.geomspace(*_SINE_TIMES), np.geomspace(*_SINE_RELAXATION)
    matrix = -u[:, None] * np.expm1(-times / u[:, None])
    weights = np.linalg.pinv(matrix, rcond=1e-10) @ (1j * u / (1 + 1j * u))
    return times, np.asarray(weights, dtype=complex)


def _between(rows: Array, index: NDArray[np.intp], part: Array) -> Array:
    """Return values between an entry of each row, of shape (k, entries), and the next."""
    left, right = (np.take_along_axis(rows, i, axis=1) for i in (index, index + 1))
    return left + part * (right - left)


def _at(rows: Array, values: Array) -> tuple[NDArray[np.intp], Array]:
    """Return where a value lies in each growing row: after which entry, and by which part."""
    index = np.clip((rows < values[:, :, None]).sum(axis=2) - 1, 0, rows.shape[2] - 2)
    if rows.shape[1] == 1:
        left, right = (np.take_along_axis(rows[:, 0], i, axis=1) for i in (index, index + 1))
    else:
        left, right = (
            np.take_along_axis(rows, i[:, :, None], 2)[:, :, 0] for i in (index, index + 1)
        )
    return index, np.clip((values - left) / np.maximum(right - left, 1e-300), 0.0, 1.0)


def _rates(times: Array, values: Array) -> Array:
    """Return slopes between neighbours; 0 where no time passes."""
    steps = np.diff(times, axis=-1)
    return np.where(steps > 0, np.diff(values, axis=-1) / np.maximum(steps, 1e-300), 0.0)
