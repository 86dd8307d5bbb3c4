"""Fields over the domain, packed for a page: a map each, in frames that are shown in turn."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any, ClassVar, NamedTuple

import numpy as np

from pellicle.arrays import Array
from pellicle.grid import Grid
from pellicle.units import axis_unit

_NOTHING = 0xFFFF
_PIXELS = 3_000_000
_FEWEST = 32


class Field(NamedTuple):
    """What a map shows."""

    name: str
    unit: str
    """SI."""
    colours: str = "viridis"
    """A colour map of matplotlib."""
    blank: bool = False
    """Whether nothing is drawn where it is 0."""
    power: float = 1.0
    """Of the values as the colours go: 0.5 tells small ones apart."""


class _Packed(NamedTuple):
    low: float
    high: float
    data: str


@dataclass(frozen=True)
class Frame:
    """Maps of one load step or of one run."""

    label: str
    grid: Grid
    factors: tuple[int, int]
    """Cells that make a pixel, along x and y."""
    shape: tuple[int, int]
    packed: tuple[_Packed, ...]


def side(points: int, maps: int) -> int:
    """Return how many pixels a side maps have, at most ``points``, where there are so many maps.

    Together they have three million at most, which keeps a page to some megabytes.
    """
    return min(points, max(_FEWEST, int(sqrt(_PIXELS / max(maps, 1)))))


def frame(label: str, grid: Grid, fields: Sequence[Array], points: int) -> Frame:
    """Return fields of the grid's shape as maps of at most ``points`` pixels a side.

    A pixel is the mean over a block of cells; values that are not finite do not count, and where
    there are no others it is empty.
    """
    nx, ny = (-(-n // points) for n in grid.shape)
    coarse = [_means(field, (nx, ny)) for field in fields]
    packed = tuple(map(_pack, coarse))
    return Frame(label, grid, (nx, ny), (-(-grid.shape[0] // nx), -(-grid.shape[1] // ny)), packed)


@dataclass(frozen=True)
class Maps:
    """Maps of the same fields in several frames, zoomed together."""

    kind: ClassVar[str] = "maps"
    caption: str
    what: str
    """What a frame is: ``"load step"``."""
    fields: Sequence[Field]
    frames: Sequence[Frame]
    begin: int = 0
    """The frame that is shown at first."""
    shared: bool = True
    """Whether the colours go over the values of all frames, not over those of each."""

    @property
    def remark(self) -> str:
        """How the pixels came about, if they are not the cells."""
        factors = {each.factors for each in self.frames} - {(1, 1)}
        if not factors:
            return ""
        most = " × ".join(map(str, max(factors)))
        same = len({each.factors for each in self.frames}) == 1
        return f"Each pixel is the mean over {'' if same else 'up to '}{most} cells."

    @property
    def data(self) -> dict[str, Any]:
        """What the script of the page reads; lengths and values in the units that it names."""
        sizes = np.array([each.grid.size for each in self.frames])
        length, length_unit = axis_unit(sizes / 2, "m")
        fields, scales = [], []
        for number, field in enumerate(self.fields):
            ends = [(each.packed[number].low, each.packed[number].high) for each in self.frames]
            scale, unit = axis_unit(np.array(ends), field.unit)
            scales.append(scale)
            fields.append(
                {
                    "name": field.name,
                    "unit": unit,
                    "blank": field.blank,
                    "power": field.power,
                    "colours": _colours(field.colours),
                    "low": min(low for low, _ in ends) * scale,
                    "high": max(high for _, high in ends) * scale,
                }
            )
        return {
            "unit": length_unit,
            "shared": self.shared,
            "fields": fields,
            "frames": [
                {
                    "label": each.label,
                    "shape": each.shape,
                    "size": [edge * length for edge in each.grid.size],
                    "pixel": [
                        edge * factor * length
                        for edge, factor in zip(each.grid.spacing, each.factors, strict=True)
                    ],
                    "fields": [
                        {"low": p.low * scale, "high": p.high * scale, "data": p.data}
                        for p, scale in zip(each.packed, scales, strict=True)
                    ],
                }
                for each in self.frames
            ],
        }


def _means(field: Array, factors: tuple[int, int]) -> Array:
    """Return the mean of what is finite in each block; NaN where nothing is."""
    (nx, ny), (fx, fy) = field.shape, factors
    padded = np.pad(field, ((0, -nx % fx), (0, -ny % fy)), constant_values=np.nan)
    blocks = padded.reshape(padded.shape[0] // fx, fx, padded.shape[1] // fy, fy)
    finite = np.isfinite(blocks)
    count = finite.sum((1, 3))
    total = np.where(finite, blocks, 0.0).sum((1, 3))
    means: Array = np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)
    return means


def _pack(values: Array) -> _Packed:
    """Return values in steps of 1/65534 of their range, as the differences of each to that before.

    Both bytes of these are small where the field is smooth, and so compress well apart.
    """
    finite = np.isfinite(values)
    low, high = (values[finite].min(), values[finite].max()) if finite.any() else (0.0, 0.0)
    shares = np.where(finite, values - low, 0.0) / ((high - low) or 1.0)
    codes = np.where(finite, np.rint(shares * (_NOTHING - 1)), _NOTHING).astype(np.uint16).ravel()
    steps = np.diff(codes, prepend=np.uint16(0))
    planes = np.stack([steps >> 8, steps & 0xFF]).astype(np.uint8).tobytes()
    return _Packed(float(low), float(high), base64.b64encode(zlib.compress(planes, 9)).decode())


def _colours(name: str) -> str:
    """Return the 256 colours of a colour map, three bytes each."""
    import matplotlib

    table = matplotlib.colormaps[name](np.arange(256), bytes=True)[:, :3]
    return base64.b64encode(table.tobytes()).decode()
