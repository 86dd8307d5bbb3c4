"""Images of force maps as files: TIFF, and a figure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.files import atomic_write
from pellicle.results import header
from pellicle.show import save_figure
from pellicle.units import axis_unit
from pellicle_fit.population.images import CONTACT_HEIGHT

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

_FIRST = "reduced_modulus", "tension", "work_of_adhesion", CONTACT_HEIGHT
"""Images that the figure shows, if the map has them."""
_WIDTH, _AROUND = 3.7, 0.75
"""Width of a panel, and its height beside that of the image [inch]."""
_EXTREMES = 1, 99
"""Percentiles between which the colours change, so that one odd curve does not fade the rest."""


def save_map(images: xr.Dataset, stem: Path, title: str) -> tuple[Path, ...]:
    """Write the images of a map as files that begin with ``stem``, and return them.

    Raises
    ------
    StorageError
        A file cannot be written.
    """
    files = [
        save_tiff(image, stem.with_name(f"{stem.name}-{name}.tif"))
        for name, image in images.data_vars.items()
    ]
    draw, size = map_figure(images, title), figure_size(images)
    return (*files, *save_figure(draw, stem, ("png", "pdf"), size))


def save_tiff(image: xr.DataArray, path: Path) -> Path:
    """Write an image as TIFF of 32-bit floats, the largest y on top, with pixels for each cm."""
    from PIL import Image

    across, along = _pitches(image)
    per_cm = {"x_resolution": 1e-2 / across, "y_resolution": 1e-2 / along}
    picture = Image.fromarray(image.values[::-1].astype(np.float32))
    text = header(str(image.name), image)
    with atomic_write(path) as part:
        picture.save(part, format="TIFF", description=text, resolution_unit="cm", **per_cm)
    return path


def figure_size(images: xr.Dataset) -> tuple[float, float]:
    """Return the size of the figure of a map [inch]."""
    left, right, low, high = _edges(images, 1.0)
    height = (_WIDTH - 1.3) * min(max((high - low) / (right - left), 0.2), 3.0) + _AROUND
    return 2 * _WIDTH, height * max(len(_drawn(images)), 1) + 0.4


def map_figure(images: xr.Dataset, title: str) -> Callable[[FigureBase], None]:
    """Return a function that draws each parameter beside the width of its interval."""
    names = _drawn(images)

    def draw(figure: FigureBase) -> None:
        pairs = figure.subplots(max(len(names), 1), 2, squeeze=False)
        for name, (left, right) in zip(names, pairs, strict=False):
            image, unit = images[name], images[name].attrs["units"]
            width = images[f"{name}_high"] - images[f"{name}_low"]
            _draw(left, image, unit, name.replace("_", " "))
            _draw(right, width, unit, "width of its 95 % interval")
        for empty in pairs[len(names) :].ravel():
            empty.set_axis_off()
        figure.suptitle(title, fontsize="medium")

    return draw


def _drawn(images: xr.Dataset) -> list[str]:
    return [name for name in _FIRST if name in images]


def _draw(axes: Axes, image: xr.DataArray, unit: str, title: str) -> None:
    """Draw an image with its scale; grey where there is no value."""
    length, length_unit = axis_unit(np.append(image["x"].values, image["y"].values), "m")
    scale, scale_unit = axis_unit(image.values, unit)
    values = image.values * scale
    finite = values[np.isfinite(values)]
    low, high = np.percentile(finite, _EXTREMES) if finite.size else (0.0, 1.0)
    style: dict[str, Any] = {"cmap": "viridis", "vmin": float(low), "vmax": float(high)}
    edges = _edges(image, length)
    shown = axes.imshow(values, origin="lower", extent=edges, **style)
    axes.set_facecolor("0.8")
    axes.set(xlabel=f"x [{length_unit}]", ylabel=f"y [{length_unit}]")
    axes.set_title(title, fontsize="medium")
    figure = axes.get_figure()
    if figure is not None and finite.size:
        figure.colorbar(shown, ax=axes, label=scale_unit, extend="both", shrink=0.8)


def _edges(images: xr.Dataset | xr.DataArray, length: float) -> tuple[float, float, float, float]:
    """Return the outer edges of the images in a unit."""
    (x, y), (across, along) = (images[name].values * length for name in "xy"), _pitches(images)
    halves = across * length / 2, along * length / 2
    left, right = float(x[0]) - halves[0], float(x[-1]) + halves[0]
    return left, right, float(y[0]) - halves[1], float(y[-1]) + halves[1]


def _pitches(images: xr.Dataset | xr.DataArray) -> tuple[float, float]:
    """Return the sizes of a pixel along x and y [m]; a line of curves is one pixel wide."""
    sides = [images[name].values for name in "xy"]
    x, y = (float(side[1] - side[0]) if side.size > 1 else 0.0 for side in sides)
    return x or y, y or x
