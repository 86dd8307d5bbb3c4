"""Files of a population beside its tables: contact sheet, distributions, and force maps."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.files import atomic_write
from pellicle.results import header
from pellicle.show import figure_of, save_figure, save_pages
from pellicle.units import axis_unit
from pellicle_fit.population.fits import ManyFits
from pellicle_fit.population.images import CONTACT_HEIGHT
from pellicle_fit.words.quantities import SHOWN

from .contact_sheet import PAGE, sheets
from .population_figures import distributions

if TYPE_CHECKING:
    import xarray as xr
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
    files = [save_pages(sheets(fits.rows), directory / "fits-curves.pdf", PAGE)]
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
    """Return what draws each parameter beside the width of its interval, and its size [inch].

    It is grey where there is no value.
    """
    names = [name for name in (*SHOWN, CONTACT_HEIGHT) if name in images]
    (x, y), (across, along) = (images[side].values for side in "xy"), _pitches(images)
    edges = np.array([x[0] - across / 2, x[-1] + across / 2, y[0] - along / 2, y[-1] + along / 2])
    length, length_unit = axis_unit(edges, "m")

    def draw(figure: Figure) -> None:
        figure.suptitle(title, fontsize="medium")
        for number, name in enumerate(names):
            width = images[f"{name}_high"] - images[f"{name}_low"]
            heads = {name.replace("_", " "): images[name], "width of its 95 % interval": width}
            for place, (head, image) in enumerate(heads.items(), 2 * number + 1):
                scale, unit = axis_unit(image.values, images[name].attrs["units"])
                values = image.values * scale
                finite = values[np.isfinite(values)]
                low, high = np.percentile(finite if finite.size else (0.0, 1.0), _EXTREMES)
                axes = figure.add_subplot(len(names), 2, place)
                extent: Any = edges * length
                shown = axes.imshow(values, origin="lower", extent=extent, vmin=low, vmax=high)
                axes.set_facecolor("0.8")
                axes.set(xlabel=f"x [{length_unit}]", ylabel=f"y [{length_unit}]")
                axes.set_title(head, fontsize="medium")
                figure.colorbar(shown, ax=axes, label=unit, extend="both", shrink=0.8)

    ratio = np.clip((edges[3] - edges[2]) / (edges[1] - edges[0]), 0.2, 3.0)
    height = (_WIDTH - 1.3) * float(ratio) + _AROUND
    return draw, (2 * _WIDTH, height * max(len(names), 1) + 0.4)


def _pitches(images: xr.Dataset | xr.DataArray) -> tuple[float, float]:
    """Return the sizes of a pixel along x and y [m]; a line of curves is one pixel wide."""
    sides = [images[name].values for name in "xy"]
    x, y = (float(side[1] - side[0]) if side.size > 1 else 0.0 for side in sides)
    return x or y, y or x
