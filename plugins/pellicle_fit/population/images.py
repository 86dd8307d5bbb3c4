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
    maps, notes = {}, []
    for name in dict.fromkeys(row.map for row in rows if row.site is not None):
        part = [row for row in rows if row.site is not None and row.map == name]
        sites = [row.site for row in part if row.site is not None]
        places = np.array([(site.x, site.y) for site in sites]).T
        if np.unique(places, axis=1).shape[1] < 2:
            continue
        stated, *others = {site.grid for site in sites}
        axes = None if others else stated
        if axes is None or not all(map(_is_on, axes, places)):
            axes = _grid(places)
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

    pairs = zip(axes[::-1], places[::-1], strict=True)
    indices = [np.round((values - axis.start) / axis.pitch).astype(int) for axis, values in pairs]
    pixels = pd.MultiIndex.from_arrays(indices)
    accepted = [row.accepted for row in rows]
    frame = pd.DataFrame([_numbers(row) for row in rows if row.accepted], index=pixels[accepted])
    sides = {name: range(axis.pixels) for name, axis in zip("yx", axes[::-1], strict=True)}
    whole = pd.MultiIndex.from_product(sides.values(), names=sides)
    images = frame[~frame.index.duplicated(keep="last")].reindex(whole).to_xarray()
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
        value, low, high = (known[f"{name}{end}"] for end in ENDS)
        value = value if row.is_closed(name) else np.nan
        if name == CONTACT_POINT:
            name, value, low, high = CONTACT_HEIGHT, -value, -high, -low
        numbers |= zip((f"{name}{end}" for end in ENDS), (value, low, high), strict=True)
    return numbers | {name: known[name] for name in _QUALITY}


def _is_on(axis: Axis, values: Array) -> bool:
    """Return whether all values are on the pixels of an axis."""
    index = (values - axis.start) / axis.pitch
    nearest = np.round(index)
    inside = nearest.min() >= 0 and nearest.max() < axis.pixels
    return bool(inside and np.abs(index - nearest).max() <= _OFF)


def _grid(places: Array) -> tuple[Axis, Axis] | None:
    """Return the grid of the places of curves; None if they are not on one along x and y."""
    across, along = map(_axis, places)
    if not across or not along or across.pixels * along.pixels > _EMPTIEST * places.shape[1]:
        return None
    # A line of curves is one pixel wide.
    pitches = across.pitch or along.pitch, along.pitch or across.pitch
    return across._replace(pitch=pitches[0]), along._replace(pitch=pitches[1])


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
        if _is_on(axis, values):
            return axis
    return None
