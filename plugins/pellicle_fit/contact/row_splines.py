"""Cubic splines of many rows at once, each through nodes of its own."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array


class RowSplines:
    """Splines through values at growing nodes, of shape (k, nodes), not-a-knot (de Boor 1978)."""

    def __init__(self, nodes: Array, values: Array) -> None:
        from scipy.linalg import solve_banded

        self.nodes, self.values = nodes, values
        step = np.diff(nodes)
        rise = np.diff(values) / step
        # The slopes of all rows are one system, in which rows have nothing to do with each other.
        bands, right = np.zeros((3, *nodes.shape)), np.zeros(nodes.shape)
        bands[1, :, 1:-1] = 2 * (step[:, :-1] + step[:, 1:])
        bands[0, :, 2:], bands[2, :, :-2] = step[:, :-1], step[:, 1:]
        right[:, 1:-1] = 3 * (step[:, 1:] * rise[:, :-1] + step[:, :-1] * rise[:, 1:])
        for end, near, off, band in ((0, 0, 1, 0), (-1, -1, -2, 2)):
            far = step[:, near] + step[:, off]
            bands[1, :, end] = step[:, off]
            bands[band, :, 1 if end == 0 else -2] = far
            right[:, end] = (
                (step[:, near] + 2 * far) * step[:, off] * rise[:, near]
                + step[:, near] ** 2 * rise[:, off]
            ) / far
        flat = bands.reshape(3, -1)
        self.slopes = solve_banded((1, 1), flat, right.ravel()).reshape(nodes.shape)
        self._rows = np.arange(len(nodes))[:, None]
        self._bottom, self._size = nodes[:, :1], nodes[:, -1:] - nodes[:, :1]
        self._scaled = ((nodes - self._bottom) / self._size + 2 * self._rows).ravel()

    def __call__(self, at: Array) -> Array:
        """Return the values at points of each row, of shape (k, n)."""
        count = self.nodes.shape[1]
        scaled = (at - self._bottom) / self._size + 2 * self._rows
        index = np.searchsorted(self._scaled, scaled) - 1 - count * self._rows
        index = np.clip(index, 0, count - 2) + count * self._rows
        x, y, slope = (of.ravel() for of in (self.nodes, self.values, self.slopes))
        step = x.take(index + 1) - x.take(index)
        u = (at - x.take(index)) / step
        first, last = y.take(index), y.take(index + 1)
        bend = step * slope.take(index) - (last - first)
        end_slope = (last - first) - step * slope.take(index + 1)
        bent = u * (1 - u) * ((1 - u) * bend + u * end_slope)
        return np.asarray(first + u * (last - first) + bent)
