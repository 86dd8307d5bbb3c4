"""Figures of a population, and its files: distributions, force maps and a contact sheet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.arrays import Array, DataArray, Dataset, Mask
from pellicle.components import Axis, Chart, Look, Series
from pellicle.files import atomic_write
from pellicle.results import header
from pellicle.show import figure_of, save_figure, save_pages
from pellicle.units import axis_unit
from pellicle_fit.estimation.coordinates import MODULUS
from pellicle_fit.population.fits import ManyFits, common_error, label
from pellicle_fit.population.images import CONTACT_HEIGHT, VERDICT
from pellicle_fit.population.row import SHOWN, Row, accepted_estimates
from pellicle_fit.selection.recipe import TENSION
from pellicle_fit.words.names import words

from .contact_sheet import PAGE, choose_curves, sheets

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DRAWN = {MODULUS: "Pa", TENSION: "N/m"}
_BARS = 200
"""Most curves whose intervals are drawn beside each other."""
_OPEN_TOP = 1.1
"""Position of an open upper end, as a multiple of the largest value drawn."""
_BINS = 5, 40
"""Least and greatest number of bins."""
_DECADE = 10.0
"""Greatest over least value beyond which an axis is logarithmic."""
_SQUARE = (0, 0), (1, 0), (1, 1), (0, 1), (0, 0)
"""Corners of a pixel."""
_WIDTH, _AROUND = 3.7, 0.75
"""Width of a panel, and its height beside that of the image [inch]."""


def guide(x: Sequence[float], y: Sequence[float], legend: str = "") -> Series:
    """Return a thin dotted line that guides the eye, whose numbers are not written."""
    ends = np.array(x, dtype=float), np.array(y, dtype=float)
    return Series(*ends, legend=legend, look=Look(None, 3), role="reference", written=False)


def bars(rows: Sequence[Row]) -> list[Chart]:
    """Return modulus and tension of each curve with their intervals, if they were fitted.

    A bar with an open end reaches down to 0, or up to a triangle at the top; markers of rejected
    curves are hollow.
    """
    series, axes = list[Series](), list[Axis]()
    if len(rows) > _BARS:
        return []
    for name, unit in _DRAWN.items():
        fitted = [
            (number, row.accepted, e.value, e.low, e.high)
            for number, row in enumerate(rows, 1)
            if (e := row.fit.estimates().get(name)) is not None and not e.held
        ]
        if not fitted:
            continue
        # An open end is None, which becomes NaN.
        x, accepted, values, low, high = np.array(fitted, dtype=float).T
        opened, panel = np.isnan(high), len(axes)
        high[opened] = _OPEN_TOP * np.nanmax([*values, *high, 0.0])
        ends = np.column_stack([np.nan_to_num(low), high, np.full(x.size, np.nan)])
        series.append(Series(np.repeat(x, 3), ends.ravel(), panel=panel))
        for filled, of in ((True, accepted > 0), (False, accepted == 0)):
            for marker, y, which in ((0, values, of), (2, high, of & opened)):
                look = Look(0, None, marker, filled=filled)
                series.append(Series(x[which], y[which], look=look, panel=panel))
        axes.append(Axis(words(name), unit, limits=(0, None)))
    across = Axis("curve, in the order of the table")
    return [Chart(across, axes, series)] if axes else []


def distributions(rows: Sequence[Row]) -> list[Chart]:
    """Return histograms of E* and τ₀ of the accepted curves."""
    charts = list[Chart]()
    groups = list(dict.fromkeys(label(row.group) for row in rows if row.accepted))
    for name, unit in _DRAWN.items():
        found = accepted_estimates(rows, name)
        if not all(row.fit.has_no_sign(name) for row in found):
            values = np.array([e.value for e in found.values()])
            is_wide = name == MODULUS and bool(values.max() > _DECADE * values.min())
            kinds = np.array([groups.index(label(row.group)) for row in found])
            # One legend is enough.
            legends = groups if len(groups) > 1 and not charts else [""] * len(groups)
            error = common_error(row.fit.common_errors(name) for row in found)
            axis = Axis(words(name), unit, log=is_wide)
            charts.append(_histogram(axis, values, kinds, legends, *error.values()))
    return charts


def _histogram(
    axis: Axis, values: Array, kinds: Array, legends: Sequence[str], error: float = 0.0
) -> Chart:
    """Return how many values lie in each bin, those of each kind on top of the others.

    A bar across the median is of the error that all have in common.
    """
    low, high = float(values.min()), float(values.max())
    number = int(np.clip(np.sqrt(values.size) * 2, *_BINS)) + 1
    high = high if high > low else low + (abs(low) or 1.0)
    edges = np.geomspace(low, high, number) if axis.log else np.linspace(low, high, number)
    series, floor = list[Series](), np.zeros(2 * number)
    for kind, legend in enumerate(legends):
        counts, _ = np.histogram(values[kinds == kind], edges)
        top = floor + np.pad(np.repeat(counts, 2), 1)
        ends = {"low": floor, "high": top}
        series.append(Series(np.repeat(edges, 2), top, legend=legend, look=Look(kind), **ends))
        floor = top
    median, height = float(np.median(values)), floor.max()
    guides = [guide([median] * 2, [0.0, height])]
    if error:
        reach = [max(median - error, 0.1 * median), median + error]
        guides = [guide(reach, [1.05 * height] * 2, "95 % of the common error"), *guides]
    # In the order of the stack, from the top, so that no outline hides one below it.
    return Chart(axis, [Axis("curves")], [*series[::-1], *guides], hues=len(legends))


def map_figure(images: Dataset, title: str) -> tuple[Callable[[Figure], None], tuple[float, float]]:
    """Return what draws each parameter beside the width of its interval, and its size [inch].

    It is grey where there is no value, and hatched where one end of its interval is open. Verdicts
    have a legend.
    """
    names = [name for name in (*SHOWN, CONTACT_HEIGHT) if name in images]
    across, along = _pitches(images)
    length, unit = axis_unit(np.concatenate([images[side].values for side in "xy"]), "m")
    sides = {side: (side, images[side].values * length, {"units": unit}) for side in "xy"}

    def draw(figure: Figure) -> None:
        figure.suptitle(title, fontsize="medium")
        *panels, last = figure.subplots(len(names) + 1, 2, squeeze=False)
        for name, pair in zip(names, panels, strict=True):
            width = images[f"{name}_high"] - images[f"{name}_low"]
            heads = {name.replace("_", " "): images[name], "width of its 95 % interval": width}
            is_open = images[f"{name}_low"].isnull() != images[f"{name}_high"].isnull()
            for axes, (head, image) in zip(pair, heads.items(), strict=True):
                scale, unit = axis_unit(image.values, images[name].attrs["units"])
                beside = {"label": unit, "shrink": 0.8}
                # One odd curve does not fade the rest.
                robust: dict[str, Any] = {"robust": True, "center": False, "extend": "both"}
                shown = (image * scale).assign_coords(sides)
                shown.plot.imshow(ax=axes, cbar_kwargs=beside, **robust)
                _hatch(axes, is_open.values)
                # Pixels of a line of curves have no height.
                axes.set(facecolor="0.8", aspect="equal" if min(image.shape) > 1 else "auto")
                axes.set_title(head, fontsize="medium")
        _verdicts(images[VERDICT].assign_coords(sides), *last)

    ratio = np.clip(images["y"].size * along / (images["x"].size * across), 0.2, 3.0)
    height = (_WIDTH - 1.3) * float(ratio) + _AROUND
    return draw, (2 * _WIDTH, height * (len(names) + 1) + 0.4)


def _verdicts(image: DataArray, axes: Axes, beside: Axes) -> None:
    """Draw the map of verdicts, and beside it its legend with the number of curves of each."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    meanings = image.attrs["meanings"]
    colours = [f"C{number}" for number in range(len(meanings))]
    counts = np.bincount(image.values[image.values > 0].astype(int))
    ends: dict[str, Any] = {"vmin": 0.5, "vmax": len(meanings) + 0.5}
    image.plot.imshow(ax=axes, cmap=ListedColormap(colours), add_colorbar=False, **ends)
    axes.set(facecolor="0.8", aspect="equal" if min(image.shape) > 1 else "auto")
    axes.set_title("verdict", fontsize="medium")
    kinds = zip(colours, meanings, counts[1:], strict=False)
    of = [Patch(color=colour, label=f"{text} ({n})") for colour, text, n in kinds if n]
    beside.legend(handles=of, loc="center left", fontsize="small")
    beside.set_axis_off()


def _hatch(axes: Axes, pixels: Mask) -> None:
    """Hatch pixels of the image of an axes, whose rows are along y."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    if not pixels.any():
        return
    (image,) = axes.images
    left, right, low, high = image.get_extent()
    rows, columns = np.nonzero(pixels)
    if image.origin == "upper":
        low, high = high, low
    size = (right - left) / pixels.shape[1], (high - low) / pixels.shape[0]
    corners = np.column_stack([left + columns * size[0], low + rows * size[1]])
    squares = corners[:, None] + np.array(_SQUARE) * size
    outline = Outline.make_compound_path(*(Outline(square, closed=True) for square in squares))
    axes.add_patch(PathPatch(outline, fill=False, hatch="////", edgecolor="0.5", linewidth=0))


def _pitches(images: Dataset) -> tuple[float, float]:
    """Return the sizes of a pixel along x and y [m]; a line of curves is one pixel wide."""
    sides = [images[name].values for name in "xy"]
    x, y = (float(side[1] - side[0]) if side.size > 1 else 0.0 for side in sides)
    return x or y, y or x


def save_population(
    fits: ManyFits, directory: Path, formats: Sequence[str], pages: int | None = None
) -> tuple[Path, ...]:
    """Write contact sheet, distributions and the images in ``maps``, and return the files.

    The sheet has at most so many ``pages``, or all curves.
    """
    from PIL import Image

    rows, words = (fits.rows, "") if pages is None else choose_curves(fits.rows, pages)
    files = [save_pages(sheets(rows, words), directory / "fits-curves.pdf", PAGE)]
    if charts := distributions(fits.rows):
        draw, size = figure_of(charts)
        files += save_figure(draw, directory / "fits", formats, size)
    stems = [Path(name).stem for name in fits.maps]
    for number, (name, images) in enumerate(fits.maps.items(), 1):
        # Two files may have the same name in different folders.
        same = stems.count(Path(name).stem) > 1
        path = directory / "maps" / f"{Path(name).stem}{f'-{number}' * same}"
        across, along = _pitches(images)
        per_cm = {"x_resolution": 1e-2 / across, "y_resolution": 1e-2 / along}
        for parameter, image in images.data_vars.items():
            files.append(path.with_name(f"{path.name}-{parameter}.tif"))
            # Of 32-bit floats, with the largest y on top and pixels for each cm.
            picture = Image.fromarray(image.values[::-1].astype(np.float32))
            text = header(str(parameter), image)
            with atomic_write(files[-1]) as part:
                picture.save(part, format="TIFF", description=text, resolution_unit="cm", **per_cm)
        fill, size = map_figure(images, Path(name).name)
        files += save_figure(fill, path, formats, size)
    return tuple(files)
