"""Images of the parameters fitted to the curves of force maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.files.measurement import Axis
from pellicle_fit.objective import CONTACT_POINT

from .row import ENDS, Row, units_of

if TYPE_CHECKING:
    import xarray as xr

CONTACT_HEIGHT = "contact_height"
"""Minus the contact point: the height of the surface over the zero of the instrument [m]."""
_OF_BASELINE = "offset", "slope"
_QUALITY = "r_squared", "chi_squared", "indentation", "largest_force"
_OFF = 0.25
"""Distance of a curve from its pixel, in pixels, beyond which the places are not a grid."""
_EMPTIEST = 4
"""Largest number of pixels for each curve on a grid that the file does not state."""


def force_maps(rows: Sequence[Row]) -> tuple[dict[str, xr.Dataset], list[str]]:
    """Return the images of each force map by its file, and notes on them."""
    members: dict[str, list[Row]] = {}
    for row in rows:
        if row.site is not None:
            members.setdefault(row.map, []).append(row)
    maps, notes = {}, []
    for name, part in members.items():
        places = np.array([(row.site.x, row.site.y) for row in part if row.site]).T
        if np.unique(places, axis=1).shape[1] < 2:
            continue
        grids = {row.site.grid for row in part if row.site}
        stated = grids.pop() if len(grids) == 1 else None
        axes = stated if stated is not None and _holds(stated, places) else _grid(places)
        if axes is None:
            notes.append(f"{name}: its places are not on a grid, so there is no image")
            continue
        maps[name], repeated = _images(part, places, axes)
        if repeated:
            notes.append(
                f"{name}: {len(repeated)} curves are at places that have another, such as "
                f"{repeated[0]}; the image shows the last accepted one"
            )
    return maps, notes


def _images(
    rows: Sequence[Row], places: Array, axes: tuple[Axis, Axis]
) -> tuple[xr.Dataset, list[str]]:
    """Return the images of a map, and the names of curves at places that have another."""
    import pandas as pd

    columns, lines = (index.astype(int) for index in _indices(axes, places).round())
    pixels = pd.MultiIndex.from_arrays([lines, columns], names=["y", "x"])
    accepted = [row.accepted for row in rows]
    frame = pd.DataFrame([_numbers(row) for row in rows if row.accepted], index=pixels[accepted])
    sides = [range(axis.pixels) for axis in reversed(axes)]
    frame = frame[~frame.index.duplicated(keep="last")]
    images = frame.reindex(pd.MultiIndex.from_product(sides, names=["y", "x"])).to_xarray()
    units = units_of(rows) | {f"{CONTACT_HEIGHT}{end}": "m" for end in ENDS}
    for name, image in images.items():
        image.attrs["units"] = units[str(name)]
    coordinates = {
        name: (name, axis.start + axis.pitch * np.arange(axis.pixels), {"units": "m"})
        for name, axis in zip("xy", axes, strict=True)
    }
    repeated = [row.name for row, again in zip(rows, pixels.duplicated(), strict=True) if again]
    return images.assign_coords(coordinates), repeated


def _numbers(row: Row) -> dict[str, float]:
    """Return the numbers of a fit that have an image, by name."""
    known, numbers = row.values(), dict[str, float]()
    for name, estimate in row.estimates.items():
        if estimate.held or name in _OF_BASELINE:
            continue
        low, value, high = (known[f"{name}{end}"] for end in ("_low", "", "_high"))
        value = value if row.is_closed(name) else np.nan
        if name == CONTACT_POINT:
            name, low, value, high = CONTACT_HEIGHT, -high, -value, -low
        numbers |= {name: value, f"{name}_low": low, f"{name}_high": high}
    return numbers | {name: known[name] for name in _QUALITY}


def _indices(axes: tuple[Axis, Axis], places: Array) -> Array:
    """Return the indices of places along x and y, as fractions, both of shape (2, n)."""
    pairs = zip(axes, places, strict=True)
    return np.array([(values - axis.start) / axis.pitch for axis, values in pairs])


def _holds(axes: tuple[Axis, Axis], places: Array) -> bool:
    """Return whether all places are on the pixels of a grid."""
    index = _indices(axes, places)
    nearest = np.round(index)
    pixels = np.array([[axis.pixels] for axis in axes])
    inside = nearest.min() >= 0 and np.all(nearest < pixels)
    return bool(inside and np.abs(index - nearest).max() <= _OFF)


def _grid(places: Array) -> tuple[Axis, Axis] | None:
    """Return the grid of the places of curves; None if they are not on one along x and y."""
    across, along = (_axis(values) for values in places)
    if across is None or along is None:
        return None
    # A line of curves is one pixel wide.
    across, along = (
        axis._replace(pitch=axis.pitch or other.pitch)
        for axis, other in ((across, along), (along, across))
    )
    many = across.pixels * along.pixels > _EMPTIEST * places.shape[1]
    return None if many else (across, along)


def _axis(values: Array) -> Axis | None:
    """Return the evenly spaced positions near which all values are; pitch 0 if there is one."""
    ordered = np.unique(values)
    if ordered.size == 1:
        return Axis(float(ordered[0]), 0.0, 1)
    steps = np.diff(ordered)
    # The instrument reports positions with some noise.
    cuts = np.flatnonzero(steps > _OFF * steps.max()) + 1
    centres = np.array([part.mean() for part in np.split(ordered, cuts)])
    gaps, span = np.diff(centres), float(np.ptp(centres))
    # Where most neighbours are missing, the least gap is the pitch; else noise makes it too small.
    for guess in (float(np.median(gaps)), float(gaps.min())):
        pixels = round(span / guess) + 1
        axis = Axis(float(centres[0]), span / (pixels - 1), pixels)
        index = (values - axis.start) / axis.pitch
        if np.abs(index - np.round(index)).max() <= _OFF:
            return axis
    return None
