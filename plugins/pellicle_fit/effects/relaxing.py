"""Solids that relax: Lee & Radok (1960) while the contact grows, Ting (1966) while it shrinks."""

from abc import abstractmethod
from dataclasses import replace

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from pellicle_fit.effect import Array, Contact, Curve, Responds, Response

_NODES = 97
"""Nodes of the path while the indenter moves in; as many where it dwells or moves out."""
_MODULI = 6
"""Effective moduli between which the force under a tension is interpolated."""
_BESIDE_TENSION = 0.03
"""Error of the effective modulus beside a tension, against solutions of the whole problem."""
_EARLIEST = 1e-4
"""Least time in contact over that of the loading; before it the response is that of then."""


class Relaxing(Responds):
    """Solid whose modulus falls; a tension does not, and acts with the effective modulus."""

    @abstractmethod
    def primitive(self, time: Array) -> Array:
        """Return ∫ E(t) dt / E* from 0 to times [s]."""

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse curves without a loading, and beside a tension those that unload."""
        if curve.moves_out.all():
            return "the loading is not in the curve"
        unloads = "tension" in beside and curve.moves_out.any()
        return "beside a tension there is no theory of unloading" if unloads else ""

    def accuracy(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> float:
        """Return the error of the force over the largest one."""
        return _BESIDE_TENSION if contact.tension else 1e-4

    def response(self, contact: Contact, curve: Curve, path: Array, softness: float) -> Response:
        """Return the force as a function of the depth."""
        share, equal = self._course(replace(contact, tension=0.0), curve, path)

        def response(depth: Array) -> Array:
            # While the contact shrinks, the path decides.
            depth = np.where(curve.moves_out, equal, depth)
            if contact.tension:
                return self._tensed(contact, share, depth)
            return share * contact.force(depth)

        return response

    def _tensed(self, contact: Contact, share: Array, depth: Array) -> Array:
        """Return the force [N] of effective moduli, given over E*, under tension."""
        # The force over the effective modulus is a polynomial in the logarithm of that.
        at = np.log(share)
        middle, half = (at.max() + at.min()) / 2, max(np.ptp(at) / 2, 1e-12)
        nodes = chebyshev.chebpts1(_MODULI)
        moduli = np.exp(middle + half * nodes)
        forces = np.array(
            [replace(contact, modulus=contact.modulus * m).force(depth) / m for m in moduli]
        )
        coefficients = chebyshev.chebfit(nodes, forces, _MODULI - 1)
        basis = chebyshev.chebvander((at - middle) / half, _MODULI - 1)
        return np.asarray(share * np.sum(basis * coefficients.T, axis=1))

    def _course(self, contact: Contact, curve: Curve, depth: Array) -> tuple[Array, Array]:
        """Return the effective modulus over E*, and depths [m] of growing contacts of equal size.

        Both are of shape (n,), for a path of depths [m]; the contact is that without tension.
        """
        loading = ~curve.moves_out
        time, z = curve.clock[loading], np.maximum.accumulate(depth[loading])
        if z[-1] <= 0:
            return np.ones_like(depth), depth
        start = np.interp(0.0, z, time) if z[0] <= 0 else time[0] - z[0] * np.ptp(time) / np.ptp(z)
        later = time > start
        times, z = np.append(start, time[later]), np.append(0.0, z[later])
        # Dense after first touch, and after the start of a dwell.
        top, end = times[int(np.argmax(z >= 0.98 * z[-1]))], times[-1]
        ramp = np.linspace(0, 1, _NODES)
        if end - top < 0.1 * (top - start):
            top = end
        nodes: Array = start + (top - start) * ramp**2
        if top < end:
            nodes = np.append(nodes, top + (end - top) * ramp[1:] ** 2)
        path = np.interp(nodes, times, z)
        area: Array = contact.area(path, 0.0)
        weights = self._weights(nodes[1:], nodes)
        share = (weights @ _rates(nodes, area)) / np.maximum(area[1:], 1e-300)
        earliest = _EARLIEST * (nodes[-1] - start)
        at = np.log(np.maximum(curve.clock - start, earliest))
        shares = np.exp(np.interp(at, np.log(nodes[1:] - start), np.log(np.maximum(share, 1e-12))))
        if curve.moves_out.any():
            rows = curve.moves_out
            depth = depth.copy()
            back = curve.clock[rows], depth[rows]
            shares[rows], depth[rows] = self._shrinking(nodes, path, area, back)
        return shares, depth

    def _shrinking(
        self, t: Array, z: Array, area: Array, back: tuple[Array, Array]
    ) -> tuple[Array, Array]:
        """Return the same while the contact shrinks, for ``back``: times [s] and depths [m].

        The loading has times t [s], depths z [m] and F/E* [m²].  ∫ E(t − t′) dδ from the time of
        equal contact on is 0.
        """
        end = back[0][-1]
        u = t[-1] + (end - t[-1]) * np.linspace(0, 1, _NODES)[1:] ** 1.5
        out = np.append(t[-1], u)
        down = np.interp(out, np.append(t[-1], back[0]), np.append(z[-1], back[1]))
        weights = self._weights(u, t)
        unloaded = (self._weights(u, out) * _rates(out, down)).sum(axis=1)
        none = np.zeros((u.size, 1))
        to_end = np.append(none, np.cumsum((weights * _rates(t, z))[:, ::-1], axis=1), axis=1)
        force = np.append(none, np.cumsum(weights * _rates(t, area), axis=1), axis=1)
        row = np.arange(u.size)
        index, part = _at(to_end, -unloaded)
        back_in_time = t[::-1]
        earlier = back_in_time[index] + part * (back_in_time[index + 1] - back_in_time[index])
        index, part = _at(np.broadcast_to(t, force.shape), earlier)
        total = force[row, index] + part * (force[row, index + 1] - force[row, index])
        grown_area = np.interp(earlier, t, area)
        counts = grown_area > 1e-9 * area[-1]
        first = (self._weights(t[-1:], t) @ _rates(t, area))[0] / area[-1]
        share = np.append(first, np.where(counts, total / np.where(counts, grown_area, 1.0), 0.0))
        # As the contact ends, the modulus is the last that there was.
        last = np.maximum.accumulate(np.where(np.append(True, counts), np.arange(share.size), 0))
        share, equal = share[last], np.append(z[-1], np.interp(earlier, t, z))
        return np.interp(back[0], out, share), np.interp(back[0], out, equal)

    def _weights(self, at: Array, times: Array) -> Array:
        """Return ∫ E(t − t′) dt′ / E* [s] over the intervals of times, of shape (at, intervals)."""
        sums = self.primitive(np.maximum(at[:, None] - times[None, :], 0.0))
        return -np.diff(sums, axis=1)


def _at(rows: Array, values: Array) -> tuple[NDArray[np.intp], Array]:
    """Return where a value lies in each growing row: after which entry, and by which part."""
    index = np.clip((rows < values[:, None]).sum(axis=1) - 1, 0, rows.shape[1] - 2)
    row = np.arange(values.size)
    left, right = rows[row, index], rows[row, index + 1]
    return index, np.clip((values - left) / np.maximum(right - left, 1e-300), 0.0, 1.0)


def _rates(times: Array, values: Array) -> Array:
    """Return slopes between neighbours; 0 where no time passes."""
    steps = np.diff(times)
    return np.where(steps > 0, np.diff(values) / np.maximum(steps, 1e-300), 0.0)
