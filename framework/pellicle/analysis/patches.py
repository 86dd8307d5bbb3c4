"""The connected patches of a contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pellicle.arrays import Array
from pellicle.contact.masks import Labels as Labels
from pellicle.contact.masks import labelled
from pellicle.grid import Grid


@dataclass(frozen=True)
class Patches:
    """The connected parts of a contact, in descending order of area."""

    labels: Labels
    """The patch of each cell, counted from 1, of the grid's shape; 0 where there is no contact."""
    area: Array
    """Area of each patch [m²]."""

    @property
    def count(self) -> int:
        """Number of patches."""
        return self.area.size


def patches(contact: ArrayLike, grid: Grid, connectivity: Literal[4, 8] = 4) -> Patches:
    """Return the patches of a contact, which is bool and of shape (nx, ny).

    With a ``connectivity`` of 4 cells that share an edge belong to one patch, with 8 those that
    share a corner do, too. On a periodic grid, patches that touch across the edge of the domain are
    one.
    """
    labels, count = labelled(np.asarray(contact, dtype=bool), grid.boundary, connectivity)
    cells = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    order = np.argsort(-cells, kind="stable")
    rank = np.zeros(count + 1, dtype=np.int64)
    rank[1:][order] = np.arange(1, count + 1)
    return Patches(rank[labels], np.asarray(cells[order] * grid.cell_area))


def coordination(labels: Labels, grid: Grid) -> NDArray[np.int64]:
    """Return the number of neighbours of each patch of `Patches.labels`, shape (patches,).

    Each cell of the surface is assigned to the nearest patch; patches whose regions have a cell
    edge in common are neighbours. On a periodic grid the regions meet across the edge of the
    domain, too; on a free one they end there, so that patches near the edge have fewer neighbours.
    A patch is not a neighbour of its own images. Where many patches fill a plane the mean number
    is close to 6 (Euler).
    """
    from scipy import ndimage

    count = int(labels.max(initial=0))
    if count == 0:
        return np.zeros(0, dtype=np.int64)
    nx, ny = grid.shape
    periodic = grid.boundary == "periodic"
    # Padding by half a period each way includes the nearest image of every patch.
    mx, my = (nx // 2, ny // 2) if periodic else (0, 0)
    empty = np.pad(labels == 0, ((mx, mx), (my, my)), mode="wrap" if periodic else "constant")
    i, j = ndimage.distance_transform_edt(
        empty, sampling=grid.spacing, return_distances=False, return_indices=True
    )[:, mx : mx + nx, my : my + ny]
    i -= mx
    i %= nx
    j -= my
    j %= ny
    regions = labels[i, j]
    # On a periodic grid these arrays take the memory of four fields.
    del empty, i, j
    # Pairs of different labels on both sides of a cell edge, (2, edges).
    edges = []
    for axis in (0, 1):
        pairs = np.stack([regions, np.roll(regions, -1, axis)])
        if not periodic:
            pairs = np.delete(pairs, -1, axis + 1)
        edges.append(pairs[:, pairs[0] != pairs[1]])
    neighbours = np.unique(np.sort(np.concatenate(edges, axis=1), axis=0), axis=1)
    return np.bincount(neighbours.ravel(), minlength=count + 1)[1:]
