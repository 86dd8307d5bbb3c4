"""Adhesion in equilibrium, under tension and with a cantilever."""

from collections.abc import Callable, Iterable
from functools import lru_cache
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Array, Mask
from pellicle_fit.contact.row_splines import RowSplines
from pellicle_fit.effect import Contact, Curve, Fitted, Responds, Response, Sizes, Values, fitted

_SEARCHED, _NODES = 61, 120
"""Contacts among which the end of a branch is sought, twice; nodes that describe it."""
_HIGHER = 10.0
"""How far above the first guess the other end is sought, in logarithms of the depth."""
_LEVEL = 1e-3
"""Relative rise of the position up to which it is that of the end of a branch."""
_DECADES = 7.0
"""How far below the largest contact the end is sought."""
_SHALLOW = 1e-6
"""Least depth down to which the branch is known, over the range of positions."""
_PENALTY = 30.0
"""Slope of the force below the end of the branch, over the mean slope of the curve."""
_RAMP = 4.0
"""Rows over which a touch that no jump tells comes about."""
_CHANGE_POINT = 3
"""Quantities as which the choice of the rows that touch counts (Ninomiya 2015)."""
_WIDTH, _JUMP = 3, 6.0
"""Rows whose means are compared, and standard errors beyond which they show a jump."""

_SAME = 1e-9
"""Difference of two nodes that is none, over the largest."""


class Adhesion(Responds):
    """Adhesive contact on its stable branch, which a cantilever ends where dF/dδ = −k.

    With force F₁, depth δ₁, stiffness k₁ and radius a of the contact without adhesion the
    equilibria are F = F₁ − k₁D, δ = δ₁ − D, D = √(4πa w / (dk₁/da)) (Johnson, Kendall & Roberts
    1971).  An approach touches at δ = 0; where the curve itself jumps, that decides, and else the
    touch comes about over a few rows, so that χ² is continuous.
    """

    type: Literal["adhesion"] = "adhesion"
    examples = ({}, {"work_of_adhesion": "10 uJ/m^2"})
    balances: ClassVar[bool] = True
    jumps: ClassVar[bool] = True
    work_of_adhesion: Annotated[float, Fitted("J/m2", above=0, log=True)] = fitted(
        "work of adhesion w [J/m2]"
    )

    def excuse(self, contact: Contact, curve: Curve, beside: frozenset[str]) -> str:
        """Refuse a contact without a radius."""
        known = contact.is_bare_indenter
        return "" if known else "needs an indenter with a contact radius on a half-space"

    def starts(self, sizes: Sizes) -> Iterable[Values]:
        """Yield little and much adhesion."""
        for share in (3e-4, 3e-3, 3e-2):
            yield {"work_of_adhesion": share * sizes.of("J/m2")}

    def searched(self, curve: Curve) -> int:
        """Return the cost of the rows that touch on passes where no jump tells them."""
        return _CHANGE_POINT * (len(curve.passes) - len(_jumps(curve)))

    def response(self, contact: Contact, curve: Curve, path: Array, softness: float) -> Response:
        """Return the force as a function of the base over the contact point."""
        # A search may try a contact point that no row reaches.
        deepest = np.maximum(np.max(path, axis=-1, keepdims=True), _SHALLOW * curve.span)
        position, force = (np.atleast_2d(x) for x in self._branch(contact, deepest, softness))
        end = position[:, :1]
        root, holds = np.sqrt(np.maximum(position - end, 0.0)), np.ones(end.shape, dtype=bool)
        grows = root[:, 1:] > np.maximum.accumulate(root, axis=1)[:, :-1] + _SAME * root[:, -1:]
        ahead = back = _splines(root, force, np.hstack([holds, grows]))
        if np.any(np.diff(root) < 0):
            # The edge of a worn tip: what is pulled off it jumps to it from a wider contact.
            wider = np.minimum.accumulate(root[:, ::-1], axis=1)[:, ::-1]
            grows = root[:, :-1] < wider[:, 1:] - _SAME * root[:, -1:]
            back = _splines(root, force, np.hstack([grows, holds]))
        ramp, jumping = _RAMP * curve.span / curve.passes[0].size, _jumps(curve)

        def response(depth: Array) -> Array:
            beyond = depth - end
            over = np.where(curve.moves_out, beyond, depth)
            touches, steep = np.clip(0.5 + over / ramp, 0.0, 1.0), np.zeros_like(beyond)
            for rows, touching in jumping:
                touches[:, rows] = touching
                penalty = _PENALTY * curve.largest / curve.span
                steep[:, rows] = penalty * np.minimum(beyond[:, rows], 0.0)
            at = np.sqrt(np.clip(beyond, 0.0, root[:, -1:] ** 2))
            along = ahead(at)
            if back is not ahead:
                along = np.where(curve.moves_out, back(at), along)
            force = touches * (along + steep)
            return np.asarray(force if depth.ndim > 1 or len(force) > 1 else force[0])

        return response

    def _branch(self, contact: Contact, deepest: Array, softness: float) -> tuple[Array, Array]:
        """Return `_equilibria` of the stable branch, from its end to a position of the base [m]."""

        def at(rows: Array, index: NDArray[np.intp]) -> Array:
            return np.take_along_axis(rows, index[..., None], axis=-1)

        scale = np.maximum(deepest, self.work_of_adhesion / contact.modulus)
        tops = np.log(scale) + np.arange(0, _HIGHER, 0.5)
        reaches = self._equilibria(contact, np.exp(tops), softness)[0] >= deepest
        reaches[..., -1] = True
        top = at(tops, np.argmax(reaches, axis=-1))
        first = top + np.linspace(-_DECADES * np.log(10), 0, _SEARCHED)
        position = self._equilibria(contact, np.exp(first), softness)[0]
        rise = position - position[..., :1]
        # The edge of a flat end holds the rim until the punch lets go, at the depth 0.
        level = np.abs(rise[..., 1]) < _LEVEL * np.abs(position[..., 0])
        edge = (level & (rise.min(axis=-1) >= 0))[..., None]
        least = np.argmin(position, axis=-1)
        low = at(first, np.maximum(least - 1, 0))
        high = at(first, np.minimum(least + 1, _SEARCHED - 1))
        grid = low + (high - low) * np.linspace(0, 1, _SEARCHED)
        position = self._equilibria(contact, np.exp(grid), softness)[0]
        # The end is that of the parabola through the least and those beside it.
        least = np.clip(np.argmin(position, axis=-1), 1, _SEARCHED - 2)
        before, here, after = (at(position, least + step) for step in (-1, 0, 1))
        bend = np.maximum(before - 2 * here + after, 1e-300)
        share = np.clip((before - after) / (2 * bend), -1.0, 1.0)
        start = at(grid, least) + share * (high - low) / (_SEARCHED - 1)
        ramp = np.linspace(0, 1, _NODES)
        nodes = start + (top - start) * ramp**2
        if edge.any():
            leaves = at(first, np.argmax(rise > _LEVEL * rise[..., -1:], axis=-1))
            ends = leaves + (top - leaves) * np.linspace(0, 1, _NODES - 1)
            ends = np.concatenate([first[..., :1], ends], axis=-1)
            nodes = np.where(edge, ends, nodes)
        return self._equilibria(contact, np.exp(nodes), softness)

    def _equilibria(self, contact: Contact, depth: Array, softness: float) -> tuple[Array, Array]:
        """Return position of the base [m] and force [N] that without adhesion had depths [m]."""
        force, stiffness, radius, slope = contact.punch(depth)
        retraction = np.sqrt(4 * np.pi * self.work_of_adhesion * radius / slope)
        force = force - stiffness * retraction
        return depth - retraction + softness * force, force


def _splines(root: Array, force: Array, rising: Mask) -> Callable[[Array], Array]:
    """Return the forces over the root of the way from the end, at some nodes of each row."""
    from scipy.interpolate import CubicSpline

    if rising.all():
        return RowSplines(root, force)
    rows = zip(root, force, rising, strict=True)
    cubic_splines = [CubicSpline(way[some], of_way[some]) for way, of_way, some in rows]

    def splines(at: Array) -> Array:
        rows = np.broadcast_to(at, (len(cubic_splines), at.shape[-1]))
        return np.array([spline(row) for spline, row in zip(cubic_splines, rows, strict=True)])

    return splines


@lru_cache(maxsize=16)
def _jumps(curve: Curve) -> list[tuple[NDArray[np.intp], Mask]]:
    """Return, for each pass on which the force jumps, its rows and which of them touch.

    Deeper by one row, the force falls where the indenter snaps in and where it has not yet snapped
    off.
    """
    jumps = []
    for rows in curve.passes:
        if rows.size < 4 * _WIDTH:
            continue
        deeper = rows[np.argsort(curve.base[rows], kind="stable")]
        force = -curve.force[deeper]
        noise = 1.4826 / np.sqrt(6) * float(np.median(np.abs(np.diff(force, 2))))
        means = np.convolve(force, np.ones(_WIDTH) / _WIDTH, mode="valid")
        rises = means[_WIDTH:] - means[:-_WIDTH]
        first = int(np.argmax(rises))
        if rises[first] > max(_JUMP * noise * np.sqrt(2 / _WIDTH), 0.0):
            last = first + int(np.argmax(np.diff(force[first : first + 2 * _WIDTH])))
            jumps.append((deeper, np.arange(deeper.size) > last))
    return jumps
