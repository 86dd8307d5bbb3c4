"""How wide an indenter is at a depth: the grid that its contact needs."""

from __future__ import annotations

import numpy as np

from pellicle.components import Indenter
from pellicle.errors import ConfigError
from pellicle.grid import Grid

_CELLS = 129
_CLOSE = 0.95
_WIDEST = 1e9


def half_widths(indenter: Indenter, depth: float) -> tuple[float, float]:
    """Return how far along x and y [m] an indenter is below the undeformed surface at a depth.

    Contact lies within where nothing but the indenter pushes the surface down and no pressure lifts
    it, as on a half-space.

    Raises
    ------
    ConfigError
        The indenter is that wide nowhere near.
    """
    half = (depth, depth)
    while True:
        x, y = Grid(points=_CELLS, size=(2 * half[0], 2 * half[1])).coordinates()
        below = np.asarray(indenter.profile(x, y)) >= -depth
        reach = [
            float(np.max(np.abs(np.broadcast_to(at, below.shape)[below]), initial=0.0))
            for at in (x, y)
        ]
        edge = [float(np.max(np.abs(at))) for at in (x, y)]
        if any(r >= e for r, e in zip(reach, edge, strict=True)):
            half = tuple(  # type: ignore[assignment]
                2 * h if r >= e else h for h, r, e in zip(half, reach, edge, strict=True)
            )
            if max(half) > _WIDEST * depth:
                raise ConfigError(
                    f"is less than {depth:g} m high out to {max(half):.2g} m; give one whose "
                    "contact ends",
                    "indenter",
                )
            continue
        fitted = tuple(r + h / _CELLS for r, h in zip(reach, half, strict=True))
        if all(f >= _CLOSE * h for f, h in zip(fitted, half, strict=True)):
            return fitted[0], fitted[1]
        # Never less than one cell, so that it cannot shrink past the shape at once.
        half = tuple(max(f * 1.02, 2 * h / _CELLS) for f, h in zip(fitted, half, strict=True))  # type: ignore[assignment]
