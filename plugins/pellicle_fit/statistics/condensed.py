"""Least squares over all rows of a curve from a model that is evaluated at some of them.

Between neighbouring nodes, which are rows, a smooth model is linear to 1e-6 of the largest force.
With the matrix L of that interpolation and the Cholesky factor RᵀR = LᵀL, the sum of squares
|Lm − f|² over all rows is |Rm − R⁻ᵀLᵀf|² plus a constant: no information of the rows is lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky_banded

from pellicle.arrays import Array

Rows = NDArray[np.intp]
"""Indices of rows."""
_NEAR = 0.1
"""Distance from the contact point, over the range of positions, within which nodes are denser."""
_FEWEST = 4
"""Least number of evenly spaced nodes of a group."""


@dataclass(frozen=True, eq=False)
class Condensation:
    """Nodes of a curve, and the sum of squares over all rows as a function of values there."""

    nodes: Rows
    """The rows at which the model is evaluated, increasing, of shape (k,)."""
    before: Rows
    """Index among the nodes of the one before each row, of shape (n,)."""
    after: Rows
    """That of the one after it."""
    share: Array
    """Weight of the node after each row, of shape (n,)."""
    following: Rows
    """Index of the node that follows each node in its group, or its own at the end."""
    factor: tuple[Array, Array]
    """Diagonal and superdiagonal of R, each of shape (k,)."""
    target: Array
    """R⁻ᵀLᵀf [N], of shape (k,)."""
    remainder: float
    """Root of the sum of squares [N] that no values at the nodes explain."""

    @classmethod
    def of(
        cls, groups: Sequence[tuple[Rows, Array, float | None]], force: Array, count: int
    ) -> Condensation:
        """Return the condensation of rows in groups, within which a model is smooth.

        Each group has its rows, a coordinate that orders them, and where the model bends most; None
        stands for the first row.  Nodes number about twice ``count``.
        """
        size = force.size
        first, second = np.empty(size, dtype=np.intp), np.empty(size, dtype=np.intp)
        share, following = np.zeros(size), np.arange(size, dtype=np.intp)
        nodes = []
        for rows, coordinate, bend in groups:
            order = np.argsort(coordinate, kind="stable")
            x, index = np.unique(coordinate[order], return_index=True)
            representatives = rows[order][index]
            at = _nodes(x, bend, max(count * rows.size // size, _FEWEST))
            nodes.append(representatives[at])
            cell = np.clip(np.searchsorted(x[at], coordinate, side="right") - 1, 0, at.size - 1)
            after = np.minimum(cell + 1, at.size - 1)
            first[rows], second[rows] = representatives[at][cell], representatives[at][after]
            width = x[at][after] - x[at][cell]
            share[rows] = np.where(
                width > 0, (coordinate - x[at][cell]) / np.where(width > 0, width, 1.0), 0.0
            )
            following[representatives[at][:-1]] = representatives[at][1:]
        sequence = np.concatenate(nodes)
        place = np.empty(size, dtype=np.intp)
        place[sequence] = np.arange(sequence.size)
        before, after = place[first], place[second]
        diagonal = np.bincount(before, (1 - share) ** 2, sequence.size)
        diagonal += np.bincount(after, share**2, sequence.size)
        beside = np.bincount(before, share * (1 - share), sequence.size)
        # In the order of the groups the matrix is tridiagonal.
        bands = np.array([np.append(0.0, beside[:-1]), diagonal])
        upper = cholesky_banded(bands)
        factor = upper[1], np.append(upper[0, 1:], 0.0)
        target = np.bincount(before, (1 - share) * force, sequence.size).astype(np.float64)
        target += np.bincount(after, share * force, sequence.size)
        for node in range(target.size):
            carried = factor[1][node - 1] * target[node - 1] if node else 0.0
            target[node] = (target[node] - carried) / factor[0][node]
        remainder = float(np.sqrt(max(float(force @ force - target @ target), 0.0)))
        return cls(
            sequence, before, after, share, place[following[sequence]], factor, target, remainder
        )

    def error(self, force: Array) -> float:
        """Return the root of the sum of squared errors of the interpolation of a force [N]."""
        values = force[self.nodes]
        rows = (1 - self.share) * values[self.before] + self.share * values[self.after]
        return float(np.linalg.norm(rows - force))

    def residuals(self, force: Array, jacobian: Array) -> tuple[Array, Array]:
        """Return residuals [N] with the sum of squares of all rows, and their derivatives."""
        diagonal, beside = self.factor
        residuals = diagonal * force + beside * force[self.following] - self.target
        derivatives = diagonal[:, None] * jacobian
        derivatives += beside[:, None] * jacobian[self.following]
        return (
            np.append(residuals, self.remainder),
            np.concatenate([derivatives, np.zeros((1, jacobian.shape[1]))]),
        )


def _nodes(x: Array, bend: float | None, count: int) -> Rows:
    """Return the indices of nodes among increasing coordinates, the first and last among them."""
    low, high = float(x[0]), float(x[-1])
    if bend is None:
        targets = low + (high - low) * np.linspace(0, 1, 2 * count) ** 2
    else:
        near = bend + _NEAR * (high - low) * np.linspace(-1, 1, count)
        targets = np.concatenate([np.linspace(low, high, count), np.clip(near, low, high)])
    index = np.clip(np.searchsorted(x, targets), 0, x.size - 1)
    return np.unique(np.concatenate([[0], index, [x.size - 1]]))
