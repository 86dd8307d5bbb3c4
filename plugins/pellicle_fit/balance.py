"""Depths at which a solid and what is in series with it push alike."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pellicle.arrays import Array

_BALANCE, _HALVED, _LOST = 1e-5, 1e-9, 1e-3
"""Last step over the largest way: of Newton's method, which leaves about its square, and one more
step the square of that; of halvings; and of what does not balance."""
DIFFERENCE = 1e-6
"""Step of slopes by √δ over the root of that way."""
_LONGEST, _FAR = 4.0, 1e6
"""Longest step, over the root of the depth or of the way, and the greatest root over the latter."""
_STEPS, _SECANTS = 80, 8
"""Most steps of a search for a balance, and those by secants; then slopes are sought."""


def balance_depths(
    pushed: Callable[[Array], Array], give: Callable[[Array], Array], base: Array, start: Array
) -> tuple[Array, Array]:
    """Return the depth δ [m] at which δ + u(P(δ)) is that of the base, and P, of shape (k, n).

    The sum grows with δ, so that there is one root, which secants find from a good start, and else
    Newton's method; a step that leaves what brackets it halves that.  NaN if there is no root.
    """
    way = np.sqrt(max(float(np.max(np.ptp(base, axis=-1))), 1e-300))
    step, far = DIFFERENCE * way, _FAR * way

    def depth_of(root: Array) -> Array:
        return root * np.abs(root)

    def excess(root: Array) -> tuple[Array, Array]:
        depth = depth_of(root)
        force = pushed(depth)
        return depth + give(force) - base, force

    # In √δ a toe that is infinitely soft at first touch has a slope.
    root = np.sign(start) * np.sqrt(np.abs(start))
    above, force = excess(root)
    slope = (excess(root + step)[0] - above) / step
    low, high = np.full(base.shape, -far), np.full(base.shape, far)
    for number in range(_STEPS):
        low, high = np.where(above < 0, root, low), np.where(above > 0, root, high)
        longest = _LONGEST * np.maximum(np.abs(root), way)
        move = -np.clip(above / np.maximum(slope, 1e-6 * step), -longest, longest)
        is_out = (root + move < low) | (root + move > high)
        move = np.where(is_out, (low + high) / 2 - root, move)
        change = np.abs(depth_of(root + move) - depth_of(root))
        root, before = root + move, above
        above, force = excess(root)
        if np.all(change <= np.where(is_out, _HALVED, _BALANCE) * way**2):
            break
        if number < _SECANTS:
            is_far = np.abs(move) > step
            slope = np.where(is_far, (above - before) / np.where(is_far, move, 1.0), slope)
        else:
            slope = (excess(root + step)[0] - above) / step
    # Without a root halvings end at the end of the bracket.
    is_lost = (np.abs(root) >= 0.99 * far) | (change > _LOST * way**2)
    return np.where(is_lost, np.nan, depth_of(root)), force
