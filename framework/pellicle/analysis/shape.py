"""The shape of a contact: its patches, its ellipse and border, and the slopes in it."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, hypot, nan, pi
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pellicle.arrays import Array, Mask
from pellicle.contact.masks import Labels, label_parts
from pellicle.grid import Grid
from pellicle.surface.convolution import blocks

# Resultant of unit vectors below which a contact has no circular mean.
_NO_CENTRE = 1e-6
# Cells in a block of rows, few enough for its slopes to take no memory to speak of.
_BLOCK = 2**13


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
    labels, count = label_parts(np.asarray(contact, dtype=bool), grid.boundary, connectivity)
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


@dataclass(frozen=True)
class Ellipse:
    """An ellipse in the plane of the surface."""

    x: float
    """Centre along x [m]."""
    y: float
    """Centre along y [m]."""
    semi_major_axis: float
    """Major semi-axis [m]."""
    semi_minor_axis: float
    """Minor semi-axis [m]."""
    angle: float
    """Angle from the x axis to the major axis [rad], −π/2 to π/2; arbitrary for a circle."""


def ellipse(contact: ArrayLike, grid: Grid) -> Ellipse:
    """Return the ellipse with the centroid and the second moments of a contact, bool (nx, ny).

    A full ellipse with semi-axes a₁ ≥ a₂ has the principal second moments a₁²/4 and a₂²/4 per
    area. Cells count as rectangles, so that a single cell has an extent. Without contact the
    semi-axes are 0, centre and angle NaN. On a periodic grid positions are relative to the circular
    mean of the contact along each axis. If that is undefined, as in full contact or a line contact,
    all values are NaN.
    """
    inside = np.asarray(contact, dtype=bool)
    if not inside.any():
        return Ellipse(nan, nan, 0.0, 0.0, nan)
    x, y = (points.ravel() for points in grid.coordinates())
    along = inside.sum(axis=1, dtype=np.float64), inside.sum(axis=0, dtype=np.float64)
    centre = [0.0, 0.0]
    if grid.boundary == "periodic":
        centre = list(map(_circular_mean, (x, y), along, grid.size))
        if np.isnan(centre).any():
            return Ellipse(nan, nan, nan, nan, nan)
    x, y = (
        _wrapped(points - middle, length) if grid.boundary == "periodic" else points
        for points, middle, length in zip((x, y), centre, grid.size, strict=True)
    )
    mean_x, mean_y = np.average(x, weights=along[0]), np.average(y, weights=along[1])
    x, y = x - mean_x, y - mean_y
    dx, dy = grid.spacing
    xx = float(np.average(x**2, weights=along[0])) + dx**2 / 12
    yy = float(np.average(y**2, weights=along[1])) + dy**2 / 12
    xy = float(x @ (inside @ y)) / along[0].sum()
    minor, major = np.linalg.eigvalsh([[xx, xy], [xy, yy]])
    return Ellipse(
        x=float(_wrapped(np.asarray(centre[0] + mean_x), grid.size[0])),
        y=float(_wrapped(np.asarray(centre[1] + mean_y), grid.size[1])),
        semi_major_axis=2 * float(np.sqrt(major)),
        semi_minor_axis=2 * float(np.sqrt(max(minor, 0.0))),
        angle=atan2(2 * xy, xx - yy) / 2,
    )


def _circular_mean(points: Array, weights: Array, length: float) -> float:
    """Return the circular mean of positions of a period; NaN if it is undefined."""
    if points.size == 1:
        return nan
    resultant = np.average(np.exp(2j * pi / length * points), weights=weights)
    return nan if abs(resultant) < _NO_CENTRE else float(np.angle(resultant)) * length / (2 * pi)


def _wrapped(points: Array, length: float) -> Array:
    """Return the periodic images of points within half a period of 0."""
    return points - length * np.round(points / length)


def perimeter(contact: ArrayLike, grid: Grid) -> float:
    """Return the length of the border of a contact [m].

    It is computed from the number of switches between contact and no contact along the two axes and
    the two diagonals of the cells (Cauchy–Crofton; Legland, Kiêu & Devaux 2007). For an isotropic
    border, such as that of a disc, it is right on average; for a straight border on square cells it
    is at most 5.2 % too short (along an axis) or 2.6 % too long. The total length of cell edges
    between contact and no contact would be 27 % too long for a disc; it is returned on a grid one
    cell across, where borders are parallel to an axis.

    On a free boundary the edge of the domain counts as border where there is contact; on a periodic
    one it does not. ``contact`` is bool, of shape (nx, ny).
    """
    inside = np.asarray(contact, dtype=bool)
    if grid.boundary == "free":
        inside = np.pad(inside, 1)
    dx, dy = grid.spacing

    def switches(step: tuple[int, int]) -> int:
        """Return the number of switches of contact between cells and those one step away."""
        # A contact on a free boundary has been padded, so it can be treated as periodic.
        return int(np.count_nonzero(inside != np.roll(inside, step, (0, 1))))

    if 1 in grid.shape:
        return dy * switches((1, 0)) + dx * switches((0, 1))
    slope = atan2(dy, dx)
    across = dx * dy / hypot(dx, dy)
    # Step to the next cell; distance between parallel lines; angle represented by the direction.
    directions = (
        ((1, 0), dy, slope),
        ((0, 1), dx, pi / 2 - slope),
        ((1, 1), across, pi / 4),
        ((1, -1), across, pi / 4),
    )
    return sum(angle * between * switches(step) / 2 for step, between, angle in directions)


def steepest(profile: Array, contact: Mask, grid: Grid) -> float:
    """Return the largest slope of an indenter in contact, in any direction.

    It is the largest gradient between four cells in contact that meet in a corner, or slope between
    two neighbours if that is larger, as on the ridge of a roof or in a contact one cell wide. The
    ``profile`` [m] and ``contact``, bool, have the grid's shape.
    """
    largest = 0.0
    for block in blocks(contact.shape[0], max(1, _BLOCK // contact.shape[1])):
        # With the first row of the next block, so that no slope between two is left out.
        rows = slice(block.start, block.stop + 1)
        heights = np.where(contact[rows], profile[rows], np.nan)
        by_x, by_y = (np.diff(heights, axis=n) / width for n, width in enumerate(grid.spacing))
        at_corners = 0.5 * np.hypot(by_x[:, 1:] + by_x[:, :-1], by_y[1:] + by_y[:-1])
        for slopes in (np.abs(by_x), np.abs(by_y), at_corners):
            largest = float(np.fmax.reduce(slopes, axis=None, initial=largest))
    return largest
