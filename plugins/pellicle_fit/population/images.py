"""Images of the parameters fitted to the curves of force maps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from pellicle.arrays import Array
from pellicle_fit.estimation.coordinates import CONTACT_POINT
from pellicle_fit.record import ENDS
from pellicle_fit.selection.verdict import Verdict

from .row import Row, units

CONTACT_HEIGHT = "contact_height"
"""Minus the contact point: the height of the surface over the zero of the instrument [m]."""
VERDICT = "verdict"
"""Number of the verdict, from 1, as `Verdict` lists them."""
_OF_BASELINE = "offset", "slope"
_QUALITY = "r_squared", "chi_squared", "indentation", "largest_force"
_OFF = 0.25
"""Distance of a curve from its pixel, in pixels, beyond which the places are not a grid."""
_EMPTIEST = 4
"""Largest number of pixels for each curve."""


def force_maps(rows: Sequence[Row]) -> tuple[dict[str, xr.Dataset], list[str]]:
    """Return the images of each force map by its file, and notes on them."""
    maps, notes = {}, []
    for name in dict.fromkeys(row.map for row in rows if row.site is not None):
        part = [row for row in rows if row.site is not None and row.map == name]
        places = np.array([row.site for row in part]).T
        if np.unique(places, axis=1).shape[1] < 2 or not any(row.accepted for row in part):
            continue
        x, y = map(_pixels, places)
        if x is None or y is None or x.size * y.size > _EMPTIEST * len(part):
            notes.append(f"{name}: its places are not on a grid, so there is no image")
            continue
        maps[name] = _images(part, places, x, y)
    return maps, notes


def _images(rows: Sequence[Row], places: Array, x: Array, y: Array) -> xr.Dataset:
    """Return the images of a map; of curves at one place the last accepted one is shown."""
    pixels = pd.MultiIndex.from_arrays([_nearest(y, places[1]), _nearest(x, places[0])])
    accepted = [row.accepted for row in rows]
    frame = pd.DataFrame([_numbers(row) for row in rows if row.accepted], index=pixels[accepted])
    whole = pd.MultiIndex.from_product([range(y.size), range(x.size)], names=["y", "x"])
    images = frame[~frame.index.duplicated(keep="last")].reindex(whole).to_xarray()
    unit_of = units() | {f"{CONTACT_HEIGHT}{end}": "m" for end in ENDS} | {VERDICT: "1"}
    for name, image in images.items():
        image.attrs["units"] = unit_of[str(name)]
    images[VERDICT].attrs["meanings"] = [verdict.value for verdict in Verdict]
    sides = {name: (name, side, {"units": "m"}) for name, side in (("x", x), ("y", y))}
    placed: xr.Dataset = images.assign_coords(sides)
    return placed


def _numbers(row: Row) -> dict[str, float]:
    """Return the numbers of a fit that have an image, by name."""
    fit, numbers = row.fit, dict[str, float]()
    known = fit.values()
    for name, estimate in fit.estimates().items():
        if estimate.held or name in _OF_BASELINE:
            continue
        value, low, high = (known[f"{name}{end}"] for end in ENDS)
        value = value if np.isfinite([low, high]).all() else np.nan
        if name == CONTACT_POINT:
            name, value, low, high = CONTACT_HEIGHT, -value, -high, -low
        numbers |= zip((f"{name}{end}" for end in ENDS), (value, low, high), strict=True)
    number = [*Verdict].index(fit.verdict) + 1.0
    return numbers | {name: known[name] for name in _QUALITY} | {VERDICT: number}


def _nearest(pixels: Array, values: Array) -> NDArray[np.intp]:
    return np.searchsorted((pixels[1:] + pixels[:-1]) / 2, values)


def _pixels(values: Array) -> Array | None:
    """Return the evenly spaced positions near which all values are; None if there are none."""
    ordered = np.unique(values)
    if ordered.size == 1:
        return ordered
    steps = np.diff(ordered)
    # The instrument reports positions with some noise.
    cuts = np.flatnonzero(steps > _OFF * steps.max()) + 1
    centres = np.array([part.mean() for part in np.split(ordered, cuts)])
    gaps, span = np.diff(centres), float(np.ptp(centres))
    # Where most neighbours are missing, the least gap is the pitch; else noise makes it too small.
    for guess in (float(np.median(gaps)), float(gaps.min())):
        count = round(span / guess)
        pixels = float(centres[0]) + span / count * np.arange(count + 1.0)
        if np.abs(values - pixels[_nearest(pixels, values)]).max() <= _OFF * span / count:
            return pixels
    return None
