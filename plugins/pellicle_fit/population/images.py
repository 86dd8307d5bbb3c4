"""Images of the parameters fitted to the curves of force maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.arrays import Array
from pellicle_fit.files.measurement import Axis
from pellicle_fit.parameters import CONTACT_POINT, OFFSET, SLOPE

from .judgement import Row
from .rules import NUMBERS, is_closed

if TYPE_CHECKING:
    import xarray as xr

CONTACT_HEIGHT = "contact_height"
"""Minus the contact point: the height of the surface over the zero of the instrument [m]."""
_QUALITY = "r_squared", "chi_squared", "indentation", "largest_force"
_OFF = 0.25
"""Distance of a curve from its pixel, in pixels, beyond which the places are not a grid."""
_EMPTIEST = 4
"""Largest number of pixels for each curve on a grid that the file does not state."""


def force_maps(rows: Sequence[Row]) -> tuple[dict[str, xr.Dataset], list[str]]:
    """Return the images of each force map by its file, and notes on them."""
    members: dict[str, list[Row]] = {}
    for row in rows:
        if "site" in row:
            members.setdefault(row["site"]["map"], []).append(row)
    maps, notes = {}, []
    for name, part in members.items():
        places = {(row["site"]["x"], row["site"]["y"]) for row in part}
        if len(places) < 2:
            continue
        axes = _stated_grid(part) or _grid(part)
        if axes is None:
            notes.append(f"{name}: its places are not on a grid, so there is no image")
            continue
        maps[name], repeated = _images(part, axes)
        if repeated:
            notes.append(
                f"{name}: {len(repeated)} curves are at places that have another, such as "
                f"{repeated[0]}; the image shows the last accepted one"
            )
    return maps, notes


def _images(rows: Sequence[Row], axes: tuple[Axis, Axis]) -> tuple[xr.Dataset, list[str]]:
    """Return the images of a map, and the names of curves at places that have another."""
    import xarray as xr

    along_x, along_y = axes
    shape = along_y.pixels, along_x.pixels
    pixels = [_pixel(row, axes) for row in rows]
    columns: dict[str, tuple[str, dict[int, float]]] = {}
    for number, row in enumerate(rows):
        if row["accepted"]:
            for name, unit, value in _numbers(row):
                columns.setdefault(name, (unit, {}))[1][number] = value
    data: dict[str, Any] = {}
    for name, (unit, values) in columns.items():
        image = np.full(shape, np.nan)
        for number, value in values.items():
            image[pixels[number]] = value
        data[name] = ("y", "x"), image, {"units": unit}
    repeated, seen = [], set()
    for row, pixel in zip(rows, pixels, strict=True):
        if pixel in seen:
            repeated.append(row["curve"])
        seen.add(pixel)
    coordinates = {
        name: (name, axis.start + axis.pitch * np.arange(axis.pixels), {"units": "m"})
        for name, axis in zip("xy", axes, strict=True)
    }
    return xr.Dataset(data, coordinates), repeated


def _numbers(row: Row) -> list[tuple[str, str, float]]:
    """Return name, unit and value of each number of a fit that has an image."""
    numbers = []
    for name, entry in row.items():
        if isinstance(entry, dict) and "low" in entry and not entry["held"]:
            low, value, high = (
                np.nan if entry[key] is None else entry[key] for key in ("low", "value", "high")
            )
            if name in (OFFSET.name, SLOPE.name):
                continue
            value = value if is_closed(entry) else np.nan
            if name == CONTACT_POINT.name:
                name, low, value, high = CONTACT_HEIGHT, -high, -value, -low
            for end, number in (("", value), ("_low", low), ("_high", high)):
                numbers.append((f"{name}{end}", entry["unit"], number))
    return [*numbers, *((name, NUMBERS[name], row[name]) for name in _QUALITY if name in row)]


def _pixel(row: Row, axes: tuple[Axis, Axis]) -> tuple[int, int]:
    """Return the indices of the pixel of a curve along y and x."""
    along_x, along_y = (
        round((row["site"][name] - axis.start) / axis.pitch)
        for name, axis in zip("xy", axes, strict=True)
    )
    return along_y, along_x


def _stated_grid(rows: Sequence[Row]) -> tuple[Axis, Axis] | None:
    """Return the grid that the file states; None if it states none on which the curves are."""
    grids = {row["site"]["grid"] for row in rows}
    grid: tuple[Axis, Axis] | None = grids.pop() if len(grids) == 1 else None
    if grid is None:
        return None
    for name, axis in zip("xy", grid, strict=True):
        places = np.array([row["site"][name] for row in rows])
        index = (places - axis.start) / axis.pitch
        nearest = np.round(index)
        inside = nearest.min() >= 0 and nearest.max() < axis.pixels
        if not inside or np.abs(index - nearest).max() > _OFF:
            return None
    return grid


def _grid(rows: Sequence[Row]) -> tuple[Axis, Axis] | None:
    """Return the grid of the places of curves; None if they are not on one along x and y."""
    places = [np.array([row["site"][name] for row in rows]) for name in "xy"]
    axes = [_axis(values) for values in places]
    pitches = [axis.pitch for axis in axes if axis is not None and axis.pitch]
    if None in axes or not pitches:
        return None
    # A line of curves is one pixel wide.
    along_x, along_y = (a._replace(pitch=a.pitch or pitches[0]) for a in axes if a is not None)
    if along_x.pixels * along_y.pixels > _EMPTIEST * len(rows):
        return None
    return along_x, along_y


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
