"""Scans in text: rows of heights, or points, under a header with their units and sizes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from pellicle.arrays import Array
from pellicle.errors import ConfigError

from .scan import Channel, Edge, known_edges, metres
from .text_table import TextTable

_QUANTITY = re.compile(r"([-+]?\d*\.?\d+(?:[eE][-+]?\d+)?)\s*(.*)")
# Labels of SPIP, Nova, Attocube, interferometers, and Gwyddion in the languages of its users.
_LABELS = {
    "columns": r"x-pixels|NX|w(?=\s*=)",
    "rows": r"y-pixels|NY|h(?=\s*=)",
    "size x": "x-length|Width|Šířka|Breite|Anchura|Largeur|Larghezza|幅|폭|Largura|Ширина",
    "size y": "y-length|Height|Výška|Höhe|Altura|Hauteur|Altezza|高さ|높이|Высота",
    "pitch x": "pixel size|Scale X",
    "pitch y": "Scale Y",
    "unit x": "x-unit|Unit X|Lateral units",
    "unit y": "y-unit|Unit Y",
    "unit": "z-unit|Unit Data|Value units|Jednotky hodnot|Einheiten|Unités|unità valore|値の単位|"
    r"값 단위|Unidades de valor|Unidades|Единицы измерения|height conversion factor \(",
    "factor": r"height conversion factor \(->[^)]*\)",
    "factor to nm": "Bit2nm",
}
_ENTRIES = {
    name: re.compile(rf"(?<!\w)(?:{labels})\s*(?:[=:：]|->)\s*(\S.*)")
    for name, labels in _LABELS.items()
}
_POSITION_TOLERANCE = 0.05
"""Allowed rounding of the positions of regular points, relative to their spacing."""
_SIZE_TOLERANCE = 0.02
"""Allowed relative difference between the size in the header and that of the coordinates."""


def text_channel(name: str, table: TextTable, path: Path) -> Channel:
    """Return what a table and its header state: lines along x, or points x, y, z on a grid."""
    # Of two lines with one label the later counts.
    entries = {
        entry: match[1]
        for line in table.header
        for entry, label in _ENTRIES.items()
        if (match := label.search(line))
    }
    unit, factor = _word(entries, "unit"), _quantity(entries, "factor")
    if unit is None and (factor := _quantity(entries, "factor to nm")):
        unit = "nm"
    heights = table.values.T
    # SPIP's sizes have no unit; other files give that of y only where it differs from that of x.
    spip = any(line.startswith("# File Format = ASCII") for line in table.header)
    units: list[str | None] = ["nm" if spip else None]
    stated: list[Edge] = []
    for axis, axis_across, count in zip("xy", "yx", heights.shape, strict=True):
        edge = _quantity(entries, f"size {axis}")
        if edge is None and (pitch := _quantity(entries, f"pitch {axis}", f"pitch {axis_across}")):
            edge = pitch[0] * count, pitch[1]
        units.append((edge and edge[1]) or _word(entries, f"unit {axis}") or units[-1])
        if edge:
            stated.append((edge[0], units[-1]))
    edges = known_edges(stated)
    is_areal = min(heights.shape) > 2 or (len(heights) > 1 and bool(edges))
    if len(heights) == 3 and not (edges and _is_matrix(heights, edges)):
        heights, coordinates = _on_grid(heights, path)
        if edges:
            _require_size(edges, coordinates, heights.shape, path)
        edges = edges or list(zip(coordinates, units[1:], strict=True))
    else:
        for what, count in zip(("columns", "rows"), heights.shape, strict=True):
            number = _quantity(entries, what)
            if number and number[0] != count:
                raise ConfigError(
                    f"{path} states {number[0]:g} {what} of heights and has {count}: it is damaged "
                    "or incomplete; export it again",
                    "path",
                )
    if factor:
        heights = heights * factor[0]
    is_height = unit is None or metres(unit) is not None
    return Channel(name, unit, is_height, is_areal, edges, lambda: heights)


def _word(entries: Mapping[str, str], name: str) -> str | None:
    match = re.match(r"\w+", entries.get(name, ""))
    return match[0] if match else None


def _quantity(entries: Mapping[str, str], *names: str) -> tuple[float, str | None] | None:
    """Return the first stated quantity of some names, with the unit beside it if there is one."""
    for name in names:
        if match := _QUANTITY.match(entries.get(name, "")):
            return float(match[1]), match[2].strip() or None
    return None


def _is_matrix(columns: Array, stated: Sequence[Edge]) -> bool:
    """Return whether three columns under the size of a scan are heights, not points x, y, z.

    Their points are then square, or the first two have more values than those of a grid and do not
    extend as the sides of the scan do.
    """
    number = columns.shape[1]
    x, y = (edge * (metres(unit or "m") or 1.0) for edge, unit in stated)
    if any(abs(x / nx * ny / y - 1) < _SIZE_TOLERANCE for nx, ny in ((3, number), (2, number - 1))):
        return True
    values_x, values_y = map(np.unique, columns[:2])
    extents = np.ptp(values_x) * y, np.ptp(values_y) * x
    is_extended = abs(extents[0] - extents[1]) < 0.2 * max(extents)
    return number < 4 or (values_x.size * values_y.size > 2 * number and not is_extended)


def _on_grid(points: Array, path: Path) -> tuple[Array, list[float]]:
    """Return the heights of points x, y, z, of shape (3, n), on their regular grid, and its edges.

    The edges are in the unit of the coordinates.
    """
    *positions, heights = points
    irregular = ConfigError(
        f"{path} has points at irregular distances; resample them to a regular grid first, or give "
        "three columns of heights as type = 'heights'",
        "path",
    )
    indices, edges = [], []
    for position in positions:
        if not np.isfinite(position).all() or np.ptp(position) == 0:
            raise irregular
        gaps = np.diff(np.sort(position))
        pitch = np.ptp(position) / np.count_nonzero(gaps > gaps.max() / 2)
        index = (position - position.min()) / pitch
        if (np.abs(index - np.rint(index)) > _POSITION_TOLERANCE).any():
            raise irregular
        indices.append(np.rint(index).astype(int))
        edges.append(float(np.ptp(position) + pitch))
    shape = indices[0].max() + 1, indices[1].max() + 1
    cell = indices[0] * shape[1] + indices[1]
    if heights.size != shape[0] * shape[1] or (np.bincount(cell) != 1).any():
        raise irregular
    grid = np.empty(heights.size)
    grid[cell] = heights
    return grid.reshape(shape), edges


def _require_size(
    stated: Sequence[Edge], measured: Sequence[float], shape: tuple[int, ...], path: Path
) -> None:
    """Refuse a size in the header that is not that of the coordinates.

    They may have different units, and the size may lack the last pitch.
    """
    ratios = [
        [edge * (metres(unit or "m") or 1.0) / length for length in (extent, extent * (n - 1) / n)]
        for (edge, unit), extent, n in zip(stated, measured, shape, strict=True)
    ]
    if all(abs(x / y - 1) > _SIZE_TOLERANCE for x in ratios[0] for y in ratios[1]):
        size = " × ".join(f"{edge:g} {unit or ''}".strip() for edge, unit in stated)
        raise ConfigError(
            f"{path} states a size of {size}, and its coordinates are as {measured[0]:g} to "
            f"{measured[1]:g}; correct its header",
            "path",
        )
