"""Files of a population beside its tables: contact sheet, distributions, and force maps."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.files import atomic_write
from pellicle.results import header
from pellicle.show import figure_of, save_figure
from pellicle.units import axis_unit
from pellicle_fit.population.fits import ManyFits
from pellicle_fit.population.images import CONTACT_HEIGHT
from pellicle_fit.wording import SHOWN

from .contact_sheet import save_sheets
from .population_figures import distributions

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _AROUND = 3.7, 0.75
"""Width of a panel, and its height beside that of the image [inch]."""
_EXTREMES = 1, 99
"""Percentiles between which the colours change, so that one odd curve does not fade the rest."""


def save_population(fits: ManyFits, directory: Path) -> tuple[Path, ...]:
    """Write ``fits-curves.pdf``, ``fits.png`` and the images in ``maps``, and return the files.

    Raises
    ------
    StorageError
        A file cannot be written.
    """
    files = [save_sheets(fits.rows, directory / "fits-curves.pdf")]
    if charts := distributions(fits.rows):
        draw, size = figure_of(charts)
        files += save_figure(draw, directory / "fits", ["png"], size)
    # Two files may have the same name in different folders.
    stems, seen = Counter(Path(name).stem for name in fits.maps), Counter[str]()
    for name, images in fits.maps.items():
        stem = Path(name).stem
        seen[stem] += 1
        path = directory / "maps" / (f"{stem}-{seen[stem]}" if stems[stem] > 1 else stem)
        for parameter, image in images.data_vars.items():
            files.append(save_tiff(image, path.with_name(f"{path.name}-{parameter}.tif")))
        fill, size = map_figure(images, Path(name).name)
        files += save_figure(fill, path, ("png", "pdf"), size)
    return tuple(files)


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


def map_figure(
    images: xr.Dataset, title: str
) -> tuple[Callable[[Figure], None], tuple[float, float]]:
    """Return what draws each parameter beside the width of its interval, and its size [inch]."""
    names = [name for name in (*SHOWN, CONTACT_HEIGHT) if name in images]

    def draw(figure: Figure) -> None:
        figure.suptitle(title, fontsize="medium")
        pairs = figure.subplots(len(names), 2, squeeze=False) if names else ()
        for name, pair in zip(names, pairs, strict=True):
            width = images[f"{name}_high"] - images[f"{name}_low"]
            unit = images[name].attrs["units"]
            _draw(pair[0], images[name], unit, name.replace("_", " "))
            _draw(pair[1], width, unit, "width of its 95 % interval")

    left, right, low, high = _edges(images, 1.0)
    height = (_WIDTH - 1.3) * np.clip((high - low) / (right - left), 0.2, 3.0) + _AROUND
    return draw, (2 * _WIDTH, float(height) * max(len(names), 1) + 0.4)


def _draw(axes: Axes, image: xr.DataArray, unit: str, title: str) -> None:
    """Draw an image with its scale; grey where there is no value."""
    length, length_unit = axis_unit(np.append(image["x"].values, image["y"].values), "m")
    scale, scale_unit = axis_unit(image.values, unit)
    values = image.values * scale
    finite = values[np.isfinite(values)]
    low, high = np.percentile(finite, _EXTREMES) if finite.size else (0.0, 1.0)
    style: dict[str, Any] = {"cmap": "viridis", "vmin": float(low), "vmax": float(high)}
    shown = axes.imshow(values, origin="lower", extent=_edges(image, length), **style)
    axes.set_facecolor("0.8")
    axes.set(xlabel=f"x [{length_unit}]", ylabel=f"y [{length_unit}]")
    axes.set_title(title, fontsize="medium")
    if finite.size:
        axes.figure.colorbar(shown, ax=axes, label=scale_unit, extend="both", shrink=0.8)


def _edges(images: xr.Dataset | xr.DataArray, length: float) -> tuple[float, float, float, float]:
    """Return the outer edges of the images in a unit."""
    (x, y), (across, along) = (images[name].values * length for name in "xy"), _pitches(images)
    across, along = across * length / 2, along * length / 2
    return float(x[0]) - across, float(x[-1]) + across, float(y[0]) - along, float(y[-1]) + along


def _pitches(images: xr.Dataset | xr.DataArray) -> tuple[float, float]:
    """Return the sizes of a pixel along x and y [m]; a line of curves is one pixel wide."""
    sides = [images[name].values for name in "xy"]
    x, y = (float(side[1] - side[0]) if side.size > 1 else 0.0 for side in sides)
    return x or y, y or x
