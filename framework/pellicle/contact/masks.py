"""Sets of cells: their neighbours and their connected parts, also across a periodic edge."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pellicle.arrays import Mask
from pellicle.grid import Boundary

Labels = NDArray[np.int64]


def dilate(mask: Mask, boundary: Boundary = "periodic", cells: int = 1) -> Mask:
    """Return the cells of ``mask`` and those up to ``cells`` away along each axis.

    Cells across a corner are neighbours too. The mask has one or more axes; `scipy.ndimage` has no
    dilation of a periodic one.
    """
    for axis in range(mask.ndim):
        reach = 0
        while reach < cells:
            # A longer shift would leave a hole beside the edge of a free domain.
            shift = min(reach + 1, cells - reach)
            before, after = np.roll(mask, shift, axis), np.roll(mask, -shift, axis)
            if boundary == "free":
                np.moveaxis(before, axis, 0)[:shift] = False
                np.moveaxis(after, axis, 0)[-shift:] = False
            mask = mask | before | after
            reach += shift
    return mask


def label_parts(mask: Mask, boundary: Boundary, connectivity: Literal[4, 8]) -> tuple[Labels, int]:
    """Return the connected part of each cell, counted from 1, and the number of parts.

    Cells outside ``mask`` have the label 0. On a periodic grid parts that meet across the edge of
    the domain are one.
    """
    from scipy import ndimage
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    structure = ndimage.generate_binary_structure(2, 1 if connectivity == 4 else 2)
    labels, count = ndimage.label(mask, structure)
    if boundary == "free":
        return labels, count
    shifts = (0,) if connectivity == 4 else (-1, 0, 1)
    edges: list[Any] = []
    for lines in (labels, labels.T):
        edges += [np.stack([lines[0], np.roll(lines[-1], shift)]) for shift in shifts]
    pairs = np.concatenate(edges, axis=1)
    pairs = pairs[:, (pairs > 0).all(axis=0)]
    graph = coo_array((np.ones(pairs.shape[1], dtype=bool), tuple(pairs)), (count + 1, count + 1))
    # Label 0 is the first node and isolated, so it stays 0.
    joined, merged = connected_components(graph, directed=False)
    return merged.astype(np.int64)[labels], int(joined) - 1
